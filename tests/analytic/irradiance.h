// Tests of irradiance, for every light selection.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {

inline const auto kLightSelections = ::testing::Values(LightSelectionChoice::uniform, LightSelectionChoice::power);

inline std::string light_selection_name(const ::testing::TestParamInfo<LightSelectionChoice>& info) {
  return info.param == LightSelectionChoice::uniform ? "uniform" : "power";
}

class IrradianceTest : public ::testing::TestWithParam<LightSelectionChoice> {
 protected:
  /// What direct light leaves on the white patch of an irradiance_meter(), W/m², within 0.2 %.
  void expect_irradiance(Scene scene, const Rgb& expected, int spp = 2048) const {
    RenderSettings settings = small_settings(12, 12);
    settings.lights = GetParam();
    settings.path.max_bounces = 1;
    Estimate e = estimate_of(render(std::move(scene), settings, spp));
    e.mean *= kPi;
    e.standard_error *= kPi;
    expect_near(e, expected, 0.002);
  }
};

}  // namespace relume::support
