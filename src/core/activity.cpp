#include "core/activity.h"

#include <mutex>
#include <utility>
#include <vector>

namespace relume {
namespace {

// The display reads activities on another thread than the working ones.
std::mutex g_mutex;
std::vector<const Activity*> g_activities;

}  // namespace

Activity::Activity(std::string name, size_t parts) : name_(std::move(name)), parts_(parts) {
  const std::scoped_lock lock(g_mutex);
  g_activities.push_back(this);
}

Activity::~Activity() {
  const std::scoped_lock lock(g_mutex);
  std::erase(g_activities, this);
}

std::optional<std::string> current_activity() {
  const std::scoped_lock lock(g_mutex);
  if (g_activities.empty()) return std::nullopt;
  const Activity& last = *g_activities.back();
  if (last.parts_ == 0) return last.name_;
  return last.name_ + ", " + std::to_string(last.done_.load(std::memory_order_relaxed)) + " of " +
         std::to_string(last.parts_);
}

}  // namespace relume
