#include "techniques/reprojection/reprojection_pass.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "scene/builtin.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 4;
constexpr uint32_t kPixels = kSize * kSize;

std::string state_of(const ReprojectionPass& pass) {
  std::ostringstream out;
  pass.save(out);
  return out.str();
}

/// What a pass saves that holds `stored`, four a pixel, and empty pixels.
std::string state_with(const std::vector<StoredSample>& stored, uint64_t samples, uint64_t pixels) {
  std::string state;
  const auto put = [&](const void* data, size_t size) { state.append(static_cast<const char*>(data), size); };
  put(&samples, sizeof(samples));
  put(&pixels, sizeof(pixels));
  put(stored.data(), stored.size() * sizeof(StoredSample));
  const std::vector<StoredPixel> empty(kPixels);
  put(empty.data(), empty.size() * sizeof(StoredPixel));
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
  ReprojectionPass pass(settings, kPixels);
  EXPECT_TRUE(loads(pass, state));
  EXPECT_EQ(state_of(pass), state);
}

TEST(ReprojectionPass, LoadsWhatWasSavedBeforeTheFirstFrame) {
  const ReprojectionSettings settings;
  ReprojectionPass pass(settings, kPixels);
  EXPECT_TRUE(loads(pass, state_of(ReprojectionPass(settings, kPixels))));
}

// The counts are believed only if they fit the picture: nothing is allocated for them first, or the last would need
// 384 GiB.
TEST(ReprojectionPass, RefusesCountsThatDoNotFitThePicture) {
  const ReprojectionSettings settings;
  const std::vector<StoredSample> stored(4 * kPixels);
  ReprojectionPass pass(settings, kPixels);
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

TEST(ReprojectionPass, RefusesAShortFileAndKeepsWhatItHad) {
  const ReprojectionSettings settings;
  ReprojectionPass pass(settings, kPixels);
  const std::string state = state_with(std::vector<StoredSample>(4 * kPixels), 4 * kPixels, kPixels);
  ASSERT_TRUE(loads(pass, state));
  EXPECT_FALSE(loads(pass, state.substr(0, state.size() - 1)));
  EXPECT_EQ(state_of(pass), state);
}

TEST(ReprojectionPass, DropsLoadedSamplesThatTheSceneCannotHold) {
  CompiledScene scene(find_builtin_scene("cornell")->build(), {.width = kSize, .height = kSize});
  const ReprojectionSettings settings;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<StoredSample> stored(4 * kPixels);
  stored[0].hit = {0, 0, 0.25f, 0.5f, 3};                              // exists
  stored[4].hit = {scene.view().instances.size, 0, 0.25f, 0.5f, 3};    // no such instance
  stored[8].hit = {0, scene.view().triangles.size, 0.25f, 0.5f, 3};    // no such triangle
  stored[12].hit = {0, 0, nan, 0.5f, 3};                               // nowhere on it
  stored[16] = {.hit = {0, 0, 0.25f, 0.5f, 3}, .light_u = {nan, 0}};   // nowhere on a light
  stored[20] = {.hit = {0, 0, 0.25f, 0.5f, 3}, .light_u = {0, -1e9}};  // the same
  ReprojectionPass pass(settings, kPixels);
  ASSERT_TRUE(loads(pass, state_with(stored, 4 * kPixels, kPixels)));

  BufferTable buffers(kSize, kSize);
  Backend backend(1);
  pass.run(FrameContext{scene.view(), buffers, backend, {}, 1, 1, Change::none, {}});
  EXPECT_TRUE(pass.stored()[0].valid());
  for (const size_t i : {4, 8, 12, 16, 20}) EXPECT_FALSE(pass.stored()[i].valid()) << i;
}

}  // namespace
}  // namespace relume
