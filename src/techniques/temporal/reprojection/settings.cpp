#include "techniques/temporal/reprojection/settings.h"

namespace relume {

SettingList describe(ReprojectionSettings& s) {
  return {
      {"method", choice(s.method, {"forward", "backward"}),
       "forward: pixels of the previous frame move to their new positions and are verified by rays; backward: pixels "
       "look up their old positions, interpolated between four neighbours"},
      {"stored", choice(s.stored, {"1", "4"}),
       "Samples stored per pixel, each of which may find a new position (forward)"},
      {"fill",
       &s.fill,
       "Let pixels without a history look it up at the old position of their surface, in frames where only the camera "
       "moved (forward)",
       {.biases = true}},
      {"error",
       &s.error,
       "Maximum change of a stored sample due to the new viewpoint, in display units (forward)",
       {.min = 0, .max = 1000, .biases = true}},
      {"light-error",
       &s.light_error,
       "Change due to moved lights and shadows, in display units, above which a history counts for fewer samples in "
       "proportion (forward)",
       {.min = 0, .max = 1000, .biases = true}},
      {"exposure",
       &s.exposure,
       "Exposure of the bounds in display units, which are radiance times 2 to this power; independent of --exposure "
       "and of the viewer's exposure",
       {.min = -30, .max = 30, .unit = "stops"}},
      {"max-distance",
       &s.max_distance,
       "Maximum distance between the samples of a pixel, and from this frame's sample, relative to their depth; beyond "
       "it the history is rejected",
       {.min = 0, .max = 1, .biases = true}},
      {"max-samples",
       &s.max_samples,
       "Maximum number of samples in a history when the view moves",
       {.min = 1, .max = 1 << 20, .biases = true}},
      {"max-samples-changed",
       &s.max_samples_changed,
       "Maximum number of samples in a history when objects or lights move: indirect light is not verified, so old "
       "samples must fade",
       {.min = 1, .max = 1 << 20, .biases = true}},
  };
}

}  // namespace relume
