#include "techniques/temporal/upscaling/upscaling_pass.h"

#include "techniques/temporal/upscaling/upscaling.h"

namespace relume {

PassDeclaration BlockAllocationPass::declaration() const {
  return {.name = "allocate",
          .stage = Stage::allocate,
          .owns = {{.id = kAllocation, .help = "number of samples in this frame", .display = BufferDisplay::value}}};
}

bool BlockAllocationPass::run(const FrameContext& frame) {
  const auto block = static_cast<uint32_t>(settings_.factor);
  const BlockAllocationKernel kernel{frame.write(kAllocation), block_position(block, frame.number), block,
                                     frame.width()};
  frame.launch("allocate", kernel);
  return true;
}

PassDeclaration FillUnsampledPass::declaration() const {
  return {.name = "fill",
          .stage = Stage::present,
          .owns = {{.id = kFilled,
                    .help = "mean, with pixels without samples filled from those around them",
                    .persistent = true,
                    .display = BufferDisplay::value}},
          .reads = {kMean, kSamples, kSurfaceAlbedo, kSurface.normal, kSurface.surface}};
}

bool FillUnsampledPass::run(const FrameContext& frame) {
  const FillUnsampledKernel kernel{.mean = frame.read(kMean),
                                   .samples = frame.read(kSamples),
                                   .albedo = frame.read(kSurfaceAlbedo),
                                   .normal = frame.read(kSurface.normal),
                                   .surface = frame.read(kSurface.surface),
                                   .filled = frame.write(kFilled),
                                   .block = static_cast<uint32_t>(settings_.factor),
                                   .width = frame.width(),
                                   .height = frame.height()};
  frame.launch("fill", kernel);
  return true;
}

}  // namespace relume
