#include "ranks/lane.h"

#include <algorithm>
#include <utility>

namespace relume::ranks {

void SendLane::start(MessageKind kind, Bytes content) {
  is_active_ = true;
  header_sent_ = false;
  is_granted_ = false;
  header_ = {kind, content.size()};
  content_ = std::move(content);
  sent_ = 0;
}

void SendLane::answer(bool is_granted) {
  is_granted_ = is_granted;
  if (is_granted) return;
  is_active_ = false;
  content_ = {};
}

LaneStep SendLane::step(const RelumeMpi& mpi) {
  if (request_) {
    bool done = false;
    if (!mpi.complete(request_, &done)) return LaneStep::failed;
    if (!done) return LaneStep::busy;
    request_ = nullptr;
    if (header_sent_) sent_ += std::min(kChunkBytes, header_.bytes - sent_);
    header_sent_ = true;
    if (sent_ == header_.bytes) {
      is_active_ = false;
      content_ = {};
    }
  }
  if (!is_active_ || waits()) return LaneStep::idle;
  const void* const bytes = header_sent_ ? static_cast<const void*>(content_.data() + sent_) : &header_;
  const uint64_t size = header_sent_ ? std::min(kChunkBytes, header_.bytes - sent_) : sizeof(Header);
  return mpi.send(to_, tag_, bytes, static_cast<int>(size), &request_) ? LaneStep::busy : LaneStep::failed;
}

LaneStep ReceiveLane::complete(const RelumeMpi& mpi) {
  if (!request_) return LaneStep::idle;
  bool done = false;
  if (!mpi.complete(request_, &done)) return LaneStep::failed;
  if (!done) return LaneStep::busy;
  request_ = nullptr;
  if (header_) {
    received_ += chunk_;
    return LaneStep::moved;
  }
  header_ = incoming_header_;
  received_ = 0;
  is_closed_ = header_->kind == MessageKind::closed;
  waits_ = is_bounded_ && header_->bytes > kSmallBytes;
  return LaneStep::moved;
}

LaneStep ReceiveLane::start(const RelumeMpi& mpi) {
  if (waits_ || is_closed_) return LaneStep::idle;
  int size = 0;
  void* message = nullptr;
  if (!mpi.find(from_, tag_, &size, &message)) return LaneStep::failed;
  if (!message) return header_ ? LaneStep::busy : LaneStep::idle;
  chunk_ = static_cast<uint64_t>(size);
  const uint64_t room = header_ ? header_->bytes - received_ : sizeof(Header);
  if (chunk_ > room) return LaneStep::failed;
  void* target = &incoming_header_;
  if (header_) {
    // Chunk by chunk: to clear all of a large message at once would delay the heartbeat.
    content_.reserve(header_->bytes);
    content_.resize(received_ + chunk_);
    target = content_.data() + received_;
  }
  return mpi.receive(message, target, size, &request_) ? LaneStep::busy : LaneStep::failed;
}

void ReceiveLane::accept(ReceiveBudget::Reservation reservation) {
  waits_ = false;
  reservation_ = std::move(reservation);
}

void ReceiveLane::drop() {
  waits_ = false;
  header_.reset();
  reservation_.reset();
  if (!request_) content_ = {};  // MPI may still write to it
}

std::optional<Message> ReceiveLane::take() {
  if (!header_ || waits_ || is_closed_ || received_ < header_->bytes) return std::nullopt;
  Message message{from_, header_->kind, std::move(content_), std::move(reservation_)};
  drop();
  return message;
}

LaneStep Answer::send(const RelumeMpi& mpi) {
  if (request_) {
    bool done = false;
    if (!mpi.complete(request_, &done)) return LaneStep::failed;
    if (!done) return LaneStep::busy;
    request_ = nullptr;
  }
  if (!next_) return LaneStep::idle;
  value_ = *next_ ? 1 : 0;
  next_.reset();
  return mpi.send(other_, tag_, &value_, sizeof(value_), &request_) ? LaneStep::busy : LaneStep::failed;
}

LaneStep Answer::receive(const RelumeMpi& mpi) {
  if (request_) {
    bool done = false;
    if (!mpi.complete(request_, &done)) return LaneStep::failed;
    if (!done) return LaneStep::busy;
    request_ = nullptr;
    return LaneStep::moved;
  }
  int size = 0;
  void* message = nullptr;
  if (!mpi.find(other_, tag_, &size, &message)) return LaneStep::failed;
  if (!message) return LaneStep::idle;
  if (size != static_cast<int>(sizeof(value_))) return LaneStep::failed;
  return mpi.receive(message, &value_, size, &request_) ? LaneStep::busy : LaneStep::failed;
}

}  // namespace relume::ranks
