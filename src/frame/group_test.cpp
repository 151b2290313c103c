#include "frame/group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/fixed_point.h"
#include "frame/launch.h"
#include "testing/group_emulation.h"

namespace relume {
namespace {

/// Reverses the elements of each row in shared memory, and adds their number, which all threads compute alike.
struct ReverseKernel {
  static constexpr uint32_t kThreads = 32;
  struct Shared {
    uint32_t values[100];
    uint32_t count;
  };

  View<uint32_t> values;
  uint32_t length = 0;  ///< of a row

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t, uint32_t row) const {
    group.each(1, [&](uint32_t) { shared.count = 0; });
    group.each(length, [&](uint32_t i) {
      shared.values[i] = values[row * length + i];
      atomic_add(&shared.count, 1u);
    });
    const uint32_t count = shared.count;
    group.each(length, [&](uint32_t i) { values[row * length + i] = shared.values[length - 1 - i] + count; });
  }
};

/// The same with a form for the host, which marks its results.
struct TwoFormsKernel : ReverseKernel {
  void on_host(uint32_t, uint32_t row) const { values[row * length] = 1000; }
};

static_assert(GroupKernel<ReverseKernel> && !HostFormKernel<ReverseKernel> && !PassKernel<ReverseKernel>);

/// Rows of consecutive numbers.
class Rows {
 public:
  Rows(uint32_t length, uint32_t rows) : length_(length), rows_(rows) {
    values_.resize(size_t{length} * rows);
    const auto values = values_.write();
    std::iota(values.begin(), values.end(), 0u);
  }

  ReverseKernel kernel() { return {values_.mutable_view(), length_}; }
  uint32_t rows() const { return rows_; }
  std::vector<uint32_t> values() const { return {values_.read().begin(), values_.read().end()}; }
  /// What a kernel leaves after all rows.
  std::vector<uint32_t> reversed() const {
    std::vector<uint32_t> expected(size_t{length_} * rows_);
    for (uint32_t i = 0; i < expected.size(); ++i)
      expected[i] = i / length_ * length_ + (length_ - 1 - i % length_) + length_;
    return expected;
  }

 private:
  Array<uint32_t> values_;
  uint32_t length_;
  uint32_t rows_;
};

TEST(Group, LaunchesExecuteEachElementOnce) {
  for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
    for (const uint32_t length : {1u, 31u, 32u, 33u, 100u}) {
      Rows rows(length, 37);
      Backend backend(2, form);
      EXPECT_TRUE(launch(backend, "reverse", rows.kernel(), 1, rows.rows()));
      EXPECT_EQ(rows.values(), rows.reversed()) << length;
    }
  }
}

TEST(Group, LaunchesUseTheFormOfTheBackend) {
  for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
    Rows rows(5, 3);
    Backend backend(1, form);
    TwoFormsKernel kernel;
    static_cast<ReverseKernel&>(kernel) = rows.kernel();
    launch(backend, "forms", kernel, 1, rows.rows());
    EXPECT_EQ(rows.values()[5], form == KernelForm::host ? 1000u : rows.reversed()[5]);
  }
}

TEST(Group, LaunchesReportTheKernelAndStop) {
  Rows rows(5, 3);
  const std::vector<uint32_t> before = rows.values();
  Backend backend(1);
  size_t reported = 0;
  backend.on_launch([&](const LaunchEvent& event) { reported += event.argument.size(); });
  std::stop_source source;
  source.request_stop();
  EXPECT_FALSE(launch(backend, "reverse", rows.kernel(), 1, rows.rows(), source.get_token()));
  EXPECT_EQ(rows.values(), before);
  EXPECT_EQ(reported, sizeof(ReverseKernel));
}

/// Wrong: a call depends on the one before it.
struct RunningSumKernel {
  static constexpr uint32_t kThreads = 32;
  struct Shared {
    uint32_t sum;
  };
  View<uint32_t> values;

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t, uint32_t) const {
    group.each(1, [&](uint32_t) { shared.sum = 0; });
    group.each(values.size, [&](uint32_t i) { values[i] = shared.sum += values[i]; });
  }
};

TEST(Group, ShufflingFindsCallsThatDependOnEachOther) {
  Rows rows(100, 7);
  testing::run_shuffled(rows.kernel(), 1, rows.rows(), 1);
  EXPECT_EQ(rows.values(), rows.reversed());

  std::vector<uint32_t> in_order(64, 1);
  std::vector<uint32_t> shuffled = in_order;
  run_group(RunningSumKernel{mutable_view_of(in_order)}, 0, 0, KernelForm::device);
  testing::run_shuffled(RunningSumKernel{mutable_view_of(shuffled)}, 1, 1, 1);
  EXPECT_TRUE(std::is_sorted(in_order.begin(), in_order.end()));
  EXPECT_NE(shuffled, in_order);
}

/// Wrong: code that every thread executes changes what they share.
struct CommonSumKernel {
  static constexpr uint32_t kThreads = 32;
  struct Shared {};
  View<uint32_t> values;

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared&, uint32_t, uint32_t) const {
    atomic_add(&values[0], 1u);
    group.each(values.size, [&](uint32_t i) { atomic_add(&values[i], 1u); });
  }
};

TEST(Group, ThreadsFindCodeThatMustRunOnce) {
  Rows rows(100, 7);
  testing::run_threaded(rows.kernel(), 1, rows.rows());
  EXPECT_EQ(rows.values(), rows.reversed());

  std::vector<uint32_t> values(5, 0);
  testing::run_threaded(CommonSumKernel{mutable_view_of(values)}, 1, 1);
  EXPECT_EQ(values[1], 1u);
  EXPECT_GT(values[0], 2u);
}

}  // namespace
}  // namespace relume
