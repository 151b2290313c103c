// Counts the allocations of Session::read(), and those of kernel memory in frames of vertex merging. This
// program replaces the global operator new with one that counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <string_view>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "core/array.h"
#include "render/session.h"

namespace {

std::atomic<uint64_t> allocations = 0;  ///< of all threads

void* counted(void* block) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

}  // namespace

// Not inlined: compilers would take the pairs of new and free() for errors. All other forms call these.
[[gnu::noinline]] void* operator new(size_t bytes) { return counted(std::malloc(std::max(bytes, size_t{1}))); }
[[gnu::noinline]] void* operator new(size_t bytes, std::align_val_t alignment) {
  const auto step = static_cast<size_t>(alignment);
  return counted(std::aligned_alloc(step, (std::max(bytes, size_t{1}) + step - 1) / step * step));
}
[[gnu::noinline]] void operator delete(void* block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, size_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, size_t, std::align_val_t) noexcept { std::free(block); }

namespace relume {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 24;

class SessionAllocations : public ::testing::TestWithParam<int> {
 protected:
  static RenderSettings settings(DenoiseChoice denoise = DenoiseChoice::none) {
    RenderSettings s;
    s.width = kWidth;
    s.height = kHeight;
    s.threads = GetParam();
    s.denoise = denoise;
    return s;
  }

  /// Allocations of ten calls in every layout, after one call in each.
  uint64_t of_reading(const Session& session) {
    const auto read_all = [&] {
      for (const PixelLayout layout : {PixelLayout::rgb32f, PixelLayout::rgba32f, PixelLayout::rgba8})
        session.read({.pixels = memory_.data(), .width = kWidth, .height = kHeight, .layout = layout});
    };
    read_all();
    const uint64_t before = allocations.load();
    for (int i = 0; i < 10; ++i) read_all();
    return allocations.load() - before;
  }

 private:
  std::vector<float> memory_ = std::vector<float>(kWidth * kHeight * 4);
};

TEST_P(SessionAllocations, ReadingAllocatesNothing) {
  Session session(find_builtin_scene("cornell")->build(), settings());
  EXPECT_EQ(of_reading(session), 0u) << "before the first frame";
  session.render_frame();
  EXPECT_EQ(of_reading(session), 0u);
  const uint64_t before = allocations.load();
  session.render_frame();
  const Image copy = session.image();
  EXPECT_GT(allocations.load(), before) << "an image is new memory, so the counter counts";
  EXPECT_EQ(of_reading(session), 0u) << "after a later frame";
}

TEST_P(SessionAllocations, ReadingADenoisedOrKeptImageAllocatesNothing) {
  Session session(find_builtin_scene("cornell")->build(), settings(DenoiseChoice::svgf));
  session.render_frame();
  EXPECT_EQ(of_reading(session), 0u);
  ASSERT_TRUE(session.set_settings(settings()));  // displays the last complete frame
  EXPECT_EQ(of_reading(session), 0u);
}

/// Host memory that counts the blocks it has given out.
class CountedMemory final : public Memory {
 public:
  void* allocate(size_t bytes, size_t alignment) override {
    ++allocations_;
    return host_memory().allocate(bytes, alignment);
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    host_memory().deallocate(block, bytes, alignment);
  }
  uint64_t allocations() const { return allocations_; }

 private:
  std::atomic<uint64_t> allocations_ = 0;
};

/// Largest number of sorted light vertices in any of the next `frames` frames.
double most_vertices(Session& session, int frames) {
  double most = 0;
  for (int i = 0; i < frames; ++i) {
    session.render_frame();
    for (const PassStatistic& s : session.statistics().pass_statistics) {
      if (std::string_view(s.name).ends_with("merging-vertices")) most = std::max(most, s.value);
    }
  }
  return most;
}

TEST_P(SessionAllocations, SteadyFramesOfVcmAllocateNoKernelMemory) {
  CountedMemory memory;
  RenderSettings s = settings();
  s.estimator = EstimatorChoice::vcm;
  s.vcm.radius = 0.03f;
  Session session = make_session(find_builtin_scene("cornell")->build(), s, memory);
  const double first = most_vertices(session, 2);
  const uint64_t before = memory.allocations();
  EXPECT_GT(before, 0u);
  EXPECT_GT(most_vertices(session, 60), first) << "no frame had more vertices than the first ones";
  EXPECT_EQ(memory.allocations(), before);
}

INSTANTIATE_TEST_SUITE_P(Threads, SessionAllocations, ::testing::Values(1, 2));

}  // namespace
}  // namespace relume
