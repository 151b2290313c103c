#include "render/sample_parts.h"

#include <utility>

#include "render/build_pipeline.h"
#include "render/estimator_passes.h"

namespace relume {

bool samples_adapt(const RenderSettings& settings) {
  if (learns(settings)) return true;
  // Without a default, so that a new kind of reuse must be listed.
  switch (settings.reuse) {
    case ReuseChoice::none:
    case ReuseChoice::ris: return false;
    case ReuseChoice::restir_di:
    case ReuseChoice::restir_gi:
    case ReuseChoice::restir_di_gi:
    case ReuseChoice::restir_pt: return true;
  }
  return true;
}

std::string sums_refusal(const RenderSettings& s) {
  const std::pair<bool, const char*> conflicts[] = {
      {s.history == HistoryChoice::none, "history 'none' keeps one sample only; use history 'accumulate'"},
      {s.history == HistoryChoice::reproject,
       "history 'reproject' weights samples by their age; use history 'accumulate'"},
      {s.denoise != DenoiseChoice::none,
       "a denoised image is no mean of samples; use denoise 'none', and denoise the merged image with another program"},
      {s.cache != CacheChoice::none,
       "a radiance cache is biased by the number of samples that it has seen; use cache 'none'"},
      {s.allocation != AllocationChoice::uniform,
       "adaptive sampling chooses the number of samples by their values, so parts would have biased weights; use "
       "allocation 'uniform'"},
      {upscales(s), "temporal upscaling leaves pixels without a sample; use upscale 1"},
      {has_caustic_layer(s), "the caustic layer has no exact sums; set bdpt.caustic-layer to false"},
  };
  for (const auto& [conflict, reason] : conflicts) {
    if (conflict) return reason;
  }
  return {};
}

}  // namespace relume
