#include "frame/launch.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/parallel.h"

namespace relume {
namespace {

void wait_ms(int count) { std::this_thread::sleep_for(std::chrono::milliseconds(count)); }

/// One element works for a while, the others do nothing.
struct UnevenKernel {
  RELUME_HD void operator()(uint32_t x, uint32_t) const {
    if (x == 0) wait_ms(40);
  }
};

TEST(Backend, ThreadsThatWaitForOthersAreIdle) {
  Backend backend(2);
  backend.run("serial", [] { wait_ms(40); });
  backend.run("loop", [] { parallel_tasks(2, [](int i) { wait_ms(i == 0 ? 40 : 0); }); });
  launch(backend, "launch", UnevenKernel{}, 64, 1);
  ASSERT_EQ(backend.times().size(), 3u);
  for (const LaunchTime& time : backend.times()) {
    EXPECT_GE(time.seconds, 0.04) << time.name;
    EXPECT_GE(time.idle_s, 0.02) << time.name;
    EXPECT_LE(time.idle_s, 1.1 * time.seconds) << time.name;  // one of two threads works
  }
}

TEST(Backend, CountsNestedLaunchesOnce) {
  Backend backend(2);
  backend.run("outer", [&] {
    wait_ms(20);
    backend.run("inner", [&] {
      wait_ms(40);
      backend.run("innermost", [] { wait_ms(60); });
    });
    launch(backend, "launch", UnevenKernel{}, 1, 1);  // 40 ms
    EXPECT_THROW(backend.run("failed",
                             [&] {
                               backend.run("innermost", [] { wait_ms(60); });
                               throw std::runtime_error("expected");
                             }),
                 std::runtime_error);
  });
  backend.run("other", [] { wait_ms(20); });
  const auto milliseconds = [&](std::string_view name) {
    const std::vector<LaunchTime>& all = backend.times();
    const auto found = std::find_if(all.begin(), all.end(), [&](const LaunchTime& time) { return time.name == name; });
    return found == all.end() ? 0.0 : 1000 * found->seconds;
  };
  double sum = 0;
  for (const LaunchTime& time : backend.times()) {
    sum += 1000 * time.seconds;
    EXPECT_LE(time.idle_s, 1.1 * time.seconds) << time.name;  // one of two threads works
  }
  EXPECT_GE(sum, 20 + 40 + 60 + 40 + 60 + 20);
  EXPECT_GE(milliseconds("outer"), 20);
  EXPECT_LT(milliseconds("outer"), milliseconds("innermost")) << "without the launches in it";
  EXPECT_GE(milliseconds("inner"), 40);
  EXPECT_LT(milliseconds("inner"), milliseconds("innermost"));
  EXPECT_GE(milliseconds("innermost"), 120);
  EXPECT_GE(milliseconds("other"), 20);
}

/// Counts the calls of its forms.
struct TwoFormsKernel {
  std::atomic<int>* elements;
  std::atomic<int>* tiles;

  RELUME_HD void operator()(uint32_t, uint32_t) const { ++*elements; }
  void operator()(const Tile&) const { ++*tiles; }
};

TEST(Backend, RunsTheChosenForm) {
  for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
    std::atomic<int> elements = 0;
    std::atomic<int> tiles = 0;
    Backend backend(2, form);
    launch(backend, "forms", TwoFormsKernel{&elements, &tiles}, 2 * kTileSize, kTileSize + 1);
    EXPECT_EQ(tiles, form == KernelForm::host ? 4 : 0);
    EXPECT_EQ(elements, form == KernelForm::host ? 0 : 2 * kTileSize * (kTileSize + 1));
  }
}

/// Has padding.
struct PaddedKernel {
  uint8_t small = 1;
  View<uint32_t> values;

  RELUME_HD void operator()(uint32_t x, uint32_t) const { values[x] = small; }
};

TEST(Backend, ReportsTheOutermostLaunch) {
  Backend backend(2);
  std::string steps;
  backend.on_launch([&](const LaunchEvent& event) {
    const char* const kinds[] = {"kernel ", "begins ", "ends "};
    steps += kinds[static_cast<int>(event.kind)] + std::string(event.name) + "; ";
  });
  launch(backend, "one", UnevenKernel{}, 1, 1);
  backend.run("two", [&] { launch(backend, "three", UnevenKernel{}, 1, 1); });
  EXPECT_THROW(backend.run("four", [] { throw std::runtime_error("expected"); }), std::runtime_error);
  EXPECT_EQ(steps, "kernel one; begins one; ends one; begins two; kernel three; ends two; begins four; ends four; ");
  backend.on_launch({});
  backend.run("five", [] {});
  EXPECT_EQ(steps.find("five"), std::string::npos);
}

TEST(Backend, ReportsTheTilesOfLaunches) {
  Backend backend(2);
  std::vector<LaunchTiles> grids;
  backend.on_launch([&](const LaunchEvent& event) {
    if (event.kind == LaunchEvent::Kind::begins) grids.push_back(event.grid);
  });
  std::atomic<int> elements = 0;
  std::atomic<int> tiles = 0;
  launch(backend, "tiles", TwoFormsKernel{&elements, &tiles}, 5, 3, {}, 2);
  backend.run("host code", [] {});
  EXPECT_EQ(tiles, 6);
  ASSERT_EQ(grids.size(), 2u);
  EXPECT_EQ(grids[0].tiles(), 6u);
  const Tile last = grids[0].tile(5);
  EXPECT_EQ(last.x0, 4u);
  EXPECT_EQ(last.y0, 2u);
  EXPECT_EQ(last.width(), 1u);
  EXPECT_EQ(last.height(), 1u);
  EXPECT_EQ(grids[1].tile_size, 0u);
}

TEST(Backend, ReportsArgumentsWithoutUndefinedBytes) {
#if !__has_builtin(__builtin_clear_padding)
  GTEST_SKIP() << "the compiler cannot clear padding";
#endif
  Backend backend(1);
  Array<uint32_t> values(backend.memory());
  values.reset(4);
  alignas(PaddedKernel) std::byte storage[sizeof(PaddedKernel)];
  std::memset(storage, 0xff, sizeof(storage));
  const PaddedKernel& kernel = *new (storage) PaddedKernel{1, values.mutable_view()};
  const auto filled = [](std::span<const std::byte> bytes) {
    return std::count(bytes.begin(), bytes.end(), std::byte{0xff});
  };
  ASSERT_GT(filled(storage), 0) << "the kernel in memory keeps the bytes between its members";
  uint32_t* const address = values.mutable_view().data;
  const std::ptrdiff_t of_address = filled(std::as_bytes(std::span(&address, 1)));
  std::ptrdiff_t reported = -1;
  backend.on_launch([&](const LaunchEvent& event) {
    if (event.kind == LaunchEvent::Kind::kernel) reported = filled(event.argument);
  });
  launch(backend, "fill", kernel, 4, 1);
  EXPECT_EQ(reported, of_address);
  EXPECT_EQ(values.read()[3], 1u);
}

/// Produces denormal numbers, and takes one as an operand.
struct SmallNumbersKernel {
  View<const float> values;  ///< 1e-20, 3 · 2^-127, 2^-126, 2^-127
  View<float> results;

  RELUME_HD void operator()(uint32_t, uint32_t) const {
    results[0] = values[0] * values[0];
    results[1] = values[1] - values[2];
    results[2] = values[2] * 0.5f;
    results[3] = values[3] * 4.0f;
  }
};

std::array<uint32_t, 4> bits_of(std::span<const float> x) {
  return {std::bit_cast<uint32_t>(x[0]), std::bit_cast<uint32_t>(x[1]), std::bit_cast<uint32_t>(x[2]),
          std::bit_cast<uint32_t>(x[3])};
}

TEST(Backend, KeepsOrFlushesDenormalsWhateverItsCallerDoes) {
  constexpr std::array<uint32_t, 4> kKept{71362, 0x00400000, 0x00400000, 0x01000000};  // in units of 2^-149
  for (const Denormals mode : {Denormals::keep, Denormals::flush}) {
    const std::array<uint32_t, 4> expected = mode == Denormals::keep ? kKept : std::array<uint32_t, 4>{};
    for (const Denormals caller : {Denormals::keep, Denormals::flush}) {
      for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
        Backend backend(2, form, host_memory(), mode);
        Array<float> values;
        values.assign(std::array{1e-20f, 0x3p-127f, 0x1p-126f, 0x1p-127f});
        Array<float> results;
        results.reset(4);
        const SmallNumbersKernel kernel{values.view(), results.mutable_view()};
        const DenormalMode mode_of_caller(caller);
        launch(backend, "kernel", kernel, 1, 1);
        EXPECT_EQ(bits_of(results.read()), expected);
        results.reset(4);
        backend.run("host", [&] { kernel(0, 0); });
        EXPECT_EQ(bits_of(results.read()), expected);
        results.reset(4);
        backend.execute([&] { kernel(0, 0); });
        EXPECT_EQ(bits_of(results.read()), expected);
      }
    }
  }
}

TEST(Backend, OneThreadIsNeverIdle) {
  Backend backend(1);
  backend.run("loop", [] { parallel_tasks(4, [](int) { wait_ms(5); }); });
  EXPECT_LT(backend.times().at(0).idle_s, 0.1 * backend.times()[0].seconds);
}

}  // namespace
}  // namespace relume
