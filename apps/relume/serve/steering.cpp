#include "serve/steering.h"

#include <algorithm>

namespace relume::serve {
namespace {

bool contains(const std::vector<uint32_t>& list, uint32_t viewer) {
  return std::find(list.begin(), list.end(), viewer) != list.end();
}

}  // namespace

void Steering::hand_to(uint32_t viewer, double now_s) {
  steerer_ = viewer;
  active_s_ = now_s;
  std::erase(requests_, viewer);
}

void Steering::join(uint32_t viewer, double now_s) {
  viewers_.push_back(viewer);
  if (steerer_ == 0) hand_to(viewer, now_s);
}

void Steering::leave(uint32_t viewer, double now_s) {
  std::erase(viewers_, viewer);
  std::erase(requests_, viewer);
  if (viewer != steerer_) return;
  hand_to(!requests_.empty() ? requests_.front() : !viewers_.empty() ? viewers_.front() : 0, now_s);
}

void Steering::request(uint32_t viewer, double now_s) {
  if (viewer == steerer_ || !contains(viewers_, viewer)) return;
  if (!contains(requests_, viewer)) requests_.push_back(viewer);
  update(now_s);
}

void Steering::grant(uint32_t from, uint32_t to, double now_s) {
  if (steers(from) && contains(viewers_, to)) hand_to(to, now_s);
}

void Steering::active(uint32_t viewer, double now_s) {
  if (steers(viewer)) active_s_ = now_s;
}

void Steering::update(double now_s) {
  if (!requests_.empty() && now_s - active_s_ > kInactive_s) hand_to(requests_.front(), now_s);
}

}  // namespace relume::serve
