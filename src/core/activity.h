// Names of the long preparations in progress, for progress displays.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

namespace relume {

/// A preparation step such as "decoding textures", in progress during the object's lifetime. Steps may nest.
class Activity {
 public:
  /// `parts`: number of part_done() calls to expect; 0: parts are not counted.
  explicit Activity(std::string name, size_t parts = 0);
  ~Activity();
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  /// Thread-safe.
  void part_done() { done_.fetch_add(1, std::memory_order_relaxed); }

 private:
  friend std::optional<std::string> current_activity();
  std::string name_;
  size_t parts_;
  std::atomic<size_t> done_ = 0;
};

/// The most recently begun step in progress, with its count: "decoding textures, 3 of 12". std::nullopt without one.
/// Thread-safe.
std::optional<std::string> current_activity();

}  // namespace relume
