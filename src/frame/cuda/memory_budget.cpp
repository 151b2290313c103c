#include "frame/cuda/memory_budget.h"

#include <map>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::cuda {

std::shared_ptr<MemoryBudget> MemoryBudget::of_gpu(DeviceNumber device, bool shareable, const std::string& device_name,
                                                   const std::function<size_t()>& free_bytes) {
  static std::mutex mutex;
  static std::map<DeviceNumber, std::weak_ptr<MemoryBudget>> budgets;
  const std::lock_guard lock(mutex);
  std::weak_ptr<MemoryBudget>& known = budgets[device];
  std::shared_ptr<MemoryBudget> budget = known.lock();
  if (budget && !shareable) {
    throw Error(ErrorCode::device,
                fmt::format("{} is in use by another session, and cannot be shared, because it has no concurrent "
                            "access to managed memory; end that session first, or use --device cpu",
                            device_name));
  }
  if (!budget) known = budget = std::make_shared<MemoryBudget>(free_bytes());
  return budget;
}

bool MemoryBudget::take(size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes > limit_ - used_) return false;
  used_ += bytes;
  return true;
}

void MemoryBudget::give_back(size_t bytes) {
  const std::lock_guard lock(mutex_);
  used_ -= bytes;
}

size_t MemoryBudget::used_bytes() const {
  const std::lock_guard lock(mutex_);
  return used_;
}

}  // namespace relume::cuda
