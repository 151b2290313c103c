#include "ranks/sample_worker.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/clock.h"
#include "core/parallel.h"
#include "render/sample_blocks.h"
#include "render/session.h"

namespace relume::ranks {
namespace {

constexpr double kReport_s = 0.5;

static_assert(offsetof(PixelSums, surface) == 80, "messages without surfaces hold the members before them");

void put_sums(MessageWriter& out, const std::vector<PixelSums>& sums, bool surface) {
  const size_t size = message_bytes(surface);
  Bytes bytes(sums.size() * size);
  parallel_for(sums.size(), [&](size_t i) { std::memcpy(bytes.data() + i * size, &sums[i], size); });
  out.put_bytes(bytes);
}

}  // namespace

size_t message_bytes(bool surface) { return surface ? sizeof(PixelSums) : offsetof(PixelSums, surface); }

void add_message_sums(std::span<const std::byte> bytes, bool surface, std::span<PixelSums> sums) {
  const size_t size = message_bytes(surface);
  parallel_for(sums.size(), [&](size_t i) {
    PixelSums pixel;
    std::memcpy(&pixel, bytes.data() + i * size, size);
    sums[i].add(pixel);
  });
}

SampleWorker::SampleWorker(Session& session, RankLink& link)
    : session_(session), link_(link), surface_(render_settings(session).auxiliary) {
  const BufferTable& buffers = buffer_table(session);
  blocks_.resize(size_t{buffers.width()} * buffers.height());
  link_.on_interrupt([this](const Message& message) { interrupt(message); });
}

SampleWorker::~SampleWorker() { link_.on_interrupt({}); }

void SampleWorker::run() {
  while (true) {
    const std::optional<Message> message = link_.receive_at_worker(1);
    {
      const std::lock_guard lock(mutex_);
      if (finished_) return;
    }
    if (!message) continue;
    if (message->kind == MessageKind::finish) return;
    if (message->kind == MessageKind::deal) render(MessageReader(message->content).get<SampleWork>());
    if (message->kind == MessageKind::cancel) forget(MessageReader(message->content).get<uint32_t>());
  }
}

size_t SampleWorker::cancelled_deals() const {
  const std::lock_guard lock(mutex_);
  return cancelled_.size();
}

/// Forgets a cancelled deal. The deal has ended, because its message preceded the cancel message in the queue.
void SampleWorker::forget(uint32_t id) {
  const std::lock_guard lock(mutex_);
  cancelled_.erase(id);
}

/// Stops the frame in progress if its deal is no longer needed.
void SampleWorker::interrupt(const Message& message) {
  const std::lock_guard lock(mutex_);
  if (message.kind == MessageKind::finish) {
    finished_ = true;
    stop_.request_stop();
    return;
  }
  const auto id = MessageReader(message.content).get<uint32_t>();
  if (id == current_) {
    stop_.request_stop();
  } else {
    cancelled_.insert(id);
  }
}

std::stop_token SampleWorker::begin(uint32_t id) {
  const std::lock_guard lock(mutex_);
  current_ = id;
  if (!finished_) stop_ = std::stop_source();
  if (cancelled_.erase(id) > 0) stop_.request_stop();
  return stop_.get_token();
}

void SampleWorker::render(const SampleWork& work) {
  const std::stop_token stop = begin(work.id);
  const double start_s = now_s();
  SampleResult result;
  result.id = work.id;
  result.first = work.first;
  if (position_ != work.first) begin_samples(session_, work.first);
  position_.reset();
  std::ranges::fill(blocks_, PixelSums{});
  const bool complete = render_frames(work, stop, result);
  if (complete) {
    if (result.rest == 0) position_ = work.first + result.blocks;
    result.seconds = now_s() - start_s;
    result.correlated_frames = rendered_samples(session_).correlated_frames;
    send(result);
  }
  begin(0);
}

/// Returns whether the result counts: not if the deal was cancelled.
bool SampleWorker::render_frames(const SampleWork& work, const std::stop_token& stop, SampleResult& result) {
  const double start_s = now_s();
  const bool has_time_limit = std::isfinite(work.time_left_s);
  uint32_t frames = 0;
  while (frames < work.count) {
    const double elapsed_s = now_s() - start_s;
    const double frame_s = frames > 0 ? elapsed_s / frames : 0;
    if (any_ && elapsed_s + frame_s > work.time_left_s) break;
    const double frame_start_s = now_s();
    if (!session_.render_frame(stop)) return false;
    render_s_ += now_s() - frame_start_s;
    any_ = true;
    ++frames;
    // Complete blocks are taken separately from the incomplete block after them. With a time limit, any block may be
    // the last complete one.
    const bool may_end = has_time_limit || frames + kBlockSamples > work.count;
    if (frames % kBlockSamples == 0 && may_end) {
      take_samples(session_, blocks_);
      result.blocks = frames;
    }
    if (now_s() - reported_s_ >= kReport_s) report(MessageKind::progress, work.id, frames);
  }
  result.rest = frames - result.blocks;
  result.is_cut_off = frames < work.count ? 1 : 0;
  if (result.rest > 0) {
    rest_.assign(blocks_.size(), PixelSums{});
    take_samples(session_, rest_);
  }
  return true;
}

/// Waits until the previous result is sent, so that at most one waits in memory. Returns whether the job continues.
bool SampleWorker::wait_for_link() {
  while (!link_.wait_until_sent(kReport_s)) {
    const std::lock_guard lock(mutex_);
    if (finished_) return false;
  }
  return true;
}

void SampleWorker::send(const SampleResult& result) {
  report(MessageKind::rendered, result.id, result.blocks + result.rest);
  if (!wait_for_link()) return;
  MessageWriter out;
  const size_t parts = (result.blocks > 0 ? 1u : 0u) + (result.rest > 0 ? 1u : 0u);
  out.reserve(sizeof(result) + parts * blocks_.size() * message_bytes(surface_));
  out.put(result);
  if (result.blocks > 0) put_sums(out, blocks_, surface_);
  if (result.rest > 0) put_sums(out, rest_, surface_);
  link_.send(0, MessageKind::samples, out.take());
}

void SampleWorker::report(MessageKind kind, uint32_t id, uint32_t samples) {
  reported_s_ = now_s();
  WorkProgress progress;
  progress.id = id;
  progress.samples = samples;
  progress.rays = session_.statistics().rays;
  progress.seconds = render_s_;
  link_.send(0, kind, MessageWriter().put(progress).take());
}

}  // namespace relume::ranks
