// Checks that the chosen techniques combine.
#include <string>
#include <utility>

#include <fmt/format.h>

#include "frame/cuda/device_choice.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/sample_parts.h"
#include "techniques/denoise/oidn/oidn_filter.h"

namespace relume {
namespace {

/// Throws if the crop would change pixels: a window only equals the full image if no technique depends on other pixels.
void check_crop(const RenderSettings& s) {
  const std::pair<bool, const char*> conflicts[] = {
      {s.estimator != EstimatorChoice::path, "light paths, which reach any pixel; use --estimator path"},
      {s.lights == LightSelectionChoice::vlc,
       "the visibility light cache, which learns from other pixels; use --lights light-tree"},
      {s.lights == LightSelectionChoice::neeat,
       "light selection by screen tiles, which learns from other pixels; use --lights light-tree"},
      {s.lights == LightSelectionChoice::mcls,
       "Markov chains of lights, which learn from other pixels; use --lights light-tree"},
      {s.guide != GuideChoice::bsdf, "path guiding, which learns from other pixels; use --guide bsdf"},
      {s.cache != CacheChoice::none, "a radiance cache, which other pixels fill; use --cache none"},
      {s.reuse == ReuseChoice::restir_di, "reservoirs of other pixels; use --reuse ris"},
      {resamples_indirect_light(s.reuse) || s.reuse == ReuseChoice::restir_pt,
       "reservoirs of other pixels; use --reuse none"},
      {s.allocation != AllocationChoice::uniform, "adaptive sampling; use --allocation uniform"},
      {upscales(s), "temporal upscaling, which fills pixels from their neighbours; use --upscale 1"},
      {s.history == HistoryChoice::reproject, "reprojection between pixels; use --history accumulate"},
      {s.denoise != DenoiseChoice::none, "a denoiser, which reads other pixels; use --denoise none"},
      {s.firefly.limit > 0, "the firefly clamp, which reads other pixels; use --firefly.limit 0"},
  };
  for (const auto& [conflict, with] : conflicts) {
    if (conflict) throw Error(fmt::format("--crop does not combine with {}, or render the whole image", with));
  }
}

/// Throws if Markov chains do not combine with the other choices. These choices contradict each other: without next
/// event estimation, only directions may find lights with an extent.
void check_chains(const RenderSettings& s) {
  if (!learns_in_chains(s)) return;
  const bool connects = s.estimator == EstimatorChoice::bdpt || s.estimator == EstimatorChoice::vcm;
  if (connects && s.guide == GuideChoice::mcpg && !s.mcpg.nee) {
    throw Error(
        "guide 'mcpg' without mcpg.nee does not combine with estimators 'bdpt' and 'vcm': without next event "
        "estimation, no point on a light with an extent is sampled, and their light subpaths start at such points; "
        "use mcpg.nee on, or estimator 'path'");
  }
  const bool samples_lights = resamples_direct_light(s.reuse) || s.reuse == ReuseChoice::restir_pt;
  if (samples_lights && s.guide == GuideChoice::mcpg && !s.mcpg.nee) {
    throw Error(
        "guide 'mcpg' without mcpg.nee does not combine with reuse 'ris', 'restir-di', 'restir-di+gi' and 'restir-pt': "
        "their samples are points on lights to which pixels connect, and this is next event estimation; use mcpg.nee "
        "on, or reuse 'none'");
  }
}

/// Throws if temporal upscaling does not combine with the other choices.
void check_upscaling(const RenderSettings& s) {
  if (s.allocation == AllocationChoice::adaptive) {
    throw Error(fmt::format(
        "upscale {} does not combine with allocation 'adaptive': both choose which pixels get a sample; use upscale 1 "
        "or allocation 'uniform'",
        s.upscaling.factor));
  }
  if (s.history == HistoryChoice::none) {
    throw Error(fmt::format(
        "upscale {} does not combine with history 'none': pixels without a sample in a frame would be empty; use "
        "upscale 1, or history 'accumulate' or 'reproject'",
        s.upscaling.factor));
  }
}

/// Throws if reservoirs do not combine with light paths.
void check_reuse_with_light_paths(const RenderSettings& s) {
  const bool reuses_indirect = resamples_indirect_light(s.reuse) || s.reuse == ReuseChoice::restir_pt;
  if (s.estimator == EstimatorChoice::light && reuses_indirect) {
    throw Error(
        "reuse 'restir-gi', 'restir-di+gi' and 'restir-pt' do not combine with estimator 'light': its camera paths end "
        "at their first surface, so they find no indirect light that pixels could reuse; use reuse 'ris' or "
        "'restir-di', or estimator 'path'");
  }
  if (s.reuse == ReuseChoice::restir_pt) {
    throw Error(
        "reuse 'restir-pt' does not combine with estimators 'bdpt' and 'vcm': repeating a path with its connections to "
        "light subpaths is not implemented; use reuse 'restir-di+gi', or estimator 'path'");
  }
}

/// Throws if reservoirs do not combine with the other choices.
void check_reuse(const RenderSettings& s) {
  if (s.reuse == ReuseChoice::none) return;
  if (s.estimator != EstimatorChoice::path) check_reuse_with_light_paths(s);
}

/// Throws if a technique describes the scene of other frames or pixels at one time, and so does not combine with an
/// open shutter.
void check_shutter(const RenderSettings& s) {
  if (s.reuse != ReuseChoice::none) {
    throw Error(
        "reuse 'ris', 'restir-di', 'restir-gi', 'restir-di+gi' and 'restir-pt' do not combine with an open shutter: "
        "reservoirs describe lights and surfaces at one time; use reuse 'none' or shutter 0");
  }
  if (needs_first_vertices(s)) {
    throw Error(
        "history 'reproject' by reproject.method 'forward' does not combine with an open shutter: it moves a pixel's "
        "history with the surface of one time; use reproject.method 'backward', history 'accumulate' or shutter 0");
  }
  if (s.denoise == DenoiseChoice::asvgf) {
    throw Error(
        "denoise 'asvgf' does not combine with an open shutter: it traces paths of the last frame again at the place "
        "of one time; use denoise 'svgf' or shutter 0");
  }
}

/// Throws if light tracing does not combine with learned choices of camera paths.
void check_light_tracing(const RenderSettings& s) {
  const bool learns_lights = s.lights == LightSelectionChoice::vlc || s.lights == LightSelectionChoice::neeat ||
                             s.lights == LightSelectionChoice::mcls;
  const bool guides = s.guide == GuideChoice::mcpg || (s.guide == GuideChoice::cdq && !learns_importance(s));
  if (!learns_lights && !guides) return;
  throw Error(
      "lights 'vlc', 'neeat' and 'mcls' and guides 'cdq' and 'mcpg' do not combine with estimator 'light': its camera "
      "paths end at their first surface and choose no lights or directions there; use estimator 'bdpt', guide 'cdq' "
      "with cdq.importance on, or lights 'light-tree' and guide 'bsdf'");
}

/// Throws if light paths do not combine with the cache.
void check_cache_of_light_paths(const RenderSettings& s) {
  if (s.cache == CacheChoice::none) return;
  if (s.estimator == EstimatorChoice::light) {
    throw Error(
        "estimator 'light' does not combine with a radiance cache: it samples no vertex from the camera, and only the "
        "light of such vertices has a cell; use estimator 'bdpt' or cache 'none'");
  }
  if (s.cache == CacheChoice::apg || s.cache == CacheChoice::apsf_apg || s.cache == CacheChoice::sharc) {
    throw Error(
        "estimators 'bdpt' and 'vcm' do not combine with caches 'apg', 'apsf+apg' and 'sharc': beyond the first "
        "vertex, MIS weights depend on all earlier vertices, so a cell's mean is not the light that one path lacks; "
        "use cache 'psf' or 'apsf', or estimator 'path'");
  }
}

}  // namespace

void check_combination(const RenderSettings& settings) {
  cuda::parse_device(settings.device);
  if (settings.cache == CacheChoice::apsf || settings.cache == CacheChoice::apsf_apg) check(settings.apsf);
  if (settings.allocation == AllocationChoice::adaptive) check(settings.adaptive);
  if (settings.allocation == AllocationChoice::adaptive && settings.history == HistoryChoice::none) {
    throw Error(
        "allocation 'adaptive' does not combine with history 'none': pixels without a sample in a frame would be "
        "empty; use history 'accumulate' or 'reproject'");
  }
  if (upscales(settings)) check_upscaling(settings);
  if (settings.denoise == DenoiseChoice::oidn && !oidn_missing().empty()) throw Error(oidn_missing());
  if (!settings.crop.empty()) check_crop(settings);
  if (settings.samples.sums) {
    if (const std::string reason = sums_refusal(settings); !reason.empty()) throw Error(reason);
  }
  if (settings.estimator != EstimatorChoice::path) check_cache_of_light_paths(settings);
  check_reuse(settings);
  check_chains(settings);
  if (settings.shutter().is_open()) check_shutter(settings);
  if (settings.estimator == EstimatorChoice::light) check_light_tracing(settings);
}

std::string refusal(const RenderSettings& settings) {
  try {
    check_combination(settings);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace relume
