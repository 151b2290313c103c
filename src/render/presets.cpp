#include "render/presets.h"

#include <string>

#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume {

const std::vector<Preset>& presets() {
  static const std::vector<Preset> list = {
      {"preview", "A first look: few samples, few bounces (too dark where light takes many)",
       R"({"spp": 16, "max-bounces": 3, "estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
      {"reference", "What other images are measured against: unbiased up to 64 bounces, many samples",
       R"({"spp": 4096, "max-bounces": 64, "path.russian-roulette": true, "estimator": "path", "lights": "power",
           "guide": "bsdf", "cache": "none", "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
      {"adaptive", "More samples where the noise is", R"({"allocation": "adaptive"})"},
      {"reprojection", "Frames in motion: keeps what can be verified to be seen still [Schalk18]",
       R"({"history": "reproject"})"},
      {"combination", "Both: keeps what it can, and samples what is new or noisy [Schalk18]",
       R"({"allocation": "adaptive", "history": "reproject"})"},
      {"interactive", "A moving camera at one sample a pixel: lights that were visible nearby, and a denoiser",
       R"({"estimator": "path", "lights": "vlc", "guide": "bsdf", "cache": "none", "allocation": "uniform",
           "history": "accumulate", "denoise": "svgf"})"},
      {"caustics", "Light through glass and off mirrors: paths from both ends",
       R"({"estimator": "bdpt", "lights": "power", "guide": "bsdf", "cache": "none", "allocation": "uniform",
           "history": "accumulate", "denoise": "none"})"},
      {"many-lights", "Hundreds of lamps of which few are seen from anywhere",
       R"({"estimator": "path", "lights": "vlc", "guide": "bsdf", "cache": "none", "allocation": "uniform",
           "history": "accumulate", "denoise": "none"})"},
      // Paper presets disable relume's additions to the papers, but keep its corrections.
      {"paper-000", "Adaptive path space filtering and adaptive path graphs [Schipek22]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "apsf+apg", "psf.edge-rays": 0,
           "psf.inherited-samples": 0, "apg.feed": 1, "apg.deep-coarsening": 0, "allocation": "uniform",
           "history": "none", "denoise": "none"})"},
      {"paper-001", "Adaptive sampling of what forward reprojection leaves open [Schalk18]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "allocation": "adaptive",
           "adaptive.method": "paper", "adaptive.min": 4, "adaptive.max": 32, "history": "reproject", "reproject.method": "forward",
           "reproject.fill": false, "denoise": "none"})"},
      {"paper-002", "Visibility light cache and compressed directional quadtrees [Dittebrandt20]",
       R"({"estimator": "path", "lights": "vlc", "vlc.exploration-cells": 1, "vlc.even-buckets": 1, "vlc.memory": 0,
           "nee.environment": false, "octree.longest-epoch": 1, "guide": "cdq", "cache": "none", "allocation": "uniform", "history": "none",
           "denoise": "none"})"},
      {"paper-003", "Path space filtering on a jittered hash grid [Binder19]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "psf", "psf.edge-rays": 0,
           "psf.inherited-samples": 0, "allocation": "uniform", "history": "none", "denoise": "none"})"},
      {"paper-004", "Bidirectional path tracing, denoised by blockwise regression [Sun20]",
       R"({"estimator": "bdpt", "bdpt.connection-roulette": 0, "lights": "power", "guide": "bsdf", "cache": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "bmfr", "features.edge-rays": 0,
           "bmfr.alpha": 0.2, "bmfr.detail": 0})"},
  };
  return list;
}

const Preset& require_preset(std::string_view name) {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) {
    if (preset.name == name) return preset;
    names.emplace_back(preset.name);
  }
  throw Error(ErrorCode::not_found, "there is no preset '" + std::string(name) + "'" + suggestion(name, names));
}

}  // namespace relume
