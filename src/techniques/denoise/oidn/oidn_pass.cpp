#include "techniques/denoise/oidn/oidn_pass.h"

#include "techniques/denoise/oidn/oidn.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kOidnAlbedo{"oidn-albedo"};
constexpr BufferKey<Vec3> kOidnNormal{"oidn-normal"};
constexpr BufferKey<Rgb> kOidnRest{"oidn-rest"};
constexpr BufferKey<Rgb> kOidnLayer{"oidn-layer"};
constexpr BufferKey<Rgb> kOidnFilteredLayer{"oidn-filtered-layer"};

}  // namespace

PassDeclaration OidnPass::declaration() const {
  const auto lasting = [](const BufferId& id, const char* help, BufferDisplay display, std::string_view channels = "") {
    return BufferDescription{
        .id = id, .help = help, .persistent = true, .reset = Change::any, .display = display, .channels = channels};
  };
  PassDeclaration declaration{
      .name = "oidn",
      .stage = Stage::denoise,
      .owns = {lasting(kOidnAlbedo, "mean albedo, as input of the denoiser", BufferDisplay::value),
               lasting(kOidnNormal, "mean normal, as input of the denoiser", BufferDisplay::value, "XYZ"),
               lasting(kDenoised, "the denoised image", BufferDisplay::value)},
      .reads = {kMean, kFeatureAlbedo, kFeatureEmission, kFeature.normal},
      .reads_if_any = {kFilled}};
  if (caustic_layer_) {
    declaration.reads.push_back(kCausticMoments.mean);
    declaration.owns.push_back({.id = kOidnLayer, .help = "caustic layer, as input of the denoiser"});
    declaration.owns.push_back({.id = kOidnRest, .help = "image without the caustic layer, as input of the denoiser"});
    declaration.owns.push_back({.id = kOidnFilteredLayer, .help = "the denoised caustic layer"});
  }
  return declaration;
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
  if (caustic_layer_) {
    filter_parts(frame, noisy, images);
  } else {
    frame.backend.run_library("oidn", [&] { oidn_filter(images, frame.backend.threads()); });
  }
  return true;
}

void OidnPass::filter_parts(const FrameContext& frame, const View<const Rgb>& noisy, const OidnImages& features) const {
  const View<Rgb> layer = frame.write(kOidnLayer);
  const View<Rgb> rest = frame.write(kOidnRest);
  const View<Rgb> filtered = frame.write(kOidnFilteredLayer);
  const OidnSplitKernel split{noisy, frame.read(kCausticMoments.mean), layer, rest, frame.width()};
  frame.launch("oidn", split);
  OidnImages images = features;
  images.color = rest.data;
  // Features of the surface do not explain caustics, so their filter gets none.
  const OidnImages caustics{layer.data, nullptr, nullptr, filtered.data, frame.width(), frame.height()};
  frame.backend.run_library("oidn", [&] {
    oidn_filter(images, frame.backend.threads());
    oidn_filter(caustics, frame.backend.threads());
  });
  const OidnSumKernel sum{frame.read(kOidnFilteredLayer), frame.write(kDenoised), frame.width()};
  frame.launch("oidn", sum);
}

}  // namespace relume
