// States of guiding chains for tests: plausible ones, and bits that no chain would write.
#pragma once

#include <cstring>

#include "techniques/guiding/markov_chain/guide_state.h"
#include "testing/random.h"

namespace relume::testing {

/// Targets within 4 m of the origin. Lobes have concentrations of up to about 100.
inline GuideState random_state(uint32_t number) {
  constexpr uint16_t kCounts[] = {1, 10, 1000};
  Random random(number);
  GuideState s;
  s.weight = 0.1f + 10.0f * random.next();
  s.target = s.weight * random.point(4);
  s.cosine = s.weight * 0.99f * random.next();
  s.count = kCounts[random.next_bits() % 3];
  return s;
}

/// Random bits; every other word is NaN, infinite or huge.
inline GuideState garbage_state(uint32_t number) {
  constexpr uint32_t kSpecial[] = {0x7fc00000u, 0xffc00001u, 0x7f800000u, 0xff800000u, 0x7f7fffffu, 0x00000001u, 0u};
  Random random(number);
  uint32_t words[sizeof(GuideState) / 4];
  for (uint32_t& word : words) word = random.next() < 0.5f ? random.next_bits() : kSpecial[random.next_bits() % 7];
  // Most random weights are far out of range; ordinary ones let more of the garbage through.
  if (random.next() < 0.7f) words[3] = float_bits(random.next());
  GuideState s;
  std::memcpy(&s, words, sizeof s);
  return s;
}

/// A narrow lobe towards `target`.
inline GuideState narrow_state(const Vec3& target) {
  GuideState s;
  s.weight = s.cosine = 1;
  s.target = target;
  s.count = 1000;
  return s;
}

}  // namespace relume::testing
