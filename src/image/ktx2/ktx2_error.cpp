#include "image/ktx2/ktx2_error.h"

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::detail {

void fail_damaged_ktx2(const std::string& name, const std::string& problem) {
  throw Error(fmt::format("{}: damaged image ({}); export or copy it again", name, problem));
}

void fail_cut_off_ktx2(const std::string& name) {
  throw Error(fmt::format("{}: the image is cut off; export or copy it again", name));
}

void fail_unsupported_ktx2(const std::string& name, const std::string& feature) {
  throw Error(
      fmt::format("{}: KTX2 images with {} are not supported; convert it to a 2D texture in UASTC, ETC1S or 8-bit RGBA",
                  name, feature));
}

}  // namespace relume::detail
