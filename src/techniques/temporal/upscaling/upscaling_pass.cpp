#include "techniques/temporal/upscaling/upscaling_pass.h"

#include <algorithm>

#include "techniques/temporal/upscaling/upscaling.h"

namespace relume {
namespace {

/// Edge of a block, within the image.
uint32_t block_of(const UpscalingSettings& settings, const FrameContext& frame) {
  return std::min({static_cast<uint32_t>(settings.factor), frame.width(), frame.height()});
}

}  // namespace

PassDeclaration BlockAllocationPass::declaration() const {
  return {.name = "allocate",
          .stage = Stage::allocate,
          .owns = {{.id = kAllocation, .help = "number of samples in this frame", .display = BufferDisplay::value}}};
}

bool BlockAllocationPass::run(const FrameContext& frame) {
  const uint32_t block = block_of(settings_, frame);
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
          .reads = {kMean, kSamples}};
}

bool FillUnsampledPass::run(const FrameContext& frame) {
  const FillUnsampledKernel kernel{.mean = frame.read(kMean),
                                   .samples = frame.read(kSamples),
                                   .filled = frame.write(kFilled),
                                   .block = block_of(settings_, frame),
                                   .width = frame.width(),
                                   .height = frame.height()};
  frame.launch("fill", kernel);
  return true;
}

}  // namespace relume
