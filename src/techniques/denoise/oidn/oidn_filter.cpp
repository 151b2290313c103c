#include "techniques/denoise/oidn/oidn_filter.h"

#include "relume/error.h"

#if defined(RELUME_WITH_OIDN)
#include <OpenImageDenoise/oidn.hpp>
#endif

namespace relume {

#if defined(RELUME_WITH_OIDN)

namespace {

void check_errors(oidn::DeviceRef& device) {
  const char* message = nullptr;
  if (device.getError(message) == oidn::Error::None) return;
  throw Error(std::string("Open Image Denoise failed: ") + (message ? message : "unknown reason") +
              "; use denoise bmfr or svgf instead");
}

}  // namespace

std::string oidn_missing() { return {}; }

void oidn_filter(const OidnImages& images, int threads) {
  oidn::DeviceRef device = oidn::newDevice(oidn::DeviceType::CPU);
  device.set("numThreads", threads);
  device.set("setAffinity", false);
  device.commit();
  oidn::FilterRef filter = device.newFilter("RT");
  const auto set = [&](const char* name, const void* data) {
    if (!data) return;
    filter.setImage(name, const_cast<void*>(data), oidn::Format::Float3, images.width, images.height);
  };
  set("color", images.color);
  set("albedo", images.albedo);
  set("normal", images.normal);
  set("output", images.output);
  filter.set("hdr", true);
  filter.commit();
  filter.execute();
  check_errors(device);
}

#else

std::string oidn_missing() {
  return "denoise 'oidn' needs Intel's Open Image Denoise, which was not found when relume was built (Debian 12 has no "
         "package of it): get it from https://www.openimagedenoise.org, build again with -DCMAKE_PREFIX_PATH naming "
         "its "
         "folder, or use denoise 'bmfr' or 'svgf'";
}

void oidn_filter(const OidnImages&, int) { throw Error(oidn_missing()); }

#endif

}  // namespace relume
