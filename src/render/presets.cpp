#include "render/presets.h"

#include <string>

#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

/// By purpose.
std::vector<Preset> purpose_presets() {
  return {
      {"preview", "Fast preview: few samples and bounces; too dark where light takes many bounces",
       R"({"spp": 16, "max-bounces": 3, "estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none",
           "reuse": "none", "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
      {"reference", "Reference image: unbiased up to 64 bounces, many samples",
       R"({"spp": 4096, "max-bounces": 64, "path.russian-roulette": true, "estimator": "path", "lights": "power",
           "guide": "bsdf", "cache": "none", "reuse": "none", "allocation": "uniform", "history": "accumulate",
           "firefly.limit": 0, "denoise": "none"})"},
      {"adaptive", "More samples in noisy pixels", R"({"allocation": "adaptive"})"},
      {"reprojection", "Moving views: keeps the history of surfaces that stay visible [Schalk18]",
       R"({"history": "reproject"})"},
      {"combination", "Moving views: reprojection, and more samples in new or noisy pixels [Schalk18]",
       R"({"allocation": "adaptive", "history": "reproject"})"},
      {"interactive", "A moving camera at one sample per pixel: visibility light cache and SVGF",
       R"({"estimator": "path", "lights": "vlc", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "svgf"})"},
      {"caustics", "Caustics and light through glass: bidirectional path tracing",
       R"({"estimator": "bdpt", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
      {"underwater", "Light on surfaces below water or behind glass: vertex connection and merging",
       R"({"estimator": "vcm", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
      {"many-lights", "Hundreds of lights, most of them hidden from any one position: visibility light cache",
       R"({"estimator": "path", "lights": "vlc", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
  };
}

/// Disable relume's additions to the papers, but keep its corrections.
std::vector<Preset> paper_presets() {
  return {
      {"paper-000", "Adaptive path space filtering and adaptive path graphs [Schipek22]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "apsf+apg", "psf.edge-rays": 0,
           "psf.inherited-samples": 0, "psf.undersampled-cells": "coarser", "apg.feed": 1,
           "apg.deep-coarsening": 0, "reuse": "none", "allocation": "uniform", "history": "none", "denoise": "none"})"},
      {"paper-001", "Adaptive sampling with forward reprojection [Schalk18]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "adaptive", "adaptive.method": "paper", "adaptive.min": 4, "adaptive.max": 32,
           "history": "reproject", "reproject.method": "forward", "reproject.fill": false, "denoise": "none"})"},
      {"paper-002", "Visibility light cache and compressed directional quadtrees [Dittebrandt20]",
       R"({"estimator": "path", "lights": "vlc", "vlc.exploration-cells": 1, "vlc.change-measure": "amount",
           "vlc.even-buckets": 1, "vlc.memory": 0, "nee.environment": false, "path.russian-roulette": false, "octree.longest-epoch": 1,
           "guide": "cdq", "cache": "none", "reuse": "none", "allocation": "uniform", "history": "none",
           "denoise": "none"})"},
      {"paper-003", "Path space filtering on a jittered hash grid [Binder19]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "psf", "psf.edge-rays": 0,
           "psf.inherited-samples": 0, "psf.undersampled-cells": "coarser", "reuse": "none",
           "allocation": "uniform", "history": "none", "denoise": "none"})"},
      {"paper-004", "Bidirectional path tracing, denoised by blockwise regression [Sun20]",
       R"({"estimator": "bdpt", "bdpt.connection-roulette": 0, "lights": "power", "guide": "bsdf", "cache": "none",
           "reuse": "none", "allocation": "uniform", "history": "accumulate", "denoise": "bmfr",
           "features.edge-rays": 0, "bmfr.alpha": 0.2, "bmfr.detail": 0})"},
  };
}

/// Presets with the parameters of other programs.
std::vector<Preset> program_presets() {
  return {
      {"restir-research", "ReSTIR DI, unbiased, with the parameters of the research code [Bitterli20, Lin22]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "restir-di",
           "ris.candidates": 32, "restir.correction": "exact", "restir.feedback": "spatial", "restir.cap": 20,
           "restir.neighbours": 5, "restir.radius": 30, "allocation": "uniform", "history": "none",
           "denoise": "none"})"},
      {"restir-rtxdi", "ReSTIR DI with the default parameters of RTXDI, without its filters: darker in shadows",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "restir-di",
           "ris.candidates": 8, "restir.correction": "basic", "restir.feedback": "spatial", "restir.cap": 20,
           "restir.neighbours": 1, "restir.radius": 32, "allocation": "uniform", "history": "none",
           "denoise": "none"})"},
      {"restir-gi-rtxdi", "ReSTIR GI with the default parameters of RTXDI, without its filters: darker near edges",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "restir-gi",
           "restir-gi.correction": "basic", "restir-gi.feedback": "spatial", "restir-gi.cap": 8,
           "restir-gi.neighbours": 2, "restir-gi.radius": 32, "restir-gi.reuse-glossy": true,
           "restir-gi.jacobian": 10, "restir-gi.validate": 0, "allocation": "uniform", "history": "none",
           "denoise": "none"})"},
      {"restir-pt-2022", "ReSTIR PT, unbiased, with the parameters of the research code [Lin22]",
       R"({"estimator": "path", "path.russian-roulette": false, "max-bounces": 9, "lights": "power", "guide": "bsdf",
           "cache": "none", "reuse": "restir-pt", "restir-pt.shift": "hybrid", "restir-pt.connect": "distance-2022",
           "restir-pt.roughness": 0.2, "restir-pt.distance": 0.1, "restir-pt.correction": "exact",
           "restir-pt.feedback": "spatial", "restir-pt.cap": 20, "restir-pt.neighbours": 3, "restir-pt.radius": 20,
           "restir-pt.reciprocal": false, "restir-pt.duplication": 0, "allocation": "uniform", "history": "none",
           "denoise": "none"})"},
      {"restir-pt-2026",
       "ReSTIR PT, unbiased, with the connectible footprints and reciprocal pairs of its enhanced form [Lin26]",
       R"({"estimator": "path", "path.russian-roulette": true, "lights": "power", "guide": "bsdf", "cache": "none",
           "reuse": "restir-pt", "restir-pt.shift": "hybrid", "restir-pt.connect": "footprint",
           "restir-pt.footprint": 0.0002, "restir-pt.correction": "exact", "restir-pt.feedback": "spatial",
           "restir-pt.cap": 20, "restir-pt.neighbours": 3, "restir-pt.radius": 16, "restir-pt.reciprocal": true,
           "restir-pt.duplication": 0, "allocation": "uniform", "history": "none", "denoise": "none"})"},
      {"asvgf-2018", "A-SVGF with the parameters of the paper and of its published port [Schied18, Schied17]",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "asvgf", "asvgf.alpha": 0.1,
           "asvgf.antilag": 1, "asvgf.view-changes": true, "asvgf.gradient-levels": 5, "asvgf.levels": 5,
           "asvgf.light-tolerance": 4, "asvgf.newest": 1, "features.edge-rays": 0, "features.split": false})"},
      {"asvgf-q2rtx", "A-SVGF with the parameters of Q2RTX that relume has, and separate specular light",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "none", "reuse": "none",
           "allocation": "uniform", "history": "accumulate", "denoise": "asvgf", "asvgf.alpha": 0.02,
           "asvgf.antilag": 1, "asvgf.view-changes": true, "asvgf.gradient-levels": 5, "asvgf.levels": 4,
           "asvgf.light-tolerance": 2, "asvgf.newest": 1, "features.edge-rays": 0, "features.split": true})"},
      {"sharc-1.6", "Spatially hashed radiance cache with the default parameters of SHaRC 1.6, and its firefly clamp",
       R"({"estimator": "path", "lights": "power", "guide": "bsdf", "cache": "sharc", "sharc.update": "sparse",
           "sharc.end": "footprint", "sharc.feedback": true, "sharc.propagation-depth": 4, "sharc.jitter": false,
           "sharc.normal-bins": 1, "sharc.min-samples": 1, "sharc.clamp": 10, "reuse": "none",
           "allocation": "uniform", "history": "none", "denoise": "none"})"},
      {"mcpg-quake", "Markov chain path guiding with the parameters of its authors' renderer [Alber25]",
       R"({"estimator": "path", "lights": "power", "guide": "mcpg", "mcpg.nee": false, "mcpg.bsdf-fraction": 0.1,
           "mcpg.prior": 0.3, "mcpg.cells": 5, "mcpg.adaptive-share": 0.7, "mcpg.least-alpha": 0.01,
           "mcpg.most-count": 1024, "mcpg.recovery": true, "mcpg.slots": 8, "mcpg.static-slots": 800009,
           "mcpg.static-cells": 128, "mcpg.vertices": 2, "cache": "none", "reuse": "none", "allocation": "uniform",
           "history": "none", "denoise": "none"})"},
  };
}

}  // namespace

const std::vector<Preset>& presets() {
  static const std::vector<Preset> list = [] {
    std::vector<Preset> all = purpose_presets();
    for (const auto& more : {paper_presets(), program_presets()}) all.insert(all.end(), more.begin(), more.end());
    return all;
  }();
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
