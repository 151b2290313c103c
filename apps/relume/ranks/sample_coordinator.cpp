#include "ranks/sample_coordinator.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "cli/console.h"
#include "core/clock.h"
#include "core/parallel.h"
#include "relume/error.h"
#include "render/summed_layers.h"

namespace relume::ranks {
namespace {

constexpr double kTurn_s = 0.05;
/// Samples below which the error is too noisy, as checks_error_at().
constexpr uint32_t kErrorSamples = 16;
/// Deals take at most this part of the interval between checkpoints.
constexpr double kDealsPerInterval = 4;
constexpr double kLongestDeal_s = 10;
constexpr double kShortestDeal_s = 0.5;
/// Part of the time limit, and seconds, for which the job waits for the last ranks.
constexpr double kGrace = 0.05;
constexpr double kGrace_s = 3;
/// Results of other ranks at rank 0 take at most this many times the memory of the image's sums.
constexpr uint64_t kReceivedSums = 2;
/// Results of a rank that may wait while it renders its next deal.
constexpr size_t kWaitingResults = 1;

DealerSettings dealer_settings(const SampleJob& job, int ranks, SampleRanges done) {
  DealerSettings settings;
  settings.samples = job.limits.samples;
  settings.ranks = ranks;
  settings.adapt = job.adapt;
  settings.target_s = std::clamp(job.checkpoint_interval_s / kDealsPerInterval, kShortestDeal_s, kLongestDeal_s);
  settings.done = std::move(done);
  return settings;
}

}  // namespace

SampleCoordinator::SampleCoordinator(RankLink& link, SampleJob job)
    : link_(link),
      job_(std::move(job)),
      hosts_(link.size(), job_.identity),
      dealer_(dealer_settings(job_, link.size(), {})),
      ranks_(static_cast<size_t>(link.size())),
      sums_(static_cast<size_t>(job_.image.width) * static_cast<size_t>(job_.image.height)) {
  link_.set_receive_limit(std::max(kReceiveBytes, kReceivedSums * sums_.size() * sizeof(PixelSums)));
}

void SampleCoordinator::resume() {
  const PartInfo info = read_sums_file(job_.checkpoint, job_.image, sums_);
  job_.image.correlated_frames = std::max(job_.image.correlated_frames, info.correlated_frames);
  replicas_ = info.replicas;
  resumed_ = saved_samples_ = info.samples.count();
  dealer_ = SampleDealer(dealer_settings(job_, link_.size(), info.samples));
}

StopReason SampleCoordinator::run(const std::stop_token& stop, const std::function<void(const RanksProgress&)>& show) {
  saved_s_ = now_s();
  std::optional<StopReason> reason;
  try {
    while (!reason) {
      reason = step(stop);
      if (start_s_) show(progress());
    }
    link_.refuse_large();
    if (saving_.valid()) end_saving();
    try {
      save();
    } catch (const std::exception& error) {  // the image may be on another disk
      save_problem_ = error.what();
    }
  } catch (...) {
    for (int rank = 0; rank < link_.size(); ++rank) link_.send(rank, MessageKind::finish);
    throw;
  }
  for (int rank = 0; rank < link_.size(); ++rank) link_.send(rank, MessageKind::finish);
  return *reason;
}

/// Handles messages that have arrived, and deals after each. Returns the reason to end. The number of messages is
/// bounded, because results may arrive as fast as they are merged.
std::optional<StopReason> SampleCoordinator::step(const std::stop_token& stop) {
  double wait_s = kTurn_s;
  for (int left = link_.size(); left > 0; --left) {
    std::optional<Message> message = link_.receive_at_coordinator(wait_s);
    if (!message) break;
    handle(*message);
    message.reset();  // its memory is free for the next result
    if (problem_.empty() && !stop.stop_requested()) deal_to_idle();
    wait_s = 0;
  }
  if (const std::optional<int> lost = link_.lost_rank(); lost && problem_.empty())
    problem_ = fmt::format("{} cannot be reached any more", hosts_.name_of(*lost));
  if (dealer_.complete()) return StopReason::samples;
  const uint32_t count = block_samples().count();
  if (job_.limits.error > 0 && count >= kErrorSamples && count != error_samples_) {
    error_ = error_of(count);
    error_samples_ = count;
    if (error_ <= job_.limits.error) return StopReason::error;
  }
  if (!problem_.empty() || stop.stop_requested()) return StopReason::interrupted;
  if (time_is_over()) return StopReason::time;
  deal_to_idle();
  save_if_due();
  return std::nullopt;
}

void SampleCoordinator::handle(const Message& message) {
  Rank& rank = ranks_[static_cast<size_t>(message.from)];
  switch (message.kind) {
    case MessageKind::hello:
      if (const std::string difference = hosts_.add(message); difference.empty()) {
        rank.ready = true;
      } else if (problem_.empty()) {
        problem_ = difference;
      }
      if (!start_s_) start_s_ = now_s();
      break;
    case MessageKind::progress: {
      const auto progress = MessageReader(message.content).get<WorkProgress>();
      if (progress.id == rank.deal) rank.progress = progress;
      break;
    }
    case MessageKind::rendered: note_rendered(rank, MessageReader(message.content).get<WorkProgress>()); break;
    case MessageKind::samples: merge(message.from, message); break;
    case MessageKind::failed:
      problem_ = fmt::format("{}: {}", hosts_.name_of(message.from), MessageReader(message.content).get_text());
      break;
    default: break;
  }
}

/// The rank may get its next deal. Its message overtakes results, and may come after that of its deal.
void SampleCoordinator::note_rendered(Rank& rank, const WorkProgress& progress) {
  if (progress.id != rank.deal) return;
  dealer_.rendered(progress.id);
  rank.rendered.emplace(progress.id, progress.samples);
  rank.progress = progress;
  rank.progress.samples = 0;
  rank.deal = 0;
}

void SampleCoordinator::merge(int rank, const Message& message) {
  MessageReader in(message.content);
  const auto result = in.get<SampleResult>();
  Rank& sender = ranks_[static_cast<size_t>(rank)];
  sender.rendered.erase(result.id);
  if (sender.deal == result.id) {
    sender.deal = 0;
    sender.progress.samples = 0;
  }
  const bool is_cut_off = result.is_cut_off != 0;
  const uint32_t counted = result.blocks + (is_cut_off ? 0 : result.rest);
  if (!dealer_.finished(rank, result.id, counted, result.seconds)) return;
  is_cut_off_ = is_cut_off_ || is_cut_off;
  const double start_s = now_s();
  const size_t bytes = sums_.size() * message_bytes(job_.image.surface);
  if (result.blocks > 0) add_message_sums(in.get_bytes(bytes), job_.image.surface, sums_);
  if (result.rest > 0) {
    if (rest_.empty()) rest_.resize(sums_.size());
    add_message_sums(in.get_bytes(bytes), job_.image.surface, rest_);
    if (is_cut_off) {
      rest_samples_ += result.rest;
    } else {  // the last deal
      const uint32_t begin = result.first + result.blocks;
      last_block_ = SampleRange{begin, begin + result.rest - 1};
    }
  }
  if (counted > 0) dealer_.added(now_s() - start_s);
  if (job_.adapt && result.blocks + result.rest > 0 && sender.lane != result.first / kLaneSamples) {
    sender.lane = result.first / kLaneSamples;
    ++replicas_;
  }
  job_.image.correlated_frames = std::max(job_.image.correlated_frames, result.correlated_frames);
  for (const int late : dealer_.take_late(result.id)) {
    Rank& other = ranks_[static_cast<size_t>(late)];
    if (other.deal != result.id) continue;  // its result is on its way
    other.deal = 0;
    other.progress.samples = 0;
    link_.send(late, MessageKind::cancel, MessageWriter().put(result.id).take());
  }
}

void SampleCoordinator::deal_to_idle() {
  if (is_cut_off_) return;
  double left_s = std::numeric_limits<double>::infinity();
  if (job_.limits.time_s > 0) left_s = job_.limits.time_s - elapsed_s();
  for (int i = 0; i < link_.size(); ++i) {
    Rank& rank = ranks_[static_cast<size_t>(i)];
    if (!rank.ready || rank.deal != 0 || rank.rendered.size() > kWaitingResults) continue;
    // Until a sample is complete, time does not end the render.
    if (left_s <= 0 && samples() > 0) return;
    const std::optional<Deal> deal = dealer_.next(i, now_s());
    if (!deal) continue;
    rank.deal = deal->id;
    rank.progress.id = deal->id;
    rank.progress.samples = 0;
    link_.send(i, MessageKind::deal,
               MessageWriter().put(SampleWork{deal->id, deal->first, deal->count, left_s}).take());
  }
}

double SampleCoordinator::elapsed_s() const { return start_s_ ? now_s() - *start_s_ : 0; }

/// Ranks end their deals in time; late ones are not waited for.
bool SampleCoordinator::time_is_over() const {
  const double limit_s = job_.limits.time_s;
  if (limit_s <= 0 || samples() == 0) return false;
  const double now = elapsed_s();
  if (now > limit_s + std::max(kGrace * limit_s, kGrace_s)) return true;
  const bool busy = std::any_of(ranks_.begin(), ranks_.end(),
                                [](const Rank& rank) { return rank.deal != 0 || !rank.rendered.empty(); });
  return (is_cut_off_ || now >= limit_s) && !busy;
}

RanksProgress SampleCoordinator::progress() const {
  RanksProgress state;
  uint32_t samples = dealer_.done().count();
  std::set<uint32_t> deals;  // one that two ranks render counts once
  for (const Rank& rank : ranks_) {
    for (const auto& [deal, count] : rank.rendered) {
      if (deals.insert(deal).second) samples += count;
    }
    if (rank.deal != 0 && deals.insert(rank.deal).second) samples += rank.progress.samples;
    if (rank.progress.seconds > 0) state.rays_per_s += static_cast<double>(rank.progress.rays) / rank.progress.seconds;
  }
  state.ranks = static_cast<int>(std::ranges::count(ranks_, true, &Rank::ready));
  state.render.frames = samples;
  state.render.samples = samples;
  state.render.elapsed_s = elapsed_s();
  state.render.frames_done_here = samples - resumed_;
  state.render.samples_done_here = samples - resumed_;
  if (error_samples_ > 0) state.render.error = error_;
  return state;
}

double SampleCoordinator::error_of(uint32_t samples) const {
  return relative_error(sums_, {.window = job_.image.window,
                                .width = static_cast<size_t>(job_.image.width),
                                .samples = samples,
                                .correlated_frames = job_.image.correlated_frames});
}

/// The samples of complete blocks, which checkpoints hold: a larger --spp completes the last block.
SampleRanges SampleCoordinator::block_samples() const {
  SampleRanges blocks;
  for (SampleRange range : dealer_.done().ranges()) {
    if (last_block_ && range.last == last_block_->last) {
      if (range.first == last_block_->first) continue;
      range.last = last_block_->first - 1;
    }
    blocks.add(SampleRanges(range));
  }
  return blocks;
}

MergedSums SampleCoordinator::merged() const {
  MergedSums image = job_.image;
  image.samples = block_samples();
  image.replicas = replicas_;
  return image;
}

/// Waits until a checkpoint is written. A full disk does not end the render.
void SampleCoordinator::end_saving() {
  try {
    saving_.get();
  } catch (const std::exception& error) {
    cli::warn(error.what());
    saved_samples_ = 0;
  }
}

/// Writes a copy of the sums while ranks continue.
void SampleCoordinator::save_if_due() {
  if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) end_saving();
  const uint32_t samples = block_samples().count();
  const bool due = now_s() - saved_s_ >= job_.checkpoint_interval_s && samples > saved_samples_;
  if (job_.checkpoint.empty() || !due || saving_.valid()) return;
  saved_s_ = now_s();
  saved_samples_ = samples;
  saving_ = std::async(std::launch::async, [file = job_.checkpoint, image = merged(), sums = sums_] {
    write_sums_file(file, image, sums);
  });
}

void SampleCoordinator::save() {
  const uint32_t samples = block_samples().count();
  if (job_.checkpoint.empty() || samples == saved_samples_) return;
  write_sums_file(job_.checkpoint, merged(), sums_);
  saved_samples_ = samples;
}

double SampleCoordinator::complete_image() {
  if (!rest_.empty()) {
    parallel_for(sums_.size(), [&](size_t i) { sums_[i].add(rest_[i]); });
    rest_.clear();
  }
  return error_of(samples());
}

}  // namespace relume::ranks
