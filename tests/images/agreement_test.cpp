// Ways to render a scene that must show the same picture in the mean.
#include <gtest/gtest.h>

#include <cctype>
#include <string>

#include "scene/builtin.h"
#include "support/image_test.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

/// A built-in scene, how large, with how many samples a pixel, and when.
struct Case {
  const char* scene;
  int width;
  int height;
  int spp;
  float time_s;
};

constexpr int kSeeds = 16;

// Some seconds a test: errors of several percent show, in the corridor and the warehouse of a fifth
// (ImageTest::resolution).
const Case kQuick[] = {
    {"cornell", 32, 32, 64, 0},  {"cornell-spheres", 32, 32, 32, 0}, {"cornell-glass", 32, 32, 32, 0},
    {"corridor", 32, 32, 64, 0}, {"warehouse", 32, 18, 16, 0},       {"door", 24, 18, 32, 0},
    {"slit", 32, 18, 24, 0.7f},  {"turntable", 32, 18, 32, 1.3f},
};

// Up to minutes a test: resolves half a percent of a block where the light allows.
const Case kSharp[] = {
    {"cornell", 48, 48, 512, 0},  {"cornell-spheres", 48, 48, 256, 0}, {"cornell-glass", 48, 48, 256, 0},
    {"corridor", 32, 32, 256, 0}, {"warehouse", 48, 27, 128, 0},       {"mine", 48, 27, 128, 0},
    {"door", 32, 24, 256, 0},     {"slit", 48, 27, 128, 0.7f},         {"turntable", 48, 27, 256, 1.3f},
};

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.scene;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

class Agreement : public ::testing::TestWithParam<Case> {
 protected:
  Scene scene() const { return find_builtin_scene(GetParam().scene)->build(); }
  RenderSettings settings() const {
    RenderSettings s = small_settings(GetParam().width, GetParam().height);
    s.time_s = GetParam().time_s;
    return s;
  }
  Moments pictures(const RenderSettings& s, int first_seed) const {
    return measure(scene(), s, GetParam().spp, kSeeds, first_seed);
  }
  std::string name(const char* what) const { return std::string(what) + "-" + GetParam().scene; }
};

TEST_P(Agreement, UniformAndPowerLights) {
  RenderSettings uniform = settings();
  uniform.lights = LightSelectionChoice::uniform;
  RenderSettings power = settings();
  power.lights = LightSelectionChoice::power;
  expect_same_picture(name("lights"), pictures(uniform, 1), pictures(power, 1001));
}

TEST_P(Agreement, RussianRouletteOnAndOff) {
  RenderSettings on = settings();
  RenderSettings off = settings();
  off.path.russian_roulette = false;
  expect_same_picture(name("roulette"), pictures(on, 1), pictures(off, 1001));
}

INSTANTIATE_TEST_SUITE_P(Builtin, Agreement, ::testing::ValuesIn(kQuick), case_name);
INSTANTIATE_TEST_SUITE_P(SlowBuiltin, Agreement, ::testing::ValuesIn(kSharp), case_name);

}  // namespace
}  // namespace relume::support
