#include "techniques/features/edge_emission_pass.h"

#include "techniques/features/edge_emission.h"
#include "techniques/features/features_pass.h"

namespace relume {

PassDeclaration EdgeEmissionPass::declaration() const {
  return {.name = "edges",
          .stage = Stage::resolve,
          .owns = {{.name = "edge-rays",
                    .type = BufferType::u32,
                    .help = "camera rays that the emission at the edge of a lamp or the sky is the mean of",
                    .display = BufferDisplay::value},
                   {.name = "edge-emission", .type = BufferType::rgb32f, .help = "that mean"}},
          .reads = {"feature-albedo"},
          .writes = {"radiance", "rays", "feature-emission"},
          .reads_if_any = {"allocation"}};
}

bool EdgeEmissionPass::run(const FrameContext& frame) {
  MeasureEdgesKernel measure;
  measure.scene = frame.scene;
  measure.index = frame.index;
  measure.radiance = frame.view<const Rgb>("radiance");
  measure.allocation = frame.view<const uint32_t>("allocation");
  measure.albedo = frame.view<const Rgb>("feature-albedo");
  measure.emission = frame.view<const Rgb>("feature-emission");
  measure.edge_emission = frame.view<Rgb>("edge-emission");
  measure.edge_rays = frame.view<uint32_t>("edge-rays");
  measure.rays = static_cast<uint32_t>(settings_.edge_rays);
  measure.max_steps = followed_steps(max_bounces_, mirrors_);
  measure.width = frame.width();
  measure.height = frame.height();
  if (!frame.launch("edges", measure)) return false;

  ReplaceEmissionKernel replace;
  replace.edge_emission = frame.view<const Rgb>("edge-emission");
  replace.edge_rays = frame.view<const uint32_t>("edge-rays");
  replace.allocation = measure.allocation;
  replace.radiance = frame.view<Rgb>("radiance");
  replace.emission = frame.view<Rgb>("feature-emission");
  replace.rays = frame.view<uint32_t>("rays");
  replace.width = frame.width();
  return frame.launch("edges", replace);
}

}  // namespace relume
