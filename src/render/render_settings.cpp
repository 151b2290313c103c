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
       "Animations to play: name or index (from 0), several separated by commas, or all; empty: the first"},
      {"scene-time", &s.time_s, "Time in the animation", {.min = 0, .max = kLatestTime, .unit = "s"}},
      {"shutter",
       &s.shutter_s,
       "Exposure, around the time of the frame, for motion blur of what the animation moves; 0: none",
       {.min = 0, .max = kLatestTime, .unit = "s"}},
      {"shutter-keys",
       &s.shutter_keys,
       "Poses within the exposure, made odd. Between two of them, points move along straight lines: a turn by an angle "
       "a from one pose to the next shrinks by at most 1 - cos(a/2)",
       {.min = 3, .max = 65}},
      {"texture-filter", choice(s.texture_filter, {"linear", "encoded"}),
       "Texture interpolation. linear: of decoded texels, with mip levels, as glTF requires; encoded: of sRGB codes at "
       "full resolution, as in Cycles, which darkens detailed textures"},
      {"accel", choice(s.accel, {"embree", "bvh"}),
       "Acceleration structure of ray queries: embree, which is faster, or relume's own BVH. Hits differ only at "
       "edges, "
       "on coincident surfaces and for rays that start on a surface"},
      {"device", &s.device,
       "Device that renders: cpu; cuda or cuda:N, an NVIDIA GPU (relume devices lists them); auto, the first usable "
       "GPU, else cpu. A GPU traces rays with relume's BVH: its images should equal those of --device cpu --accel bvh, "
       "bit for bit"},
      {"seed",
       &s.seed,
       "Random seed: the same seed gives the same bits, another seed gives independent noise",
       {.min = 0, .max = kMostSeed}},
      {"stratify", &s.stratify,
       "Take the samples of a pixel from one low-discrepancy sequence; off: independent random numbers, for "
       "comparison"},
      {"dither", &s.dither,
       "Blue-noise dithering: neighbouring pixels get dissimilar errors, which filters and the eye remove more easily"},
      {"threads",
       &s.threads,
       "Worker threads; 0: one per core; the image does not depend on their number",
       {.min = 0, .max = 1024, .resets_history = false}},
      {"scalar-kernels",
       &s.scalar_kernels,
       "Run the device form of kernels on the host, instead of the form for vector registers and ray packets: the same "
       "bits, slower; for comparison",
       {.resets_history = false}},
  };
}

SettingList describe_slots(RenderSettings& s) {
  return {
      {"estimator",
       choice(s.estimator, {"path", "bdpt", "light", "vcm"}),
       "Light transport. path: camera paths with next event estimation; bdpt: bidirectional path tracing; light: light "
       "tracing only, which misses surfaces seen in mirrors and through smooth glass; vcm: vertex connection and "
       "merging, which adds photon mapping to bdpt and blurs the light that it merges",
       {.biases = true}},
      {"lights", choice(s.lights, {"uniform", "power", "light-tree", "static-lists", "vlc", "neeat", "mcls"}),
       "Light sampling: uniform, by power, with a light BVH, from per-cell lists of visible lights, or learned from "
       "earlier frames. vlc: lights that were visible nearby; neeat: lists of lights that were useful to the pixels of "
       "a screen tile (NEE-AT); mcls: Markov chains that remember lights which contributed nearby"},
      {"guide", choice(s.guide, {"bsdf", "cdq", "mcpg"}),
       "Direction sampling: by the BSDF, or by a mixture of the BSDF and the light that arrived in earlier frames "
       "(path guiding): cdq stores it in quadtrees, mcpg as lobes of Markov chains"},
      {"reuse", choice(s.reuse, {"none", "ris", "restir-di", "restir-gi", "restir-di+gi", "restir-pt"}),
       "Reservoirs at primary hits. none; ris: for direct light, chooses one of several lights by the light that the "
       "surface would reflect from it (resampled importance sampling); restir-di: also reuses the choices of earlier "
       "frames and of neighbouring pixels (ReSTIR DI); restir-gi: reuses their indirect light instead (ReSTIR GI); "
       "restir-di+gi: both, each with its own settings; restir-pt: reuses their whole paths (ReSTIR PT)"},
      {"cache",
       choice(s.cache, {"none", "psf", "apsf", "apg", "apsf+apg", "sharc"}),
       "Radiance cache: none, path space filtering, its adaptive form, adaptive path graphs, both adaptive techniques, "
       "or a spatially hashed radiance cache (SHaRC), in which paths end after their first rough bounce",
       {.biases = true}},
      {"allocation",
       choice(s.allocation, {"uniform", "adaptive"}),
       "Samples per pixel and frame: one each, or one or none, depending on noise (adaptive sampling)",
       {.biases = true}},
      {"history",
       choice(s.history, {"none", "accumulate", "reproject"}),
       "Use of earlier frames: none, the mean of all frames since the last change, or samples that move with their "
       "surfaces",
       {.biases = true}},
      {"denoise",
       choice(s.denoise, {"none", "bmfr", "svgf", "asvgf", "oidn"}),
       "Denoiser: none, blockwise regression on surface features (BMFR), variance-guided filtering (SVGF), the same "
       "with histories shortened where repeated paths find different light (A-SVGF), or Open Image Denoise",
       {.biases = true}},
  };
}

SettingList describe_transport(RenderSettings& s) {
  SettingList list = with_prefix("path", describe(s.path));
  for (Setting& setting : list) {
    if (setting.name == "path.max-bounces") setting.name = "max-bounces";
  }
  append(list, with_prefix("bdpt", describe(s.bdpt)));
  append(list, with_prefix("vcm", describe(s.vcm)));
  append(list, with_prefix("nee", describe(s.light_selection)));
  append(list, with_prefix("static-lists", describe(s.static_lists)));
  append(list, with_prefix("octree", describe(s.octree)));
  append(list, with_prefix("vlc", describe(s.vlc)));
  append(list, with_prefix("neeat", describe(s.neeat)));
  append(list, with_prefix("cdq", describe(s.cdq)));
  append(list, with_prefix("mcpg", describe(s.mcpg)));
  append(list, with_prefix("mcls", describe(s.mcls)));
  append(list, with_prefix("ris", describe(s.ris)));
  append(list, with_prefix("restir", describe(s.restir)));
  append(list, with_prefix("restir-gi", describe(s.restir_gi)));
  append(list, with_prefix("restir-pt", describe(s.restir_pt)));
  return list;
}

SettingList describe_caches(RenderSettings& s) {
  SettingList list = with_prefix("psf", describe(s.psf));
  append(list, with_prefix("apsf", describe(s.apsf)));
  append(list, with_prefix("apg", describe(s.apg)));
  append(list, with_prefix("sharc", describe(s.sharc)));
  return list;
}

SettingList describe_frames(RenderSettings& s) {
  SettingList list = with_prefix("firefly", describe(s.firefly));
  append(list, with_prefix("adaptive", describe(s.adaptive)));
  append(list, describe(s.upscaling));
  append(list, with_prefix("reproject", describe(s.reproject)));
  return list;
}

SettingList describe_denoisers(RenderSettings& s) {
  SettingList list = with_prefix("features", describe(s.features));
  append(list, with_prefix("bmfr", describe(s.bmfr)));
  append(list, with_prefix("svgf", describe(s.svgf)));
  append(list, with_prefix("asvgf", describe(s.asvgf)));
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
