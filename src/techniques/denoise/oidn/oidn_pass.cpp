#include "techniques/denoise/oidn/oidn_pass.h"

#include "techniques/denoise/oidn/oidn.h"
#include "techniques/denoise/oidn/oidn_filter.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kOidnAlbedo{"oidn-albedo"};
constexpr BufferKey<Vec3> kOidnNormal{"oidn-normal"};

}  // namespace

PassDeclaration OidnPass::declaration() const {
  const auto lasting = [](const BufferId& id, const char* help, BufferDisplay display, std::string_view channels = "") {
    return BufferDescription{
        .id = id, .help = help, .persistent = true, .reset = Change::any, .display = display, .channels = channels};
  };
  return {.name = "oidn",
          .stage = Stage::denoise,
          .owns = {lasting(kOidnAlbedo, "mean albedo, as input of the denoiser", BufferDisplay::value),
                   lasting(kOidnNormal, "mean normal, as input of the denoiser", BufferDisplay::value, "XYZ"),
                   lasting(kDenoised, "the denoised image", BufferDisplay::value)},
          .reads = {kMean, kFeatureAlbedo, kFeatureEmission, kFeature.normal},
          .reads_if_any = {kFilled}};
}

bool OidnPass::run(const FrameContext& frame) {
  OidnAuxiliaryKernel kernel;
  kernel.feature_albedo = frame.read(kFeatureAlbedo);
  kernel.feature_emission = frame.read(kFeatureEmission);
  kernel.feature_normal = frame.read(kFeature.normal);
  kernel.albedo = frame.write(kOidnAlbedo);
  kernel.normal = frame.write(kOidnNormal);
  const uint32_t frames = frame.since_change + 1;
  kernel.share = 1.0f / static_cast<float>(frames);
  kernel.width = frame.width();
  frame.launch("oidn", kernel);
  if (!oidn_filters_at(frames)) return true;
  const View<const Rgb> filled = frame.read(kFilled);
  const View<const Rgb> noisy = filled.empty() ? frame.read(kMean) : filled;
  const OidnImages images{noisy.data,    kernel.albedo.data, kernel.normal.data, frame.write(kDenoised).data,
                          frame.width(), frame.height()};
  frame.backend.run_library("oidn", [&] { oidn_filter(images, frame.backend.threads()); });
  return true;
}

}  // namespace relume
