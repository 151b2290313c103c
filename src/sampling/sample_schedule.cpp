#include "sampling/sample_schedule.h"

#include <algorithm>
#include <bit>

#include "sampling/sampler.h"

namespace relume {

uint32_t epoch_start(uint32_t frame, uint32_t longest) {
  const uint32_t length = std::bit_floor(std::min(frame + 1, std::max(longest, 1u)));
  return (frame + 1) / length * length - 1;
}

bool SampleSchedule::begins_epoch(uint32_t since_change) const {
  return longest_epoch == 0 || epoch_start(since_change, longest_epoch) == since_change;
}

uint32_t SampleSchedule::sample(uint32_t age, uint32_t since_change) const {
  uint32_t sample = age;
  if (longest_epoch > 0) sample = std::min(sample, since_change - epoch_start(since_change, longest_epoch));
  if (pilot > 0 && since_change >= pilot) sample = std::min(sample, since_change - pilot);
  return sample;
}

uint32_t SampleSchedule::sequence(uint32_t age, uint32_t since_change, uint32_t frames) const {
  const uint32_t index = sample(age, since_change);
  return longest_epoch == 0 && index == age ? Sampler::kFirstSequence : frames - index;
}

}  // namespace relume
