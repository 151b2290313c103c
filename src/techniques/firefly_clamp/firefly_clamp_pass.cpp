#include "techniques/firefly_clamp/firefly_clamp_pass.h"

#include "techniques/firefly_clamp/firefly_clamp.h"

namespace relume {

PassDeclaration FireflyClampPass::declaration() const {
  return {.name = "firefly-clamp",
          .stage = Stage::resolve,
          .owns = {{.name = "firefly-factor",
                    .type = BufferType::f32,
                    .help = "factor by which the firefly clamp scaled this frame's sample",
                    .display = BufferDisplay::value}},
          .reads = {"primary-hits"},
          .writes = {"radiance"},
          .reads_if_any = {"allocation"},
          .writes_if_any = {"radiance-specular", "light-radiance"}};
}

bool FireflyClampPass::run(const FrameContext& frame) {
  FireflyFactorKernel factor;
  factor.scene = frame.scene;
  factor.hits = frame.view<const Hit>("primary-hits");
  factor.radiance = frame.view<const Rgb>("radiance");
  factor.allocation = frame.view<const uint32_t>("allocation");
  factor.factors = frame.view<float>("firefly-factor");
  factor.limit = settings_.limit;
  factor.width = frame.width();
  factor.height = frame.height();
  if (!frame.launch("firefly-clamp", factor)) return false;
  for (const char* name : {"radiance", "radiance-specular", "light-radiance"}) {
    const View<Rgb> values = frame.view<Rgb>(name);
    if (values.empty()) continue;
    const FireflyScaleKernel scale{frame.view<const float>("firefly-factor"), values, frame.width()};
    if (!frame.launch("firefly-clamp", scale)) return false;
  }
  return true;
}

}  // namespace relume
