#include "ranks/task_dealer.h"

#include <algorithm>

namespace relume::ranks {

void TaskDealer::wait(int rank, const std::string& host) {
  const auto index = static_cast<size_t>(rank);
  ranks_[index] = {State::waits, host, 0};
  if (std::find(arrivals_.begin(), arrivals_.end(), index) == arrivals_.end()) arrivals_.push_back(index);
}

bool TaskDealer::is_first_of_host(size_t rank) const {
  const auto first = std::find_if(arrivals_.begin(), arrivals_.end(),
                                  [&](size_t other) { return ranks_[other].host == ranks_[rank].host; });
  return first != arrivals_.end() && *first == rank;
}

bool TaskDealer::gets_tasks(size_t rank) const {
  switch (workers_) {
    case TaskRanks::all: return true;
    case TaskRanks::one_per_host: return is_first_of_host(rank);
    case TaskRanks::first: return rank == 0;
  }
  return false;
}

bool TaskDealer::have_all_reported() const {
  for (size_t rank = 0; rank < ranks_.size(); ++rank) {
    if (ranks_[rank].state == State::gone) continue;
    if (std::find(arrivals_.begin(), arrivals_.end(), rank) == arrivals_.end()) return false;
  }
  return true;
}

std::vector<TaskDealer::Deal> TaskDealer::deal() {
  if (workers_ != TaskRanks::all && !have_all_reported())
    return {};  // they may still compute, which would change times
  std::vector<Deal> deals;
  for (size_t rank = 0; rank < ranks_.size() && next_ < tasks_ && !cancelled_; ++rank) {
    if (ranks_[rank].state != State::waits || !gets_tasks(rank)) continue;
    ranks_[rank].state = State::works;
    deals.push_back({static_cast<int>(rank), next_++});
  }
  return deals;
}

bool TaskDealer::is_over() const {
  const bool works =
      std::any_of(ranks_.begin(), ranks_.end(), [](const Rank& rank) { return rank.state == State::works; });
  return !works && (cancelled_ || next_ == tasks_);
}

double TaskDealer::fraction() const {
  double done = static_cast<double>(results_);
  for (const Rank& rank : ranks_) done += rank.state == State::works ? rank.fraction : 0;
  return tasks_ > 0 ? std::min(done / static_cast<double>(tasks_), 1.0) : 1;
}

}  // namespace relume::ranks
