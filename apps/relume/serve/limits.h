// Limits that keep the cost of a client to itself. Times are those of now_s().
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace relume::serve {

// Bytes
inline constexpr size_t kMaxHeaderBytes = 8 << 10;    ///< of an HTTP request
inline constexpr size_t kMaxMessageBytes = 16 << 10;  ///< of a viewer's message

// Connections
inline constexpr size_t kMaxWaiting = 64;            ///< without a token so far
inline constexpr size_t kMaxWaitingPerAddress = 48;  ///< the same, of one address
inline constexpr double kAcceptedPerSecond = 200;
inline constexpr double kAcceptedAtOnce = 64;

// Seconds
inline constexpr double kHandshake_s = 5;  ///< from a connection to its token, or to the end of the answer
inline constexpr double kPing_s = 15;      ///< between pings of a viewer
inline constexpr double kIdle_s = 45;      ///< without a message or pong
inline constexpr double kWrite_s = 20;     ///< until a write is complete, and the time of its bytes at the next rate
inline constexpr double kLeastBytesPerSecond = 32 << 10;

// Rates of a viewer
inline constexpr double kMessagesPerSecond = 600;
inline constexpr double kMessagesAtOnce = 1200;
inline constexpr double kBytesPerSecond = 256 << 10;
inline constexpr double kBytesAtOnce = 1 << 20;

// Screenshots
inline constexpr double kScreenshotsPerSecond = 0.5;  ///< of a viewer
inline constexpr double kScreenshotsAtOnce = 3;
inline constexpr double kAllScreenshotsPerSecond = 2;  ///< of all viewers
inline constexpr double kAllScreenshotsAtOnce = 8;

/// A token bucket: `at_once` units, refilled at `per_second`.
class RateLimiter {
 public:
  RateLimiter(double per_second, double at_once) : per_second_(per_second), at_once_(at_once), left_(at_once) {}

  /// Takes units, if there are enough. Returns whether it did.
  bool take(double units, double now_s);
  /// Seconds until take() succeeds; infinity if `units` exceeds the bucket.
  double wait_s(double units, double now_s);

 private:
  void refill(double now_s);

  double per_second_;
  double at_once_;
  double left_;
  double last_s_ = 0;
};

/// The screenshots of a viewer: one at a time, and a rate.
class ScreenshotLimit {
 public:
  /// Begins a screenshot, unless one is in progress or a rate is exceeded. `all`: of all viewers. Returns the reason
  /// why it did not; empty: it did.
  std::string begin(RateLimiter& all, double now_s);
  /// Ends the one in progress. Returns whether there was one.
  bool end() { return std::exchange(waits_, false); }

 private:
  RateLimiter rate_{kScreenshotsPerSecond, kScreenshotsAtOnce};
  bool waits_ = false;
};

/// Connections without a token so far. A new one replaces an old one of the address with the most, so that a crowd
/// shuts out neither others nor, for long, new ones of its own address.
class WaitingRoom {
 public:
  explicit WaitingRoom(size_t total = kMaxWaiting, size_t per_address = kMaxWaitingPerAddress)
      : total_(total), per_address_(per_address) {}

  /// Adds a connection. Returns the one to close for it, if any.
  std::optional<uint64_t> enter(uint64_t connection, const std::string& address);
  void leave(uint64_t connection);
  size_t size() const { return waiting_.size(); }

 private:
  struct Entry {
    uint64_t connection;
    std::string address;
  };
  size_t count_of(const std::string& address) const;
  /// The address with the most connections; of several, the one that waits longest.
  std::string largest() const;

  size_t total_;
  size_t per_address_;
  std::deque<Entry> waiting_;  ///< oldest first
};

}  // namespace relume::serve
