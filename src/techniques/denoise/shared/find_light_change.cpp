#include "techniques/denoise/shared/find_light_change.h"

#include "techniques/denoise/shared/light_change.h"

namespace relume {

View<const float> LightChange::discounts(const FrameContext& frame, const LightHistory& history) {
  if (!includes(frame.changes, Change::geometry | Change::lights)) return {};
  const uint32_t columns = change_blocks(frame.width());
  const uint32_t rows = change_blocks(frame.height());
  departures_.reset(static_cast<size_t>(columns) * rows, kUninitialized);
  discounts_.reset(departures_.size(), kUninitialized);
  // Blocks are few and expensive, so each task treats a small square of them.
  constexpr uint32_t kTasks = 4;
  const CompareBlocksKernel compare{history, departures_.mutable_view(), frame.width(), frame.height()};
  frame.launch("light-change", compare, {columns, rows, kTasks});
  const DiscountBlocksKernel discount{departures_.view(), discounts_.mutable_view(), columns, rows};
  frame.launch("light-change", discount, {columns, rows});
  return discounts_.view();
}

}  // namespace relume
