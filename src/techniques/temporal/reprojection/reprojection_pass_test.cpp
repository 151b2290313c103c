#include "techniques/temporal/reprojection/reprojection_pass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "frame/moments.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

constexpr BufferKey<float> kProbability{"sampling-probability"};

constexpr uint32_t kSize = 4;
constexpr uint32_t kPixels = kSize * kSize;

std::string state_of(const ReprojectionPass& pass) {
  std::ostringstream out;
  pass.save(out);
  return out.str();
}

/// Saved state with `samples` stored samples, the first of them `stored`, and `pixels` empty pixels. Of larger counts,
/// only 8 kPixels elements follow.
std::string state_with(std::vector<StoredSample> stored, uint64_t samples, uint64_t pixels) {
  constexpr uint64_t kMost = 8 * kPixels;
  std::string state;
  const auto put = [&](uint64_t count, const auto& values) {
    state.append(reinterpret_cast<const char*>(&count), sizeof(count));
    state.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  stored.resize(std::min(samples, kMost));
  put(samples, stored);
  put(pixels, std::vector<StoredPixel>(std::min(pixels, kMost)));
  return state;
}

bool loads(ReprojectionPass& pass, const std::string& state) {
  std::istringstream in(state);
  pass.load(in);
  return static_cast<bool>(in);
}

TEST(ReprojectionPass, SavesAndLoads) {
  const ReprojectionSettings settings;
  std::vector<StoredSample> stored(4 * kPixels);
  stored[5].hit = {1, 2, 0.25f, 0.5f, 3};
  const std::string state = state_with(stored, 4 * kPixels, kPixels);
  ReprojectionPass pass(settings, kPixels, {}, host_memory());
  EXPECT_TRUE(loads(pass, state));
  EXPECT_EQ(state_of(pass), state);
}

TEST(ReprojectionPass, LoadsStateSavedBeforeTheFirstFrame) {
  const ReprojectionSettings settings;
  ReprojectionPass pass(settings, kPixels, {}, host_memory());
  EXPECT_TRUE(loads(pass, state_of(ReprojectionPass(settings, kPixels, {}, host_memory()))));
}

// A count is accepted only if its elements follow and it fits the image; the last would need 384 GiB.
TEST(ReprojectionPass, RefusesCountsThatDoNotFitTheImage) {
  const ReprojectionSettings settings;
  const std::vector<StoredSample> stored(4 * kPixels);
  ReprojectionPass pass(settings, kPixels, {}, host_memory());
  const std::string before = state_of(pass);
  const uint64_t huge = uint64_t{1} << 33;
  const uint64_t counts[][2] = {{4 * kPixels, 2 * kPixels},
                                {4 * kPixels - 1, kPixels},
                                {0, kPixels},
                                {4 * kPixels, 0},
                                {5 * kPixels, kPixels},
                                {huge, huge},
                                {huge, kPixels}};
  for (const auto& [samples, pixels] : counts) {
    EXPECT_FALSE(loads(pass, state_with(stored, samples, pixels))) << samples << ' ' << pixels;
    EXPECT_EQ(state_of(pass), before);
  }
}

TEST(ReprojectionPass, RejectsTruncatedFilesWithoutChange) {
  const ReprojectionSettings settings;
  ReprojectionPass pass(settings, kPixels, {}, host_memory());
  const std::string state = state_with(std::vector<StoredSample>(4 * kPixels), 4 * kPixels, kPixels);
  ASSERT_TRUE(loads(pass, state));
  EXPECT_FALSE(loads(pass, state.substr(0, state.size() - 1)));
  EXPECT_EQ(state_of(pass), state);
}

TEST(ReprojectionPass, DropsLoadedSamplesInvalidForTheScene) {
  CompiledScene scene(find_builtin_scene("cornell")->build(), {.width = kSize, .height = kSize});
  const ReprojectionSettings settings;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<StoredSample> stored(4 * kPixels);
  stored[0].hit = {0, 0, 0.25f, 0.5f, 3};                              // exists
  stored[4].hit = {scene.view().instances.size, 0, 0.25f, 0.5f, 3};    // no such instance
  stored[8].hit = {0, scene.view().triangles.size, 0.25f, 0.5f, 3};    // no such triangle
  stored[12].hit = {0, 0, nan, 0.5f, 3};                               // outside the triangle
  stored[16] = {.hit = {0, 0, 0.25f, 0.5f, 3}, .light_u = {nan, 0}};   // outside the light
  stored[20] = {.hit = {0, 0, 0.25f, 0.5f, 3}, .light_u = {0, -1e9}};  // outside the light
  ReprojectionPass pass(settings, kPixels, {}, host_memory());
  ASSERT_TRUE(loads(pass, state_with(stored, 4 * kPixels, kPixels)));

  BufferTable buffers(kSize, kSize);
  for (const BufferId& id : moment_ids(kMoments)) buffers.add({.id = id});
  for (const BufferDescription& owned : pass.declaration().owns) buffers.add(owned);
  Backend backend(1);
  pass.run(FrameContext(scene.view(), buffers, backend, {.number = 1, .since_change = 1}));
  EXPECT_TRUE(pass.stored()[0].valid());
  for (const uint32_t i : {4u, 8u, 12u, 16u, 20u}) EXPECT_FALSE(pass.stored()[i].valid()) << i;
}

/// A plane that moved to the right by one pixel, with a history of 1000 samples per pixel and a buffer of adaptive
/// sampling.
struct MovedPlane {
  explicit MovedPlane(const ReprojectionPass& pass) {
    for (const BufferDescription& buffer : pass.declaration().owns) buffers.add(buffer);
    for (const BufferId& id : moment_ids(kMoments)) buffers.add({.id = id});
    buffers.add({.id = kProbability, .follows_surface = true});
    for (const BufferId& id : {BufferId(kSurface.motion), BufferId(kSurface.previous), BufferId(kSurface.position),
                               BufferId(kSurface.normal), BufferId(kSurface.depth), BufferId(kSurface.surface)})
      buffers.add({.id = id, .double_buffered = true});
    if (!buffers.find(kPrimaryHits.name)) buffers.add({.id = kPrimaryHits});
    std::fill_n(buffers.mutable_view(kSurface.normal).data, kPixels, Vec3(0, 0, 1));
    buffers.swap();
    for (uint32_t i = 0; i < kPixels; ++i) {
      buffers.mutable_view(kMoments.m2_rgb)[i] = 6 * number(i);
      buffers.mutable_view(kMoments.m2)[i] = number(i);
      buffers.mutable_view(kProbability)[i] = 0.01f * number(i);
      buffers.mutable_view(kSamples)[i] = 1000;
      buffers.mutable_view(kSurface.motion)[i] = Vec2(1, 0);
      buffers.mutable_view(kSurface.normal)[i] = Vec3(0, 0, 1);
      buffers.mutable_view(kSurface.depth)[i] = 1;
    }
  }
  /// A distinct value for pixel i.
  static float number(uint32_t i) { return static_cast<float>(i + 1); }

  BufferTable buffers{kSize, kSize};
};

/// Backward reprojection of the plane.
struct Backward {
  CompiledScene scene{find_builtin_scene("cornell")->build(), {.width = kSize, .height = kSize}};
  ReprojectionSettings settings{.method = ReprojectionMethod::backward};
  ReprojectionPass pass{settings, kPixels, {.m2_rgb = true}, host_memory()};
  MovedPlane plane{pass};
  Backend backend{1};

  void run(uint32_t number, Change changes) {
    pass.configure(settings);
    pass.run(FrameContext(scene.view(), plane.buffers, backend, {.number = number, .changes = changes}));
  }
};

TEST(ReprojectionPass, BackwardTakesAlongAllThatFollowsTheSurface) {
  Backward b;
  b.settings.max_samples_changed = 16;
  b.run(1, Change::camera | Change::lights);
  const View<const float> m2_rgb = b.plane.buffers.view(kInherited.m2_rgb);
  const View<const float> m2 = b.plane.buffers.view(kInherited.m2);
  const View<const float> probability = b.plane.buffers.view(kProbability);
  const View<const uint32_t> samples = b.plane.buffers.view(kInherited.samples);
  for (uint32_t i = 0; i < kPixels; ++i) {
    const bool known = i % kSize > 0;  // column 0 enters the image
    const float number = known ? MovedPlane::number(i - 1) : 0.0f;
    EXPECT_EQ(samples[i], known ? 16u : 0u) << i;
    // The variance of a sample stays under any limit of the count.
    EXPECT_FLOAT_EQ(m2[i] / 15, number / 999) << i;
    EXPECT_FLOAT_EQ(m2_rgb[i] / 15, 6 * number / 999) << i;
    EXPECT_EQ(probability[i], 0.01f * number) << i;
  }
}

TEST(ReprojectionPass, ReportsAllHistoriesKeptWithoutMotion) {
  Backward b;
  uint32_t number = 0;
  const auto kept_after = [&](Change changes) {
    b.run(number++, changes);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < kPixels; ++i) {
      EXPECT_EQ(b.plane.buffers.view(kHistoryReason)[i] == 1, b.plane.buffers.view(kHistoryKept)[i] == 1);
      kept += b.plane.buffers.view(kHistoryKept)[i];
    }
    return kept;
  };
  EXPECT_EQ(kept_after(Change::none), 0u);  // the first frame
  EXPECT_EQ(kept_after(Change::none), kPixels);
  EXPECT_EQ(kept_after(Change::camera), kPixels - kSize);  // one column enters the image
  EXPECT_EQ(kept_after(Change::none), kPixels);
  EXPECT_EQ(kept_after(Change::materials), 0u);
  EXPECT_EQ(kept_after(Change::none), kPixels);
}

TEST(ReprojectionPass, BackwardStoresNoSamples) {
  Backward b;
  b.run(1, Change::camera);
  EXPECT_TRUE(b.pass.stored().empty());
  EXPECT_LE(b.pass.memory_bytes(), 16 * kPixels);
  EXPECT_EQ(state_of(b.pass).size(), 2 * sizeof(uint64_t));  // two counts of zero
  EXPECT_TRUE(loads(b.pass, state_of(b.pass)));
}

}  // namespace
}  // namespace relume
