#include "techniques/features/edge_emission_pass.h"

#include "techniques/features/edge_emission.h"
#include "techniques/features/features_pass.h"
#include "techniques/primary_hits/primary_hits_pass.h"

namespace relume {

PassDeclaration EdgeEmissionPass::declaration() const {
  return {.name = "edges",
          .stage = Stage::resolve,
          .owns = {{.name = "edge-rays",
                    .type = BufferType::u32,
                    .help = "camera rays that the emission at the edge of a lamp or the sky is the mean of",
                    .persistent = true,
                    .reset = Change::any,
                    .display = BufferDisplay::value},
                   surface_buffer("shown-emission", BufferType::rgb32f, "emission that the picture shows", false),
                   {.name = "scattered",
                    .type = BufferType::rgb32f,
                    .help = "radiance of this frame's sample without the emission that it saw"}},
          .reads = {"feature-albedo", "feature-emission"},
          .writes = {"radiance", "rays"},
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
  measure.shown_emission = frame.view<Rgb>("shown-emission");
  measure.edge_rays = frame.view<uint32_t>("edge-rays");
  measure.rays = static_cast<uint32_t>(settings_.edge_rays);
  measure.max_steps = followed_steps(max_bounces_, mirrors_);
  measure.width = frame.width();
  measure.height = frame.height();
  if (!frame.launch("edges", measure)) return false;

  ReplaceEmissionKernel replace;
  replace.emission = measure.emission;
  replace.shown_emission = frame.view<const Rgb>("shown-emission");
  replace.edge_rays = frame.view<const uint32_t>("edge-rays");
  replace.allocation = measure.allocation;
  replace.radiance = frame.view<Rgb>("radiance");
  replace.scattered = frame.view<Rgb>("scattered");
  replace.rays = frame.view<uint32_t>("rays");
  replace.width = frame.width();
  return frame.launch("edges", replace);
}

}  // namespace relume
