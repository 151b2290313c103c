#include "techniques/denoise/asvgf/settings.h"

#include <algorithm>
#include <cmath>

namespace relume {

SettingList describe(AsvgfSettings& s) {
  return {
      {"alpha",
       &s.alpha,
       "Minimum weight of a frame in the accumulated light while something moves",
       {.min = 0.01, .max = 1, .biases = true}},
      {"antilag",
       &s.antilag,
       "Sensitivity to changes of light, which shorten the history. With 1, a change to half the light gives the "
       "newest frame at least half of the weight; 0: changes of light are ignored",
       {.min = 0, .max = 100, .biases = true}},
      {"view-changes",
       &s.view_changes,
       "Also shorten histories where only the motion of the camera changes the shading, as in highlights; off: "
       "compares samples from the previous view",
       {.biases = true}},
      {"gradient-levels",
       &s.gradient_levels,
       "Filter passes over the changes of light, each twice as wide as the one before",
       {.min = 0, .max = 5, .biases = true}},
      {"levels",
       &s.levels,
       "Filter passes over the light, each twice as wide as the one before",
       {.min = 0, .max = 5, .biases = true}},
      {"light-tolerance",
       &s.light_tolerance,
       "Luminance difference between pixels that the filter tolerates, in standard deviations of the noise",
       {.min = 0.01, .max = 1000, .biases = true}},
      {"plane-tolerance",
       &s.plane_tolerance,
       "Distance from a pixel's plane that the filters tolerate, as a fraction of the distance between the pixels",
       {.min = 0.001, .max = 1000, .biases = true}},
      {"newest",
       &s.newest,
       "Weight of the newest frame in the image while something moves; values below 1 smooth edges",
       {.min = 0.01, .max = 1, .biases = true}},
  };
}

SvgfSettings svgf_settings(const AsvgfSettings& settings, bool gradients) {
  SvgfSettings svgf;
  // A mean of n samples and the newest one weighs that by 1 / (n + 1).
  const int limit = static_cast<int>(std::lround(1.0f / settings.alpha)) - 1;
  svgf.history.max_history = limit;
  svgf.history.max_history_changed = gradients ? limit : std::min(limit, svgf.history.max_history_changed);
  svgf.history.newest = settings.newest;
  svgf.levels = settings.levels;
  svgf.light_tolerance = settings.light_tolerance;
  svgf.plane_tolerance = settings.plane_tolerance;
  return svgf;
}

}  // namespace relume
