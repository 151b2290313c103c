#include "viewer/render/resolution.h"

#include <algorithm>
#include <cmath>

namespace relume::viewer {
namespace {

constexpr double kPixelsPerStep = 1.4142135623730951;
constexpr double kTooSlow = 1.05;     // fraction of the budget above which the image shrinks
constexpr double kAimedAt = 0.9;      // target fraction of the budget for a new size
constexpr double kAffordable = 0.85;  // maximum expected fraction of the budget at the next larger size
constexpr int kSlowFrames = 2;        // the system may cause a single slow frame
constexpr int kFastFrames = 12;
constexpr int kFastFramesAtFirst = 3;  // at first, a change of size discards no history

float scale_of(int step) { return static_cast<float>(std::pow(kPixelsPerStep, -0.5 * step)); }

IVec2 scaled(const IVec2& full, float scale) {
  const auto side = [&](int length) {
    return std::max(1, static_cast<int>(std::lround(static_cast<float>(length) * scale)));
  };
  return {side(full.x), side(full.y)};
}

/// The scale at which a side reaches its minimum.
float smallest_scale(const IVec2& full) {
  return min(1.0f, max(static_cast<float>(kMinWidth) / static_cast<float>(full.x),
                       static_cast<float>(kMinHeight) / static_cast<float>(full.y)));
}

}  // namespace

int ResolutionControl::smallest_step(const IVec2& full) const {
  int step = 0;
  while (scale_of(step) > smallest_scale(full)) ++step;
  return may_upscale_ ? step + kUpscaleSteps : step;
}

IVec2 ResolutionControl::size(const IVec2& full) const {
  return scaled(full, max(scale_of(size_step()), smallest_scale(full)));
}

IVec2 ResolutionControl::first_frame_size(const IVec2& full) const {
  const IVec2 usual = size(full);
  if (upscale() > 1 && usual == full) return full;
  const double pixels = kFirstFrameBudget_s / std::max(pixel_s_, 1e-12);
  const double scale = std::min(std::sqrt(pixels / (double{1} * full.x * full.y)), 1.0);
  const IVec2 small = scaled(full, max(static_cast<float>(scale), smallest_scale(full)));
  return small.x < usual.x ? small : usual;
}

void ResolutionControl::measured(double seconds, const IVec2& size) {
  pixel_s_ = seconds / (double{1} * size.x * size.y);
}

void ResolutionControl::go_to(int step) {
  if (may_upscale_ && step > 0) step = std::max(step, kUpscaleSteps);
  if (step == step_) return;
  step_ = step;
  slow_ = fast_ = 0;
  fresh_ = true;
}

void ResolutionControl::frame_done(double seconds, double budget_s, const IVec2& full) {
  const int smallest = smallest_step(full);
  if (step_ > smallest) go_to(smallest);
  if (fresh_) {
    fresh_ = false;
    return;
  }
  slow_ = seconds > kTooSlow * budget_s ? slow_ + 1 : 0;
  const bool fast = step_ > 0 && seconds * kPixelsPerStep < kAffordable * budget_s;
  slowest_s_ = fast_ > 0 ? std::max(slowest_s_, seconds) : seconds;
  fast_ = fast ? fast_ + 1 : 0;
  if (slow_ >= kSlowFrames) {
    const double steps = std::log(seconds / (kAimedAt * budget_s)) / std::log(kPixelsPerStep);
    searching_ = false;
    go_to(std::min(smallest, step_ + std::max(1, static_cast<int>(std::ceil(steps)))));
  } else if (fast_ >= (searching_ ? kFastFramesAtFirst : kFastFrames)) {
    const double steps = std::log(kAffordable * budget_s / std::max(slowest_s_, 1e-9)) / std::log(kPixelsPerStep);
    go_to(std::max(0, step_ - static_cast<int>(std::min(steps, static_cast<double>(smallest)))));
  }
}

}  // namespace relume::viewer
