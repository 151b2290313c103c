#include "render/render_settings.h"

#include <utility>

namespace relume {
namespace {

void append(SettingList& list, SettingList more) {
  for (Setting& setting : more) list.push_back(std::move(setting));
}

}  // namespace

SettingList describe_image(RenderSettings& s) {
  return {
      {"width", &s.width, "Width of the image", {.min = 1, .max = 32768, .unit = "pixels"}},
      {"height", &s.height, "Height of the image", {.min = 1, .max = 32768, .unit = "pixels"}},
      {"camera", &s.camera, "Name or index (from 0) of the scene's camera; empty: the first"},
      {"animation", &s.animation,
       "Which of the file's animations play: name or index (from 0), several separated by commas, or all; empty: the "
       "first"},
      {"scene-time", &s.time_s, "Time of the animation that is shown", {.min = 0, .max = kLatestTime, .unit = "s"}},
      {"texture-filter", choice(s.texture_filter, {"linear", "encoded"}),
       "How textures are interpolated: after decoding and with mip levels, as glTF asks, or between the sRGB codes at "
       "full resolution, as Cycles does; the latter darkens busy textures"},
      {"seed",
       &s.seed,
       "Another seed gives independent noise; the same seed gives the same bits",
       {.min = 0, .max = kMostSeed}},
      {"stratify", &s.stratify,
       "A pixel's samples are elements of one low-discrepancy sequence; off: independent random numbers, to compare "
       "with"},
      {"dither", &s.dither,
       "Blue-noise dithered sampling: neighbouring pixels differ in their errors as much as they can, so that filters "
       "and "
       "eyes remove more of them"},
      {"threads",
       &s.threads,
       "Worker threads; 0: one for each core; the image does not depend on it",
       {.min = 0, .max = 1024, .resets_history = false}},
  };
}

SettingList describe_slots(RenderSettings& s) {
  return {
      {"estimator",
       choice(s.estimator, {"path", "bdpt", "light"}),
       "How light is transported: paths from the camera that sample lights on their way, paths from camera and light "
       "joined in every way, or paths from the light alone, which lack what is seen in mirrors and through glass",
       {.biases = true}},
      {"lights", choice(s.lights, {"uniform", "power", "light-tree", "static-lists", "vlc"}),
       "Which light a vertex samples: each alike, in proportion to its power, by descending a hierarchy, from lists of "
       "what a cell sees, or among those that were visible nearby in the last frame"},
      {"guide", choice(s.guide, {"bsdf", "cdq"}),
       "Which direction a path takes: in proportion to the material's reflection, or also where light came from in "
       "earlier frames"},
      {"cache",
       choice(s.cache, {"none", "psf", "apsf", "apg", "apsf+apg"}),
       "Radiance cache: none, path space filtering, the same where the variance is low, path graphs, or both",
       {.biases = true}},
      {"allocation",
       choice(s.allocation, {"uniform", "adaptive"}),
       "Paths a pixel gets in a frame: one each, or none where there is little noise",
       {.biases = true}},
      {"history",
       choice(s.history, {"none", "accumulate", "reproject"}),
       "What earlier frames contribute: nothing, the mean of all since the last change, or what can be verified to be "
       "seen still when something moves",
       {.biases = true}},
      {"denoise",
       choice(s.denoise, {"none", "bmfr", "svgf", "oidn"}),
       "Filter over the finished image: none, block by block least squares with what surfaces look like, as wide as "
       "the noise asks for, or the library Open Image Denoise",
       {.biases = true}},
  };
}

SettingList describe_transport(RenderSettings& s) {
  SettingList list = with_prefix("path", describe(s.path));
  for (Setting& setting : list) {
    if (setting.name == "path.max-bounces") setting.name = "max-bounces";
  }
  append(list, with_prefix("bdpt", describe(s.bdpt)));
  append(list, with_prefix("nee", describe(s.light_selection)));
  append(list, with_prefix("static-lists", describe(s.static_lists)));
  append(list, with_prefix("octree", describe(s.octree)));
  append(list, with_prefix("vlc", describe(s.vlc)));
  append(list, with_prefix("cdq", describe(s.cdq)));
  return list;
}

SettingList describe_caches(RenderSettings& s) {
  SettingList list = with_prefix("psf", describe(s.psf));
  append(list, with_prefix("apsf", describe(s.apsf)));
  append(list, with_prefix("apg", describe(s.apg)));
  return list;
}

SettingList describe_frames(RenderSettings& s) {
  SettingList list = with_prefix("firefly", describe(s.firefly));
  append(list, with_prefix("adaptive", describe(s.adaptive)));
  append(list, with_prefix("reproject", describe(s.reproject)));
  return list;
}

SettingList describe_denoisers(RenderSettings& s) {
  SettingList list = with_prefix("features", describe(s.features));
  append(list, with_prefix("bmfr", describe(s.bmfr)));
  append(list, with_prefix("svgf", describe(s.svgf)));
  return list;
}

SettingList describe(RenderSettings& settings) {
  SettingList list = describe_image(settings);
  append(list, describe_slots(settings));
  append(list, describe_transport(settings));
  append(list, describe_caches(settings));
  append(list, describe_frames(settings));
  append(list, describe_denoisers(settings));
  return list;
}

}  // namespace relume
