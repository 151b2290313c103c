// Settings of A-SVGF.
#pragma once

#include "techniques/denoise/svgf/settings.h"

namespace relume {

struct AsvgfSettings {
  float alpha = 0.1f;
  float antilag = 1;
  bool view_changes = false;
  int gradient_levels = 5;
  int levels = SvgfSettings{}.levels;
  float light_tolerance = SvgfSettings{}.light_tolerance;
  float plane_tolerance = SvgfSettings{}.plane_tolerance;
  float newest = DenoiserHistorySettings{}.newest;
};

SettingList describe(AsvgfSettings& settings);

/// Settings of the part that A-SVGF shares with SVGF. `gradients`: changes of light are found by gradients, not by
/// blocks.
SvgfSettings svgf_settings(const AsvgfSettings& settings, bool gradients);

}  // namespace relume
