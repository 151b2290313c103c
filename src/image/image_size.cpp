#include "image/image_size.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <stb_image.h>

#include "image/bmp.h"
#include "image/exr_header.h"
#include "image/ktx2/ktx2_header.h"
#include "image/rgbe.h"
#include "image/stb_decode.h"
#include "image/webp.h"
#include "relume/error.h"

namespace relume::detail {
namespace {

/// Size of PNG, JPEG and TGA images.
ImageSize stb_size(std::span<const std::byte> bytes, const std::string& name) {
  const int size = static_cast<int>(std::min<size_t>(bytes.size(), std::numeric_limits<int>::max()));
  int width = 0;
  int height = 0;
  int components = 0;
  if (stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), size, &width, &height, &components) == 0)
    throw Error(fmt::format("{}: damaged image (its header is not valid); export or copy it again", name));
  return {width, height};
}

}  // namespace

ImageSize read_image_size(std::span<const std::byte> bytes, const std::string& name) {
  switch (detect_image_format(bytes, name)) {
    case ImageFormat::exr: return exr_size(bytes, name);
    case ImageFormat::hdr: return rgbe_size(bytes, name);
    case ImageFormat::bmp: return bmp_size(bytes, name);
    case ImageFormat::webp: return webp_size(bytes, name);
    case ImageFormat::ktx2: {
      const Ktx2Header header = read_ktx2_header(bytes, name);
      return {header.width, header.height};
    }
    case ImageFormat::png:
    case ImageFormat::jpeg:
    case ImageFormat::tga: break;
  }
  return stb_size(bytes, name);
}

}  // namespace relume::detail
