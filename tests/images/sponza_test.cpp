// Compares a production scene with all textures against Cycles. Its file is not in the repository: RELUME_SCENES is the
// folder of sponza/sponza.gltf.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "relume/scene_io.h"
#include "support/measure.h"

namespace relume::support {
namespace {

/// Sky of radiance (0.25, 0.3, 0.4), six bounces. Mean of an image of 640 × 360 pixels by Cycles 3.4.1 with 1,024
/// samples and a box filter (tools/compare_cycles renders such images).
const Rgb kCycles{0.21621f, 0.15628f, 0.09051f};

class Sponza : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RELUME_SCENES");
    const std::filesystem::path file = std::filesystem::path(folder ? folder : "") / "sponza" / "sponza.gltf";
    if (!folder || !std::filesystem::exists(file)) GTEST_SKIP() << "RELUME_SCENES names no folder with Sponza";
    scene_ = load_scene(file.string());
    scene_.environment.kind = EnvironmentKind::constant;
    scene_.environment.color = Rgb(0.25f, 0.3f, 0.4f);
  }
  Estimate mean(TextureFilter filter) const {
    RenderSettings settings = small_settings(160, 90);
    settings.path.max_bounces = 6;
    settings.texture_filter = filter;
    return estimate_of(render(scene_, settings, 128));
  }
  Scene scene_;
};

TEST_F(Sponza, HasTheMeanOfCyclesWithTheSameTextureFilter) {
  const Estimate estimate = mean(TextureFilter::encoded);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(estimate.mean[c] / kCycles[c], 1, 0.01) << "channel " << c;
}

}  // namespace
}  // namespace relume::support
