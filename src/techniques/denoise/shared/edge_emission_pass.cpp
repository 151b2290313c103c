#include "techniques/denoise/shared/edge_emission_pass.h"

#include "techniques/denoise/shared/denoiser_buffers.h"
#include "techniques/denoise/shared/edge_emission.h"
#include "techniques/gbuffer/features/features_pass.h"
#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"

namespace relume {

PassDeclaration EdgeEmissionPass::declaration() const {
  return {.name = "edges",
          .stage = Stage::resolve,
          .owns = {{.id = kEdgeRays,
                    .help = "number of camera rays averaged for the emission at the edge of a lamp or the sky",
                    .persistent = true,
                    .reset = Change::any,
                    .display = BufferDisplay::value},
                   surface_buffer(kShownEmission, "emission shown in the image", false),
                   {.id = kScattered, .help = "radiance of this frame's sample without directly visible emission"}},
          .reads = {kFeatureAlbedo, kFeatureEmission},
          .writes = {kRadiance, kRays},
          .reads_if_any = {kAllocation, kCausticRadiance}};
}

bool EdgeEmissionPass::run(const FrameContext& frame) {
  MeasureEdgesKernel measure;
  measure.scene = frame.scene;
  measure.index = frame.index;
  measure.radiance = frame.read(kRadiance);
  measure.allocation = frame.read(kAllocation);
  measure.albedo = frame.read(kFeatureAlbedo);
  measure.emission = frame.read(kFeatureEmission);
  measure.shown_emission = frame.write(kShownEmission);
  measure.edge_rays = frame.write(kEdgeRays);
  measure.rays = static_cast<uint32_t>(settings_.edge_rays);
  measure.max_steps = followed_steps(max_bounces_, mirrors_);
  measure.width = frame.width();
  measure.height = frame.height();
  if (!frame.launch_or_stop("edges", measure)) return false;

  ReplaceEmissionKernel replace;
  replace.emission = measure.emission;
  replace.shown_emission = frame.read(kShownEmission);
  replace.edge_rays = frame.read(kEdgeRays);
  replace.allocation = measure.allocation;
  replace.radiance = frame.write(kRadiance);
  replace.scattered = frame.write(kScattered);
  replace.rays = frame.write(kRays);
  replace.width = frame.width();
  replace.caustics = frame.read(kCausticRadiance);
  return frame.launch_or_stop("edges", replace);
}

}  // namespace relume
