#include "techniques/temporal/reprojection/settings.h"

namespace relume {

SettingList describe(ReprojectionSettings& s) {
  return {
      {"method", choice(s.method, {"forward", "backward"}),
       "Forward: pixels of the frame before look for their place in this one and are verified by rays; backward: "
       "pixels "
       "look up where they came from, between four neighbours"},
      {"stored", choice(s.stored, {"1", "4"}), "Samples that a pixel stores, each of which may find a place (forward)"},
      {"fill",
       &s.fill,
       "Pixels to which nothing came look back for a history next to where their surface was, in frames in which only "
       "the "
       "camera moves (forward)",
       {.biases = true}},
      {"error",
       &s.error,
       "Largest change of the image that another viewpoint may make, in display units (forward)",
       {.min = 0, .max = 1000, .biases = true}},
      {"light-error",
       &s.light_error,
       "Change of the image by moved lights and shadows, in display units, above which a history counts for "
       "fewer samples the larger it is (forward)",
       {.min = 0, .max = 1000, .biases = true}},
      {"exposure",
       &s.exposure,
       "Exposure at which the image will be seen, for the bounds in display units: those are 2^this of radiance. It "
       "is a setting of its own; --exposure and the viewer's exposure do not change it",
       {.min = -30, .max = 30, .unit = "stops"}},
      {"max-distance",
       &s.max_distance,
       "Samples of one pixel that lie further apart, as a share of their distance, are not taken along; one that lies "
       "further from this frame's sample is not, either",
       {.min = 0, .max = 1, .biases = true}},
      {"max-samples",
       &s.max_samples,
       "Samples that a history counts for at most when the view moves",
       {.min = 1, .max = 1 << 20, .biases = true}},
      {"max-samples-changed",
       &s.max_samples_changed,
       "The same when objects or lights move: light that comes by way of other surfaces is not verified, but fades",
       {.min = 1, .max = 1 << 20, .biases = true}},
  };
}

}  // namespace relume
