// Tests that all techniques render the same image in expectation.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "builtin_scenes/builtin.h"
#include "support/image_test.h"
#include "support/scenes.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

/// A built-in scene with its image size, samples per pixel and time. The last numbers are the relative errors that the
/// comparison must detect, per block and in the image's mean (ImageTest::detectable).
struct Case {
  const char* scene;
  int width;
  int height;
  int spp;
  float time_s;
  double blocks = 0.1;
  double mean = 0.05;
};

constexpr int kSeeds = 16;

// Some seconds per test. Excludes scenes where few paths reach lights: a short test would miss a black block of some,
// and differences of 40 % in others. The slow tests include them.
const Case kQuick[] = {
    {"cornell", 32, 32, 64, 0},
    {"cornell-spheres", 32, 32, 32, 0},
    {"turntable", 32, 18, 32, 1.3f},
};

// Up to minutes per test.
const Case kSharp[] = {
    {"cornell", 48, 48, 512, 0, 0.02, 0.01},
    {"cornell-spheres", 48, 48, 256, 0, 0.02, 0.01},
    {"cornell-glass", 48, 48, 256, 0, 0.12, 0.05},
    {"corridor", 32, 32, 256, 0, 0.45, 0.22},
    {"warehouse", 48, 27, 128, 0, 0.2, 0.08},
    {"mine", 48, 27, 128, 0, 0.04, 0.02},
    {"door", 32, 24, 256, 0},
    {"slit", 48, 27, 128, 0.7f, 0.04, 0.03},
    {"turntable", 48, 27, 256, 1.3f, 0.02, 0.01},
};

std::string case_name(const ::testing::TestParamInfo<Case>& info) { return test_name(info.param.scene); }

class Agreement : public ::testing::TestWithParam<Case> {
 protected:
  Scene scene() const { return find_builtin_scene(GetParam().scene)->build(); }
  RenderSettings settings() const {
    RenderSettings s = small_settings(GetParam().width, GetParam().height);
    s.time_s = GetParam().time_s;
    return s;
  }
  Moments images(const RenderSettings& s, int first_seed) const {
    return measure(scene(), s, GetParam().spp, kSeeds, first_seed);
  }
  /// Images with the default settings, rendered once per process: both tests of a case compare with them.
  const Moments& plain_images() const {
    static std::map<std::pair<std::string, int>, Moments> known;
    const auto [found, is_new] = known.try_emplace({GetParam().scene, GetParam().spp});
    if (is_new) found->second = images(settings(), 1);
    return found->second;
  }
  void expect_same_as_plain(const char* what, const RenderSettings& s) const {
    expect_same_image(std::string(what) + "-" + GetParam().scene, plain_images(), images(s, 1001),
                      {.detectable = GetParam().blocks, .detectable_mean = GetParam().mean});
  }
};

TEST_P(Agreement, UniformAndPowerLights) {
  RenderSettings uniform = settings();
  ASSERT_EQ(uniform.lights, LightSelectionChoice::power);
  uniform.lights = LightSelectionChoice::uniform;
  expect_same_as_plain("lights", uniform);
}

TEST_P(Agreement, RussianRouletteOnAndOff) {
  RenderSettings off = settings();
  ASSERT_TRUE(off.path.russian_roulette);
  off.path.russian_roulette = false;
  expect_same_as_plain("roulette", off);
}

INSTANTIATE_TEST_SUITE_P(Builtin, Agreement, ::testing::ValuesIn(kQuick), case_name);
INSTANTIATE_TEST_SUITE_P(SlowBuiltin, Agreement, ::testing::ValuesIn(kSharp), case_name);

}  // namespace
}  // namespace relume::support
