#include "ranks/sample_dealer.h"

#include <algorithm>
#include <cmath>

#include "framebuffer/pixel_sums.h"
#include "relume/error.h"

namespace relume::ranks {
namespace {

/// Deals have at least this many blocks, because each result costs time, too. The last ones may be smaller if they
/// still take kLeastLastDeal_s.
constexpr uint32_t kLeastBlocks = 4;
constexpr double kLeastLastDeal_s = 1;
/// A deal has at most this part of the samples left per rank, so that ranks end together.
constexpr uint32_t kPartsPerRank = 2;

uint32_t blocks_of(uint32_t samples) { return (samples + kBlockSamples - 1) / kBlockSamples; }

}  // namespace

SampleDealer::SampleDealer(const DealerSettings& settings)
    : settings_(settings),
      done_(settings.done),
      sample_s_(static_cast<size_t>(settings.ranks), 0.0),
      lanes_(static_cast<size_t>(settings.ranks), SampleRange{1, 0}) {
  const uint32_t end = settings.samples > 0 ? settings.samples : kLastSample + 1;
  dealt_ = done_.count();
  if (settings.adapt) {
    if (!done_.empty()) next_lane_ = (done_.last() / kLaneSamples + 1) * kLaneSamples;
    return;
  }
  uint32_t next = 0;
  for (const SampleRange& range : done_.ranges()) {
    if (range.first > next && next < end) todo_.push_back({next, std::min(range.first, end) - 1});
    next = range.last + 1;
  }
  if (next < end) todo_.push_back({next, end - 1});
}

std::optional<Deal> SampleDealer::next(int rank, double now_s) {
  if (complete()) return std::nullopt;
  std::optional<Deal> deal = take_new(rank);
  if (!deal) return take_late_deal(rank, now_s);
  deal->id = next_id_++;
  flights_.push_back({*deal, {{rank, now_s}}});
  return deal;
}

/// Samples that are not dealt.
uint32_t SampleDealer::unclaimed() const {
  if (settings_.adapt)
    return settings_.samples > 0 ? settings_.samples - std::min(settings_.samples, dealt_) : kLastSample;
  uint32_t samples = 0;
  for (const SampleRange& range : todo_) samples += range.count();
  return samples;
}

uint32_t SampleDealer::blocks_for(int rank) const {
  const double sample_s = sample_s_[static_cast<size_t>(rank)];
  if (!(sample_s > 0)) return kLeastBlocks;
  const double block_s = sample_s * kBlockSamples;
  const uint32_t wanted = std::max(static_cast<uint32_t>(std::min(settings_.target_s / block_s, 1e6)), kLeastBlocks);
  const double last_s = std::max(kLeastLastDeal_s, settings_.ranks * add_s_);
  const double last = std::ceil(std::min(last_s / block_s, double{kLeastBlocks}));
  const uint32_t share = blocks_of(unclaimed()) / (kPartsPerRank * static_cast<uint32_t>(settings_.ranks));
  return std::max(std::min(wanted, share), static_cast<uint32_t>(last));
}

std::optional<Deal> SampleDealer::take_new(int rank) {
  if (unclaimed() == 0) return std::nullopt;
  const uint32_t wanted = blocks_for(rank) * kBlockSamples;
  if (!settings_.adapt) {
    SampleRange& range = todo_.front();
    const Deal deal{0, range.first, std::min(wanted, range.count())};
    if (deal.count == range.count()) {
      todo_.pop_front();
    } else {
      range.first += deal.count;
    }
    return deal;
  }
  SampleRange& lane = lanes_[static_cast<size_t>(rank)];
  if (lane.first > lane.last) {
    if (next_lane_ > kLastSample) throw Error("the image has too many independent renders; use fewer ranks or samples");
    lane = {next_lane_, next_lane_ + kLaneSamples - 1};
    next_lane_ += kLaneSamples;
  }
  const Deal deal{0, lane.first, std::min({wanted, lane.count(), unclaimed()})};
  lane.first += blocks_of(deal.count) * kBlockSamples;
  dealt_ += deal.count;
  return deal;
}

/// A deal of a slow rank. Samples that adapt have no equal on another rank.
std::optional<Deal> SampleDealer::take_late_deal(int rank, double now_s) {
  const double own_s = sample_s_[static_cast<size_t>(rank)];
  if (settings_.adapt || own_s <= 0) return std::nullopt;
  Flight* latest = nullptr;
  double latest_s = 0;
  for (Flight& flight : flights_) {
    if (flight.done || flight.rendered || flight.workers.size() != 1) continue;
    const Worker& worker = flight.workers.front();
    const double elapsed_s = now_s - worker.start_s;
    const double sample_s = sample_s_[static_cast<size_t>(worker.rank)];
    const double expected_s = sample_s * flight.deal.count;
    // Without a measured speed, or behind it, a rank may take as long again.
    const double left_s = expected_s > elapsed_s ? expected_s - elapsed_s : elapsed_s;
    if (left_s > own_s * flight.deal.count && left_s > latest_s) {
      latest = &flight;
      latest_s = left_s;
    }
  }
  if (!latest) return std::nullopt;
  latest->workers.push_back({rank, now_s});
  return latest->deal;
}

void SampleDealer::rendered(uint32_t id) {
  for (Flight& flight : flights_) {
    if (flight.deal.id == id) flight.rendered = true;
  }
}

bool SampleDealer::finished(int rank, uint32_t id, uint32_t count, double seconds) {
  if (count > 0 && seconds > 0) {
    double& speed = sample_s_[static_cast<size_t>(rank)];
    const double now = seconds / count;
    speed = speed > 0 ? 0.5 * (speed + now) : now;
  }
  const auto found =
      std::find_if(flights_.begin(), flights_.end(), [&](const Flight& flight) { return flight.deal.id == id; });
  if (found == flights_.end() || found->done) return false;
  const Deal deal = found->deal;
  const bool is_complete = count >= deal.count;
  if (!is_complete && found->workers.size() > 1) {
    std::erase_if(found->workers, [&](const Worker& worker) { return worker.rank == rank; });
    return false;  // the other rank renders all
  }
  if (count > 0) done_.add(SampleRanges({deal.first, deal.first + std::min(count, deal.count) - 1}));
  if (!is_complete && !settings_.adapt) todo_.push_front({deal.first + count, deal.first + deal.count - 1});
  if (!is_complete && settings_.adapt) dealt_ -= deal.count - count;
  std::erase_if(found->workers, [&](const Worker& worker) { return worker.rank == rank; });
  found->done = true;
  if (found->workers.empty()) flights_.erase(found);
  return true;
}

std::vector<int> SampleDealer::take_late(uint32_t id) {
  std::vector<int> ranks;
  const auto found =
      std::find_if(flights_.begin(), flights_.end(), [&](const Flight& flight) { return flight.deal.id == id; });
  if (found == flights_.end() || !found->done) return ranks;
  for (const Worker& worker : found->workers) ranks.push_back(worker.rank);
  flights_.erase(found);
  return ranks;
}

}  // namespace relume::ranks
