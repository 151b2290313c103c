// Messages from one rank to another, one after another: a header each, then the content in chunks.
#pragma once

#include <cstdint>
#include <optional>

#include "ranks/message.h"
#include "ranks/mpi_plugin.h"
#include "ranks/receive_budget.h"

namespace relume::ranks {

/// Messages to rank 0 with more bytes wait for its answer between header and content.
inline constexpr uint64_t kSmallBytes = uint64_t{256} << 10;
inline constexpr uint64_t kChunkBytes = uint64_t{4} << 20;

/// Precedes the content of a message.
struct Header {
  MessageKind kind = MessageKind::hello;
  uint64_t bytes = 0;
};

/// Result of a call: `busy` while a message is under way, `moved` after a part of it has arrived.
enum class LaneStep { idle, busy, moved, failed };

/// The sending end. All calls come from the thread of MPI.
class SendLane {
 public:
  SendLane(int to, int tag) : to_(to), tag_(tag) {}

  bool is_idle() const { return !is_active_; }
  /// Whether the message in progress is large: its header waits for answer().
  bool is_large() const { return is_active_ && to_ == 0 && header_.bytes > kSmallBytes; }
  bool waits() const { return is_large() && header_sent_ && !is_granted_; }
  /// Starts a message of an idle lane.
  void start(MessageKind kind, Bytes content);
  /// Sends the content of a message that waits, or drops it.
  void answer(bool is_granted);
  /// Continues. `failed`: the connection is lost.
  LaneStep step(const RelumeMpi& mpi);

 private:
  int to_;
  int tag_;
  bool is_active_ = false;
  bool header_sent_ = false;
  bool is_granted_ = false;
  Header header_;
  Bytes content_;
  uint64_t sent_ = 0;
  void* request_ = nullptr;
};

/// The receiving end. All calls come from the thread of MPI.
class ReceiveLane {
 public:
  /// `is_bounded`: whether large messages wait for accept().
  ReceiveLane(int from, int tag, bool is_bounded) : from_(from), tag_(tag), is_bounded_(is_bounded) {}

  /// Ends a receive in progress. `moved`: a header or a chunk has arrived.
  LaneStep complete(const RelumeMpi& mpi);
  /// Starts to receive the next header or chunk, after complete() that was not `busy`.
  LaneStep start(const RelumeMpi& mpi);
  /// Whether a large message is announced and not answered.
  bool waits() const { return waits_; }
  /// Of the announced message.
  uint64_t bytes() const { return header_ ? header_->bytes : 0; }
  /// Receives the content of the announced message.
  void accept(ReceiveBudget::Reservation reservation);
  /// Forgets the announced message, or the one in progress, and frees its reservation.
  void drop();
  /// A message that is complete.
  std::optional<Message> take();
  /// Whether the rank's last message has arrived.
  bool is_closed() const { return is_closed_; }

 private:
  int from_;
  int tag_;
  bool is_bounded_;
  bool waits_ = false;
  bool is_closed_ = false;
  std::optional<Header> header_;
  Header incoming_header_;
  Bytes content_;
  uint64_t received_ = 0;
  uint64_t chunk_ = 0;
  ReceiveBudget::Reservation reservation_;
  void* request_ = nullptr;
};

/// Rank 0's answer to an announced message. A rank uses one end only.
class Answer {
 public:
  Answer(int other, int tag) : other_(other), tag_(tag) {}

  /// Sends an answer at the next send().
  void set(bool is_granted) { next_ = is_granted; }
  bool is_idle() const { return !next_ && !request_; }
  LaneStep send(const RelumeMpi& mpi);
  /// `moved`: is_granted() has arrived.
  LaneStep receive(const RelumeMpi& mpi);
  bool is_granted() const { return value_ != 0; }

 private:
  int other_;
  int tag_;
  std::optional<bool> next_;
  uint32_t value_ = 0;  ///< being sent or received
  void* request_ = nullptr;
};

}  // namespace relume::ranks
