#include "image/stb_decode.h"

#include <limits>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <stb_image.h>

#include "image/bmp.h"
#include "image/image_complete.h"
#include "image/image_limits.h"
#include "image/ktx2/ktx2.h"
#include "image/webp.h"
#include "relume/error.h"

namespace relume::detail {
namespace {

/// Heuristic, because TGA has no magic number: colour map type, image type and pixel depth must be valid.
bool looks_like_tga(std::span<const std::byte> bytes) {
  if (bytes.size() < 18) return false;
  const auto at = [&](size_t i) { return std::to_integer<int>(bytes[i]); };
  const int type = at(2) & ~8;  // bit 3: run-length encoded
  const int depth = at(16);
  return at(1) <= 1 && type >= 1 && type <= 3 &&
         (depth == 8 || depth == 15 || depth == 16 || depth == 24 || depth == 32);
}

/// Upper bound on decoded pixels per file byte, over all encoders of the format.
int64_t max_pixels_per_byte(ImageFormat format) {
  switch (format) {
    case ImageFormat::png: return 16384;  // deflate shrinks by at most 1032; 8 pixels per byte
    case ImageFormat::jpeg: return 1024;  // one bit per block of 64, chroma subsampled by 4
    default: return 128;                  // run lengths of at most 128
  }
}

struct StbFree {
  void operator()(void* pixels) const { stbi_image_free(pixels); }
};
template <typename T>
using StbPixels = std::unique_ptr<T, StbFree>;

template <typename T>
std::vector<T> copy_rgba(const StbPixels<T>& pixels, int width, int height) {
  return {pixels.get(), pixels.get() + size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height)};
}

[[noreturn]] void fail(const std::string& name) {
  const char* reason = stbi_failure_reason();
  throw Error(fmt::format("{}: damaged image ({}); export or copy it again", name,
                          reason != nullptr ? reason : "unknown reason"));
}

void check_complete(std::span<const std::byte> bytes, ImageFormat format, uint64_t pixel_count,
                    const std::string& name) {
  if (!is_complete(bytes, format, pixel_count))
    throw Error(fmt::format("{}: the image is cut off; export or copy it again", name));
}

DecodedPixels decode_ktx2_pixels(std::span<const std::byte> bytes, const std::string& name) {
  Ktx2Image image = decode_ktx2(bytes, name);
  return {image.width, image.height, std::move(image.rgba8), {}, !image.is_srgb};
}

}  // namespace

ImageFormat detect_image_format(std::span<const std::byte> bytes, const std::string& name) {
  if (starts_with(bytes, "\x76\x2f\x31\x01")) return ImageFormat::exr;
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n")) return ImageFormat::png;
  if (starts_with(bytes, "\xff\xd8\xff")) return ImageFormat::jpeg;
  if (starts_with(bytes, "#?RADIANCE") || starts_with(bytes, "#?RGBE")) return ImageFormat::hdr;
  const bool is_bitmap_array = starts_with(bytes, "BA") && starts_with(bytes, "BM", 14);
  if (starts_with(bytes, "BM") || is_bitmap_array) return ImageFormat::bmp;
  if (is_ktx2(bytes)) return ImageFormat::ktx2;
  if (is_webp(bytes)) return ImageFormat::webp;
  struct Known {
    std::string_view magic;
    size_t offset;
    std::string_view format;
  };
  constexpr Known kUnsupported[] = {{"GIF8", 0, "GIF"},
                                    {"8BPS", 0, "Photoshop"},
                                    {"\xabKTX 11", 0, "KTX1"},
                                    {"DDS ", 0, "DDS"},
                                    {"II*", 0, "TIFF"},
                                    {"MM", 0, "TIFF"},
                                    {"P5", 0, "PNM"},
                                    {"P6", 0, "PNM"},
                                    {"PF", 0, "PFM"},
                                    {"<svg", 0, "SVG"},
                                    {"\x53\x80\xf6\x34", 0, "PIC"}};
  for (const Known& known : kUnsupported) {
    if (starts_with(bytes, known.magic, known.offset))
      throw Error(
          fmt::format("{}: {} images are not supported; convert it to PNG, JPEG, TGA, HDR or EXR", name, known.format));
  }
  if (looks_like_tga(bytes)) return ImageFormat::tga;
  if (bytes.empty()) throw Error(fmt::format("{}: the image is empty; export or copy it again", name));
  throw Error(fmt::format("{}: not a recognised image; convert it to PNG, JPEG, TGA, HDR or EXR", name));
}

DecodedPixels decode_pixels(std::span<const std::byte> bytes, ImageFormat format, const std::string& name) {
  if (format == ImageFormat::bmp) return decode_bmp(bytes, name);
  if (format == ImageFormat::ktx2) return decode_ktx2_pixels(bytes, name);
  if (format == ImageFormat::webp) return decode_webp(bytes, name);
  if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
    throw Error(fmt::format("{}: image files above 2 GiB are not supported; convert it to EXR", name));
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  DecodedPixels result;
  int components = 0;
  if (stbi_info_from_memory(data, size, &result.width, &result.height, &components) == 0) fail(name);
  const bool is_16_bit = format == ImageFormat::png && stbi_is_16_bit_from_memory(data, size) != 0;
  const int64_t pixel_bytes = is_16_bit ? 8 : 4;
  check_image_size(name, result.width, result.height, pixel_bytes, bytes.size(),
                   pixel_bytes * max_pixels_per_byte(format));
  check_complete(bytes, format, static_cast<uint64_t>(result.width) * static_cast<uint64_t>(result.height), name);
  if (is_16_bit) {
    const StbPixels<uint16_t> pixels(
        stbi_load_16_from_memory(data, size, &result.width, &result.height, &components, 4));
    if (!pixels) fail(name);
    result.rgba16 = copy_rgba(pixels, result.width, result.height);
  } else {
    const StbPixels<uint8_t> pixels(stbi_load_from_memory(data, size, &result.width, &result.height, &components, 4));
    if (!pixels) fail(name);
    result.rgba8 = copy_rgba(pixels, result.width, result.height);
  }
  return result;
}

}  // namespace relume::detail
