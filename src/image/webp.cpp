#include "image/webp.h"

#include <fmt/format.h>
#include <webp/decode.h>

#include "image/image_complete.h"
#include "image/image_limits.h"
#include "relume/error.h"

namespace relume::detail {
namespace {

/// Limit for lossless images of one colour, which have no bits per pixel: the size of large textures.
constexpr int64_t kMostFreePixels = int64_t{4096} * 4096;
/// Limit above that size. The longest copy, of 4096 pixels that may each hold 8 of the image, takes at least 11 bits
/// (WebP Lossless Bitstream Specification, 4.4 and 5.2.2). Lossy images need more.
constexpr int64_t kMostPixelsPerByte = int64_t{1} << 15;

[[noreturn]] void fail(const std::string& name, VP8StatusCode status) {
  if (status == VP8_STATUS_OUT_OF_MEMORY)
    throw Error(fmt::format("{}: not enough memory to decode the WebP image; scale it down", name));
  if (status == VP8_STATUS_UNSUPPORTED_FEATURE)
    throw Error(
        fmt::format("{}: the WebP image has a feature that libwebp does not support; save it as PNG or JPEG", name));
  const char* reason = status == VP8_STATUS_NOT_ENOUGH_DATA ? "it is cut off" : "the data are inconsistent";
  throw Error(fmt::format("{}: damaged WebP image ({}); export or copy it again", name, reason));
}

}  // namespace

bool is_webp(std::span<const std::byte> bytes) { return starts_with(bytes, "RIFF") && starts_with(bytes, "WEBP", 8); }

ImageSize webp_size(std::span<const std::byte> bytes, const std::string& name) {
  WebPBitstreamFeatures features;
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  if (const VP8StatusCode status = WebPGetFeatures(data, bytes.size(), &features); status != VP8_STATUS_OK)
    fail(name, status);
  return {features.width, features.height};
}

DecodedPixels decode_webp(std::span<const std::byte> bytes, const std::string& name) {
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  WebPDecoderConfig config;
  if (WebPInitDecoderConfig(&config) == 0)
    throw Error(name + ": libwebp is older than the one that relume was built with; build relume again");
  if (const VP8StatusCode status = WebPGetFeatures(data, bytes.size(), &config.input); status != VP8_STATUS_OK)
    fail(name, status);
  if (config.input.has_animation != 0)
    throw Error(fmt::format("{}: animated WebP images are not supported; export a single frame", name));
  DecodedPixels result;
  result.width = config.input.width;
  result.height = config.input.height;
  const bool is_free = int64_t{result.width} * result.height <= kMostFreePixels;
  check_image_size(name, result.width, result.height, 4, bytes.size(),
                   4 * (is_free ? kMostFreePixels : kMostPixelsPerByte));
  result.rgba8.resize(size_t{4} * static_cast<size_t>(result.width) * static_cast<size_t>(result.height));
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {result.rgba8.data(), 4 * result.width, result.rgba8.size()};
  const VP8StatusCode status = WebPDecode(data, bytes.size(), &config);
  WebPFreeDecBuffer(&config.output);
  if (status != VP8_STATUS_OK) fail(name, status);
  return result;
}

}  // namespace relume::detail
