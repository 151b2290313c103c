#include "techniques/denoise/shared/split_light_pass.h"
#include "techniques/denoise/shared/denoiser_buffers.h"

#include "techniques/denoise/shared/split_light.h"

namespace relume {

PassDeclaration SplitLightPass::declaration() const {
  return {.name = "split",
          .stage = Stage::resolve,
          .owns = {{.id = kDiffuseScattered, .help = "diffuse part of this frame's scattered light"},
                   {.id = kSpecularScattered,
                    .help = "specular part of this frame's scattered light, where it is separate"}},
          .reads = {kScattered, kRadianceSpecular, kDiffuseAlbedo, kSpecularAlbedo}};
}

bool SplitLightPass::run(const FrameContext& frame) {
  SplitLightKernel kernel;
  kernel.scattered = frame.read(kScattered);
  kernel.specular_found = frame.read(kRadianceSpecular);
  kernel.diffuse_albedo = frame.read(kDiffuseAlbedo);
  kernel.specular_albedo = frame.read(kSpecularAlbedo);
  kernel.diffuse = frame.write(kDiffuseScattered);
  kernel.specular = frame.write(kSpecularScattered);
  kernel.width = frame.width();
  return frame.launch_or_stop("split", kernel);
}

}  // namespace relume
