#include "ranks/link.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "cli/command.h"
#include "core/clock.h"
#include "files/temporary_file.h"
#include "ranks/lane.h"
#include "relume/error.h"

namespace relume::ranks {
namespace {

constexpr int kDataTag = 1;
constexpr int kBeatTag = 2;
constexpr int kUrgentTag = 3;
constexpr int kAnswerTag = 4;
constexpr double kBeat_s = 1;
constexpr auto kBusyPause = std::chrono::microseconds(200);
constexpr auto kIdlePause = std::chrono::milliseconds(3);
/// Time that MPI has to end before the process ends without it.
constexpr double kEnd_s = 15;

void sleep_s(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// Ends the process without destructors: other threads may still run.
[[noreturn]] void end_process(int exit_code) {
  remove_temporary_files();
  std::fflush(stdout);
  _exit(exit_code);
}

}  // namespace

/// Messages between this rank and another that keep their order.
struct RankLink::Lane {
  Lane(int rank, int other, int tag) : sending(other, tag), receiving(other, tag, rank == 0 && tag == kDataTag) {}

  SendLane sending;
  ReceiveLane receiving;
  std::deque<std::pair<MessageKind, Bytes>> queue;  ///< guarded by the link's mutex
};

/// Another rank. All members belong to the link's thread, except those that the mutex guards.
struct RankLink::Peer {
  Peer(int rank, int other)
      : lanes{Lane(rank, other, kDataTag), Lane(rank, other, kUrgentTag)}, answer(other, kAnswerTag) {}

  Lane& lane_of(MessageKind kind) { return lanes[is_urgent(kind) ? 1 : 0]; }
  /// Whether its last message has arrived.
  bool is_closed() const {
    return std::all_of(lanes.begin(), lanes.end(), [](const Lane& lane) { return lane.receiving.is_closed(); });
  }

  std::array<Lane, 2> lanes;
  Answer answer;  ///< to a large message
  void* beat_request = nullptr;
  void* heard_request = nullptr;
  bool is_lost = false;  ///< no call of MPI names it any more
  double beat_s = 0;
  double heard_s = 0;
};

RankLink::RankLink() = default;

RankLink::RankLink(const RelumeMpi& mpi, std::string remedy) : mpi_(&mpi), remedy_(std::move(remedy)) {
  thread_ = std::thread([this] { run(); });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return begun_ || failed_; });
  if (!failed_) return;
  lock.unlock();
  thread_.join();
  throw Error(fmt::format("{} could not be started; try mpirun with another program first", mpi.library));
}

RankLink::~RankLink() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    if (!ended_) aborting_ = true;
  }
  thread_.join();
}

void RankLink::send(int to, MessageKind kind, Bytes content) {
  if (is_urgent(kind) && content.size() > kSmallBytes)
    throw Error(
        fmt::format("an urgent message between ranks has {} bytes, above the limit of {}; send it as a kind "
                    "that is not urgent",
                    content.size(), kSmallBytes));
  if (to == rank_) return deliver({rank_, kind, std::move(content)});
  const std::lock_guard lock(mutex_);
  if (to == 0 && content.size() > kSmallBytes) ++unsent_large_;
  peers_[static_cast<size_t>(to)]->lane_of(kind).queue.emplace_back(kind, std::move(content));
}

bool RankLink::wait_until_sent(double timeout_s) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [this] { return unsent_large_ == 0; });
}

void RankLink::refuse_large() {
  const std::lock_guard lock(mutex_);
  refuses_large_ = true;
  std::erase_if(coordinator_, [](const Message& message) { return message.content.size() > kSmallBytes; });
}

void RankLink::deliver(Message message) {
  const std::lock_guard lock(mutex_);
  if (refuses_large_ && is_for_coordinator(message.kind) && message.content.size() > kSmallBytes) return;
  if (hook_ && (message.kind == MessageKind::cancel || message.kind == MessageKind::finish)) hook_(message);
  Box& box = is_for_coordinator(message.kind) ? coordinator_ : worker_;
  box.push_back(std::move(message));
  changed_.notify_all();
}

std::optional<Message> RankLink::receive(Box& box, double timeout_s) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [&] { return !box.empty(); });
  if (box.empty()) return std::nullopt;
  Message message = std::move(box.front());
  box.pop_front();
  return message;
}

void RankLink::on_interrupt(std::function<void(const Message&)> hook) {
  const std::lock_guard lock(mutex_);
  hook_ = std::move(hook);
}

std::optional<int> RankLink::lost_rank() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

void RankLink::close(int exit_code) {
  if (!thread_.joinable()) return;
  refuse_large();
  {
    const std::lock_guard lock(mutex_);
    if (rank_ != 0) {
      for (Lane& lane : peers_[0]->lanes) lane.queue.emplace_back(MessageKind::closed, Bytes());
    }
    closing_ = true;
  }
  const double start_s = now_s();
  std::unique_lock lock(mutex_);
  while (!ended_ && now_s() - start_s < kEnd_s) changed_.wait_for(lock, std::chrono::milliseconds(50));
  if (!ended_) end_process(exit_code);  // a rank is lost, or still loads its scene
  lock.unlock();
  thread_.join();
}

void RankLink::abandon(int exit_code) {
  if (thread_.joinable()) {
    end_launcher(8);
    {
      const std::lock_guard lock(mutex_);
      aborting_ = true;
      exit_code_ = exit_code;
    }
    sleep_s(3);  // MPI ends the process; it may wait for a host that is lost
  }
  end_process(exit_code);
}

void RankLink::run() {
  int rank = 0;
  int size = 1;
  const bool works = mpi_->begin(&rank, &size);
  {
    const std::lock_guard lock(mutex_);
    rank_ = rank;
    size_ = size;
    for (int i = 0; i < size; ++i) {
      peers_.push_back(std::make_unique<Peer>(rank, i));
      peers_.back()->heard_s = now_s();
    }
    begun_ = works;
    failed_ = !works;
    changed_.notify_all();
  }
  if (!works) return;
  while (true) {
    const bool is_busy = step_or_end();
    bool closes = false;
    bool aborts = false;
    {
      const std::lock_guard lock(mutex_);
      aborts = aborting_;
      closes = closing_ && all_sent() && all_closed();
    }
    if (aborts) {
      mpi_->abort(exit_code_);
      return;
    }
    if (closes) break;
    if (is_busy) {
      std::this_thread::sleep_for(kBusyPause);
    } else {
      std::this_thread::sleep_for(kIdlePause);
    }
  }
  mpi_->end();
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

bool RankLink::all_sent() const {
  const auto is_sent = [](const Lane& lane) { return lane.queue.empty() && lane.sending.is_idle(); };
  return std::all_of(peers_.begin(), peers_.end(), [&](const auto& peer) {
    return peer->is_lost || (peer->answer.is_idle() && std::all_of(peer->lanes.begin(), peer->lanes.end(), is_sent));
  });
}

/// Whether no rank sends any more. MPI could not end before a message that rank 0 does not receive.
bool RankLink::all_closed() const {
  return rank_ != 0 || std::all_of(peers_.begin() + 1, peers_.end(),
                                   [](const auto& peer) { return peer->is_closed() || peer->is_lost; });
}

/// As step(). Ends the process if a message is too large for its memory: rank 0 has its last checkpoint, and notices
/// that others are lost.
bool RankLink::step_or_end() {
  try {
    return step(now_s());
  } catch (const std::exception& error) {
    std::fputs(
        fmt::format("relume: rank {} on {} cannot receive a message: {}\n", rank_, host_name(), error.what()).c_str(),
        stderr);
    end_process(1);
  }
}

/// Whether messages are under way.
bool RankLink::step(double now) {
  beat(now);
  bool is_busy = false;
  for (int other = 0; other < size_; ++other) {
    if (other == rank_ || (rank_ != 0 && other != 0)) continue;
    Peer& peer = *peers_[static_cast<size_t>(other)];
    for (auto lane = peer.lanes.rbegin(); lane != peer.lanes.rend(); ++lane) {  // the urgent one first
      if (!peer.is_lost) is_busy = send_next(other, *lane) || is_busy;
      if (!peer.is_lost) is_busy = receive_next(other, peer, *lane, now) || is_busy;
    }
    if (!peer.is_lost) is_busy = exchange_answer(other, peer) || is_busy;
  }
  if (rank_ == 0) decide_requests();
  return is_busy;
}

void RankLink::beat(double now) {
  for (int other = 0; other < size_; ++other) {
    if (other == rank_ || (rank_ != 0 && other != 0)) continue;
    Peer& peer = *peers_[static_cast<size_t>(other)];
    if (peer.is_lost) continue;
    bool done = false;
    if (peer.beat_request && !mpi_->complete(peer.beat_request, &done)) fail(other);
    if (done) peer.beat_request = nullptr;
    if (!peer.beat_request && now - peer.beat_s >= kBeat_s) {
      peer.beat_s = now;
      if (!mpi_->send(other, kBeatTag, nullptr, 0, &peer.beat_request)) fail(other);
    }
    done = false;
    if (peer.heard_request && !mpi_->complete(peer.heard_request, &done)) fail(other);
    if (done) {
      peer.heard_request = nullptr;
      peer.heard_s = now;
    }
    int size = 0;
    void* message = nullptr;
    if (!peer.heard_request && !mpi_->find(other, kBeatTag, &size, &message)) fail(other);
    if (message && !mpi_->receive(message, nullptr, 0, &peer.heard_request)) fail(other);
    if (now - peer.heard_s > (rank_ == 0 ? kLostAfter_s : kCoordinatorLostAfter_s)) fail(other);
  }
}

/// A rank is lost. Rank 0 decides what follows; others end, because they have no output of their own. Returns false: no
/// message of that rank is under way.
bool RankLink::fail(int rank) {
  const std::lock_guard lock(mutex_);
  if (rank_ == 0) {
    Peer& peer = *peers_[static_cast<size_t>(rank)];
    peer.is_lost = true;
    for (Lane& lane : peer.lanes) lane.receiving.drop();
    budget_.forget(rank);
    if (!lost_) lost_ = rank;
    changed_.notify_all();
    return false;
  }
  if (!closing_) {
    std::fputs(
        fmt::format("relume: rank {} on {} lost the connection to rank 0 and ends; {}\n", rank_, host_name(), remedy_)
            .c_str(),
        stderr);
  }
  end_process(1);
}

bool RankLink::send_next(int to, Lane& lane) {
  const bool was_large = lane.sending.is_large();
  LaneStep step = lane.sending.step(*mpi_);
  if (lane.sending.is_idle() && step != LaneStep::failed) {
    if (was_large) note_sent();
    {
      const std::lock_guard lock(mutex_);
      if (lane.queue.empty()) return false;
      lane.sending.start(lane.queue.front().first, std::move(lane.queue.front().second));
      lane.queue.pop_front();
    }
    step = lane.sending.step(*mpi_);
  }
  return step == LaneStep::failed ? fail(to) : step == LaneStep::busy;
}

/// A large message of this rank is sent or refused.
void RankLink::note_sent() {
  const std::lock_guard lock(mutex_);
  --unsent_large_;
  changed_.notify_all();
}

bool RankLink::receive_next(int from, Peer& peer, Lane& lane, double now) {
  const LaneStep before = lane.receiving.complete(*mpi_);
  if (before == LaneStep::failed) return fail(from);
  if (before == LaneStep::busy) return true;
  if (before == LaneStep::moved) {
    peer.heard_s = now;
    if (lane.receiving.waits()) budget_.request(from, lane.receiving.bytes());
    if (std::optional<Message> message = lane.receiving.take()) deliver(std::move(*message));
  }
  const LaneStep step = lane.receiving.start(*mpi_);
  return step == LaneStep::failed ? fail(from) : step == LaneStep::busy;
}

/// Grants or refuses the large messages that other ranks have announced.
void RankLink::decide_requests() {
  bool refuses = false;
  {
    const std::lock_guard lock(mutex_);
    refuses = refuses_large_;
  }
  while (std::optional<ReceiveBudget::Grant> grant = refuses ? std::nullopt : budget_.next()) {
    Peer& peer = *peers_[static_cast<size_t>(grant->rank)];
    peer.lanes[0].receiving.accept(std::move(grant->reservation));
    peer.answer.set(true);
  }
  for (int other = 1; refuses && other < size_; ++other) {
    Peer& peer = *peers_[static_cast<size_t>(other)];
    if (!peer.lanes[0].receiving.waits()) continue;
    budget_.forget(other);
    peer.lanes[0].receiving.drop();
    peer.answer.set(false);
  }
}

bool RankLink::exchange_answer(int other, Peer& peer) {
  SendLane& sending = peer.lanes[0].sending;
  if (rank_ != 0 && !sending.waits()) return false;
  const LaneStep step = rank_ == 0 ? peer.answer.send(*mpi_) : peer.answer.receive(*mpi_);
  if (step == LaneStep::failed) return fail(other);
  if (step == LaneStep::moved) {
    sending.answer(peer.answer.is_granted());
    if (sending.is_idle()) note_sent();
  }
  return step != LaneStep::idle;
}

std::unique_ptr<RankLink> open_link(const std::optional<Launch>& launch, std::string remedy) {
  if (!launch || launch->size < 2) return std::make_unique<RankLink>();
  auto link = std::make_unique<RankLink>(load_mpi(launch->library), std::move(remedy));
  const int size = link->size();
  if (size == launch->size) return link;
  link->close(cli::kExitFailed);
  throw Error(
      fmt::format("the launcher started {} ranks, but MPI knows {}; use the mpirun of the library that relume's plugin "
                  "was built with",
                  launch->size, size));
}

}  // namespace relume::ranks
