// Names of the long preparations in progress, for displays of progress.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

namespace relume {

/// A step of preparation while it lives, such as "decoding textures". Steps may begin within others.
class Activity {
 public:
  /// `parts`: how many part_done() will count; 0: they are not counted.
  explicit Activity(std::string name, size_t parts = 0);
  ~Activity();
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  /// On any thread.
  void part_done() { done_.fetch_add(1, std::memory_order_relaxed); }

 private:
  friend std::optional<std::string> current_activity();
  std::string name_;
  size_t parts_;
  std::atomic<size_t> done_ = 0;
};

/// The step that began last of those in progress, with its count: "decoding textures, 3 of 12". std::nullopt if there
/// is none. On any thread.
std::optional<std::string> current_activity();

}  // namespace relume
