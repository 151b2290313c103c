#include "ranks/receive_budget.h"

namespace relume::ranks {

std::optional<ReceiveBudget::Grant> ReceiveBudget::next() {
  if (waiting_.empty()) return std::nullopt;
  const Request request = waiting_.front();
  const uint64_t held = *held_;
  if (held > 0 && held + request.bytes > limit_) return std::nullopt;
  waiting_.pop_front();
  *held_ += request.bytes;
  return Grant{request.rank,
               Reservation(held_.get(), [counter = held_, bytes = request.bytes](const void*) { *counter -= bytes; })};
}

void ReceiveBudget::forget(int rank) {
  std::erase_if(waiting_, [rank](const Request& request) { return request.rank == rank; });
}

}  // namespace relume::ranks
