#include "viewer/model/fly_pace.h"

#include <algorithm>

namespace relume::viewer {

float FlyPace::step(bool held, uint64_t shown, double now_s) {
  const bool begins = held && !held_;
  held_ = held;
  if (!held || stepped_ || shown < awaited_) return 0;
  const double seconds = begins ? kFirstStep_s : std::min(now_s - last_s_, kLongestStep_s);
  if (!(seconds > 0)) return 0;
  stepped_ = true;
  last_s_ = now_s;
  return static_cast<float>(seconds);
}

void FlyPace::posted(uint64_t version) {
  if (stepped_) awaited_ = version;
  stepped_ = false;
}

}  // namespace relume::viewer
