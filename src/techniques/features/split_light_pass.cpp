#include "techniques/features/split_light_pass.h"

#include "techniques/features/split_light.h"

namespace relume {

PassDeclaration SplitLightPass::declaration() const {
  return {.name = "split",
          .stage = Stage::resolve,
          .owns = {{.name = "diffuse-scattered",
                    .type = BufferType::rgb32f,
                    .help = "the part of this frame's sample that the surface scattered diffusely"},
                   {.name = "specular-scattered",
                    .type = BufferType::rgb32f,
                    .help = "the part that specular lobes scattered, where it is kept apart"}},
          .reads = {"scattered", "radiance-specular", "diffuse-albedo", "specular-albedo"}};
}

bool SplitLightPass::run(const FrameContext& frame) {
  SplitLightKernel kernel;
  kernel.scattered = frame.view<const Rgb>("scattered");
  kernel.specular_found = frame.view<const Rgb>("radiance-specular");
  kernel.diffuse_albedo = frame.view<const Rgb>("diffuse-albedo");
  kernel.specular_albedo = frame.view<const Rgb>("specular-albedo");
  kernel.diffuse = frame.view<Rgb>("diffuse-scattered");
  kernel.specular = frame.view<Rgb>("specular-scattered");
  kernel.width = frame.width();
  return frame.launch("split", kernel);
}

}  // namespace relume
