// The order in which rank 0 receives large messages, within a limit of memory.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

namespace relume::ranks {

/// Ranks announce large messages. Each is granted once it fits into the limit beside those that are held, in the order
/// of the announcements, so that none waits for ever. A message that exceeds the limit is granted alone. One thread
/// makes all calls, except that any thread may free a reservation, set the limit and read held().
class ReceiveBudget {
 public:
  /// Bytes of one message. They are held until its last copy is destroyed.
  using Reservation = std::shared_ptr<const void>;
  struct Grant {
    int rank = 0;
    Reservation reservation;
  };

  explicit ReceiveBudget(uint64_t limit_bytes) : limit_(limit_bytes) {}

  void set_limit(uint64_t bytes) { limit_ = bytes; }
  /// A rank announces a message.
  void request(int rank, uint64_t bytes) { waiting_.push_back({rank, bytes}); }
  /// The next rank that may send; std::nullopt: none for now.
  std::optional<Grant> next();
  /// Drops the announcements of a rank. Its reservations are freed by their owner.
  void forget(int rank);
  /// Bytes of granted messages that exist.
  uint64_t held() const { return *held_; }

 private:
  struct Request {
    int rank = 0;
    uint64_t bytes = 0;
  };

  std::atomic<uint64_t> limit_;
  std::shared_ptr<std::atomic<uint64_t>> held_ = std::make_shared<std::atomic<uint64_t>>(0);
  std::deque<Request> waiting_;
};

}  // namespace relume::ranks
