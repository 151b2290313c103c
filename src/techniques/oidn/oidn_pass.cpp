#include "techniques/oidn/oidn_pass.h"

#include "techniques/oidn/oidn.h"
#include "techniques/oidn/oidn_filter.h"

namespace relume {

PassDeclaration OidnPass::declaration() const {
  const auto lasting = [](const char* name, const char* help, BufferDisplay display, std::string_view channels = "") {
    return BufferDescription{.name = name,
                             .type = BufferType::rgb32f,
                             .help = help,
                             .persistent = true,
                             .reset = Change::any,
                             .display = display,
                             .channels = channels};
  };
  return {.name = "oidn",
          .stage = Stage::denoise,
          .owns = {lasting("oidn-albedo", "mean albedo that the filter sees", BufferDisplay::value),
                   lasting("oidn-normal", "mean normal that the filter sees", BufferDisplay::value, "XYZ"),
                   lasting("denoised", "the picture, denoised", BufferDisplay::value)},
          .reads = {"mean", "feature-albedo", "feature-emission", "feature-normal"}};
}

bool OidnPass::run(const FrameContext& frame) {
  OidnAuxiliaryKernel kernel;
  kernel.feature_albedo = frame.view<const Rgb>("feature-albedo");
  kernel.feature_emission = frame.view<const Rgb>("feature-emission");
  kernel.feature_normal = frame.view<const Vec3>("feature-normal");
  kernel.albedo = frame.view<Rgb>("oidn-albedo");
  kernel.normal = frame.view<Vec3>("oidn-normal");
  const uint32_t frames = frame.since_change + 1;
  kernel.share = 1.0f / static_cast<float>(frames);
  kernel.width = frame.width();
  launch(frame.backend, "oidn", kernel, frame.width(), frame.height());
  if (!oidn_filters_at(frames)) return true;
  const OidnImages images{frame.view<const Rgb>("mean").data, kernel.albedo.data, kernel.normal.data,
                          frame.view<Rgb>("denoised").data,   frame.width(),      frame.height()};
  frame.backend.run("oidn", [&] { oidn_filter(images, frame.backend.threads()); });
  return true;
}

}  // namespace relume
