#include "ranks/link.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "cli/command.h"
#include "core/clock.h"
#include "files/temporary_file.h"
#include "relume/error.h"

namespace relume::ranks {
namespace {

constexpr int kDataTag = 1;
constexpr int kBeatTag = 2;
constexpr uint64_t kChunkBytes = uint64_t{4} << 20;
constexpr double kBeat_s = 1;
constexpr auto kBusyPause = std::chrono::microseconds(200);
constexpr auto kIdlePause = std::chrono::milliseconds(3);
/// Time that MPI has to end before the process ends without it.
constexpr double kEnd_s = 15;

/// Precedes the content of a message, which follows in chunks.
struct Header {
  MessageKind kind = MessageKind::hello;
  uint64_t bytes = 0;
};

void sleep_s(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// Ends the process without destructors: other threads may still run.
[[noreturn]] void end_process(int exit_code) {
  remove_temporary_files();
  std::fflush(stdout);
  _exit(exit_code);
}

}  // namespace

/// Another rank. Its members up to `heard_s` belong to the link's thread.
struct RankLink::Peer {
  // The message being sent: header, then chunks.
  std::optional<std::pair<Header, Bytes>> outgoing;
  bool header_sent = false;
  uint64_t sent = 0;
  void* send_request = nullptr;
  // The message being received.
  std::optional<Header> header;
  Header incoming_header;
  Bytes incoming;
  uint64_t received = 0;
  uint64_t chunk = 0;
  void* receive_request = nullptr;
  void* beat_request = nullptr;
  void* heard_request = nullptr;
  bool is_closed = false;  ///< whether its last message has arrived
  bool is_lost = false;    ///< no call of MPI names it any more
  double beat_s = 0;
  double heard_s = 0;
  std::deque<std::pair<Header, Bytes>> queue;  ///< guarded by the link's mutex
};

RankLink::RankLink() = default;

RankLink::RankLink(const RelumeMpi& mpi) : mpi_(&mpi) {
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
  if (to == rank_) return deliver({rank_, kind, std::move(content)});
  const std::lock_guard lock(mutex_);
  const Header header{kind, content.size()};
  peers_[static_cast<size_t>(to)]->queue.emplace_back(header, std::move(content));
}

void RankLink::deliver(Message message) {
  const std::lock_guard lock(mutex_);
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
  {
    const std::lock_guard lock(mutex_);
    if (rank_ != 0) peers_[0]->queue.emplace_back(Header{MessageKind::closed, 0}, Bytes());
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
      peers_.push_back(std::make_unique<Peer>());
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
  return std::all_of(peers_.begin(), peers_.end(),
                     [](const auto& peer) { return peer->queue.empty() && !peer->outgoing && !peer->send_request; });
}

/// Whether no rank sends any more. MPI could not end before a message that rank 0 does not receive.
bool RankLink::all_closed() const {
  return rank_ != 0 || std::all_of(peers_.begin() + 1, peers_.end(),
                                   [](const auto& peer) { return peer->is_closed || peer->is_lost; });
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
    if (!peer.is_lost) is_busy = send_next(other, peer) || is_busy;
    if (!peer.is_lost) is_busy = receive_next(other, peer, now) || is_busy;
  }
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
    peers_[static_cast<size_t>(rank)]->is_lost = true;
    if (!lost_) lost_ = rank;
    changed_.notify_all();
    return false;
  }
  if (!closing_) {
    std::fputs(fmt::format("relume: rank {} on {} lost the connection to rank 0 and ends; continue with --resume\n",
                           rank_, host_name())
                   .c_str(),
               stderr);
  }
  end_process(1);
}

bool RankLink::send_next(int to, Peer& peer) {
  if (peer.send_request) {
    bool done = false;
    if (!mpi_->complete(peer.send_request, &done)) return fail(to);
    if (!done) return true;
    peer.send_request = nullptr;
    if (!peer.header_sent) {
      peer.header_sent = true;
    } else {
      peer.sent += std::min(kChunkBytes, peer.outgoing->first.bytes - peer.sent);
    }
    if (peer.sent == peer.outgoing->first.bytes) peer.outgoing.reset();
  }
  if (!peer.outgoing) {
    const std::lock_guard lock(mutex_);
    if (peer.queue.empty()) return false;
    peer.outgoing = std::move(peer.queue.front());
    peer.queue.pop_front();
    peer.header_sent = false;
    peer.sent = 0;
  }
  const auto& [header, content] = *peer.outgoing;
  const void* const bytes = peer.header_sent ? static_cast<const void*>(content.data() + peer.sent) : &header;
  const uint64_t size = peer.header_sent ? std::min(kChunkBytes, header.bytes - peer.sent) : sizeof(Header);
  if (!mpi_->send(to, kDataTag, bytes, static_cast<int>(size), &peer.send_request)) return fail(to);
  return true;
}

bool RankLink::receive_next(int from, Peer& peer, double now) {
  if (peer.receive_request) {
    bool done = false;
    if (!mpi_->complete(peer.receive_request, &done)) return fail(from);
    if (!done) return true;
    peer.receive_request = nullptr;
    peer.heard_s = now;
    if (!peer.header) {
      peer.header = peer.incoming_header;
      peer.incoming.resize(peer.header->bytes);
      peer.received = 0;
    } else {
      peer.received += peer.chunk;
    }
    if (peer.header->kind == MessageKind::closed) {
      peer.is_closed = true;
      peer.header.reset();
    } else if (peer.received == peer.header->bytes) {
      deliver({from, peer.header->kind, std::move(peer.incoming)});
      peer.incoming = {};
      peer.header.reset();
    }
  }
  int size = 0;
  void* message = nullptr;
  if (!mpi_->find(from, kDataTag, &size, &message)) return fail(from);
  if (!message) return peer.header.has_value();
  void* const target = peer.header ? static_cast<void*>(peer.incoming.data() + peer.received) : &peer.incoming_header;
  const uint64_t room = peer.header ? peer.header->bytes - peer.received : sizeof(Header);
  peer.chunk = static_cast<uint64_t>(size);
  if (peer.chunk > room || !mpi_->receive(message, target, size, &peer.receive_request)) return fail(from);
  return true;
}

std::unique_ptr<RankLink> open_link(const std::optional<Launch>& launch) {
  if (!launch || launch->size < 2) return std::make_unique<RankLink>();
  auto link = std::make_unique<RankLink>(load_mpi(launch->library));
  const int size = link->size();
  if (size == launch->size) return link;
  link->close(cli::kExitFailed);
  throw Error(
      fmt::format("the launcher started {} ranks, but MPI knows {}; use the mpirun of the library that relume's plugin "
                  "was built with",
                  launch->size, size));
}

}  // namespace relume::ranks
