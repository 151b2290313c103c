#include "techniques/denoise/firefly_clamp/firefly_clamp_pass.h"

#include "techniques/denoise/firefly_clamp/firefly_clamp.h"

namespace relume {
namespace {

constexpr BufferKey<float> kFireflyFactor{"firefly-factor"};

}  // namespace

PassDeclaration FireflyClampPass::declaration() const {
  return {.name = "firefly-clamp",
          .stage = Stage::resolve,
          .owns = {{.id = kFireflyFactor,
                    .help = "factor by which the firefly clamp scaled this frame's sample",
                    .display = BufferDisplay::value}},
          .reads = {kPrimaryHits},
          .writes = {kRadiance},
          .reads_if_any = {kAllocation},
          .writes_if_any = {kRadianceSpecular, kLightRadiance, kCausticRadiance, kCausticDifference, kRadianceCells},
          .only_sampled_pixels = true};
}

bool FireflyClampPass::run(const FrameContext& frame) {
  FireflyFactorKernel factor;
  factor.scene = frame.scene;
  factor.hits = frame.read(kPrimaryHits);
  factor.radiance = frame.read(kRadiance);
  factor.allocation = frame.read(kAllocation);
  factor.factors = frame.write(kFireflyFactor);
  factor.limit = settings_.limit;
  factor.width = frame.width();
  factor.height = frame.height();
  if (!frame.launch_or_stop("firefly-clamp", factor)) return false;
  for (const BufferKey<Rgb>& key :
       {kRadiance, kRadianceSpecular, kLightRadiance, kCausticRadiance, kCausticDifference, kRadianceCells}) {
    const View<Rgb> values = frame.write(key);
    if (values.empty()) continue;
    const FireflyScaleKernel scale{frame.read(kFireflyFactor), values, frame.width()};
    if (!frame.launch_or_stop("firefly-clamp", scale)) return false;
  }
  return true;
}

}  // namespace relume
