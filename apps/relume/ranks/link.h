// The messages of one rank, moved by a thread of their own, with a heartbeat that notices lost ranks.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ranks/launcher.h"
#include "ranks/message.h"
#include "ranks/mpi_plugin.h"
#include "ranks/receive_budget.h"

namespace relume::ranks {

/// Silence after which rank 0 counts another rank as lost, and another rank counts rank 0 as lost. A heartbeat is sent
/// each second.
inline constexpr double kLostAfter_s = 20;
inline constexpr double kCoordinatorLostAfter_s = 30;

/// Limit of the large messages of other ranks that rank 0 receives or has not handled, unless a job sets another.
inline constexpr uint64_t kReceiveBytes = uint64_t{256} << 20;

/// All ranks exchange messages with rank 0 only. A thread makes all calls of MPI. Large messages to rank 0 wait until
/// they fit into its limit (ReceiveBudget); heartbeats and urgent messages overtake them.
class RankLink {
 public:
  /// One rank without MPI.
  RankLink();
  /// Starts MPI on all ranks. `remedy`: what to do after rank 0 is lost, for the message of another rank. Throws Error.
  RankLink(const RelumeMpi& mpi, std::string remedy);
  /// Ends MPI if close() was called, and otherwise leaves it.
  ~RankLink();
  RankLink(const RankLink&) = delete;
  RankLink& operator=(const RankLink&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

  /// Queues a message and returns. Throws Error for an urgent one above kSmallBytes: its lane has no answers for large
  /// messages, so it would wait for ever.
  void send(int to, MessageKind kind, Bytes content = {});
  /// Waits until no large message to rank 0 is left to send; false after `timeout_s`.
  bool wait_until_sent(double timeout_s);
  /// Sets the limit of large messages at rank 0, in bytes.
  void set_receive_limit(uint64_t bytes) { budget_.set_limit(bytes); }
  /// Drops large messages at rank 0 that nothing has handled, and refuses all later ones.
  void refuse_large();
  /// The next message for the coordinator; std::nullopt after `timeout_s` without one.
  std::optional<Message> receive_at_coordinator(double timeout_s) { return receive(coordinator_, timeout_s); }
  /// The next message for this rank's worker.
  std::optional<Message> receive_at_worker(double timeout_s) { return receive(worker_, timeout_s); }

  /// Calls `hook` with each cancel and finish for this rank's worker when it arrives, on another thread. Empty: none.
  void on_interrupt(std::function<void(const Message&)> hook);

  /// A rank that has been silent too long or whose connection failed; std::nullopt: none. On rank 0.
  std::optional<int> lost_rank() const;

  /// Waits until all messages are sent, and ends MPI. All ranks must call it; without some of them, it ends the process
  /// with the exit code.
  void close(int exit_code);
  /// Ends all ranks that can be reached, and this process, with the exit code. For a job that has failed.
  [[noreturn]] void abandon(int exit_code);

 private:
  using Box = std::deque<Message>;
  struct Lane;
  struct Peer;

  std::optional<Message> receive(Box& box, double timeout_s);
  void deliver(Message message);
  void run();
  bool step_or_end();
  bool step(double now);
  void beat(double now);
  bool send_next(int to, Lane& lane);
  void note_sent();
  bool receive_next(int from, Peer& peer, Lane& lane, double now);
  void decide_requests();
  bool exchange_answer(int other, Peer& peer);
  bool fail(int rank);
  bool all_sent() const;
  bool all_closed() const;

  const RelumeMpi* mpi_ = nullptr;
  std::string remedy_;
  ReceiveBudget budget_{kReceiveBytes};
  int rank_ = 0;
  int size_ = 1;
  mutable std::mutex mutex_;  ///< guards what follows up to thread_, except the peers' transfers
  std::condition_variable changed_;
  Box coordinator_;
  Box worker_;
  std::function<void(const Message&)> hook_;
  std::vector<std::unique_ptr<Peer>> peers_;  ///< by rank
  std::optional<int> lost_;
  int unsent_large_ = 0;  ///< messages
  bool refuses_large_ = false;
  bool begun_ = false;
  bool failed_ = false;
  bool closing_ = false;
  bool aborting_ = false;
  bool ended_ = false;
  int exit_code_ = 1;  ///< of MPI_Abort
  std::thread thread_;
};

/// The link of this process: of one rank without a launcher. `remedy`: as RankLink(). Throws Error if MPI is missing or
/// another library's.
std::unique_ptr<RankLink> open_link(const std::optional<Launch>& launch, std::string remedy);

}  // namespace relume::ranks
