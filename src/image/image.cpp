// Reading and writing by format; exr.cpp, rgbe.cpp and stb_decode.cpp contain the codecs.
#include "relume/image_io.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <stb_image_write.h>

#include "core/srgb.h"
#include "files/atomic_file.h"
#include "files/extension.h"
#include "image/image_limits.h"
#include "image/rgbe.h"
#include "image/stb_decode.h"
#include "relume/error.h"

namespace relume {
namespace {

constexpr int kJpegQuality = 95;
constexpr int kMaxJpegSide = 65535;  // 16 bits in the frame header
constexpr int kMaxTgaSide = 65535;   // 16 bits in the header

/// Display-ready values in [0, 1] as 8-bit sRGB.
std::vector<uint8_t> encode_srgb8(const Image& image) {
  std::vector<uint8_t> bytes(image.pixels.size() * 3);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      bytes[3 * i + static_cast<size_t>(c)] = quantise_unorm8(srgb_from_linear(image.pixels[i][c]));
  }
  return bytes;
}

/// Clamps to the format's range: no negative values or NaN, and at most just below 2^127.
std::vector<float> clamp_to_rgbe(const Image& image) {
  constexpr float kMax = 0x1.fp126f;
  std::vector<float> values(image.pixels.size() * 3);
  for (size_t i = 0; i < values.size(); ++i) {
    const float x = image.pixels[i / 3][static_cast<int>(i % 3)];
    values[i] = x > 0.0f ? std::min(x, kMax) : 0.0f;
  }
  return values;
}

void write_chunk(void* target, void* data, int size) {
  static_cast<AtomicFile*>(target)->write({static_cast<const std::byte*>(data), static_cast<size_t>(size)});
}

void append_chunk(void* target, void* data, int size) {
  auto& bytes = *static_cast<std::vector<uint8_t>*>(target);
  bytes.insert(bytes.end(), static_cast<const uint8_t*>(data), static_cast<const uint8_t*>(data) + size);
}

void check_side(const std::string& name, const Image& image, int max_side) {
  if (std::max(image.width, image.height) > max_side)
    throw Error(
        fmt::format("{}: {}x{} pixels exceed the limit of this format; write an EXR", name, image.width, image.height));
}

/// Writes through stb_image_write. `extension` is one of write_image()'s except .exr.
void write_with_stb(const std::filesystem::path& file, const std::string& extension, const Image& image) {
  const std::string name = file.string();
  if (static_cast<int64_t>(image.width) * image.height * 4 > std::numeric_limits<int>::max())
    check_side(name, image, 0);
  if (extension == ".tga") check_side(name, image, kMaxTgaSide);
  if (extension == ".jpg" || extension == ".jpeg") check_side(name, image, kMaxJpegSide);
  AtomicFile target(file);
  int written = 0;
  if (extension == ".hdr") {
    written = stbi_write_hdr_to_func(write_chunk, &target, image.width, image.height, 3, clamp_to_rgbe(image).data());
  } else {
    const std::vector<uint8_t> bytes = encode_srgb8(image);
    if (extension == ".png") {
      written =
          stbi_write_png_to_func(write_chunk, &target, image.width, image.height, 3, bytes.data(), image.width * 3);
    } else if (extension == ".tga") {
      written = stbi_write_tga_to_func(write_chunk, &target, image.width, image.height, 3, bytes.data());
    } else {
      written = stbi_write_jpg_to_func(write_chunk, &target, image.width, image.height, 3, bytes.data(), kJpegQuality);
    }
  }
  if (written == 0) throw Error(fmt::format("{}: the image cannot be encoded; write an EXR", name));
  target.commit();
}

template <typename T, typename Decode>
void fill(Image& image, const std::vector<T>& rgba, Decode&& decode) {
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {decode(rgba[4 * i]), decode(rgba[4 * i + 1]), decode(rgba[4 * i + 2])};
}

}  // namespace

namespace detail {

void check_image_size(const std::string& name, int64_t width, int64_t height, int64_t bytes_per_pixel,
                      uint64_t file_bytes, int64_t max_expansion) {
  if (width <= 0 || height <= 0)
    throw Error(fmt::format("{}: the image has no pixels ({}x{}); export it again", name, width, height));
  if (width > kMaxImageSide || height > kMaxImageSide || width * height > kMaxImagePixels ||
      width * height * bytes_per_pixel > kMaxDecodedBytes)
    throw Error(fmt::format(
        "{}: {}x{} pixels of {} bytes exceed the limits of 2^17 per side, 2^28 pixels and 8 GiB; scale it down", name,
        width, height, bytes_per_pixel));
  if (static_cast<uint64_t>(width * height * bytes_per_pixel) / static_cast<uint64_t>(max_expansion) > file_bytes)
    throw Error(fmt::format(
        "{}: the header declares {}x{} pixels, more than a file of {} bytes can hold; export or copy it again", name,
        width, height, file_bytes));
}

}  // namespace detail

Image parse_image(std::span<const std::byte> bytes, const std::string& name) {
  const detail::ImageFormat format = detail::detect_image_format(bytes, name);
  if (format == detail::ImageFormat::exr) return image_from_exr(parse_exr(bytes, name), {}, name);
  if (format == detail::ImageFormat::hdr) return detail::parse_rgbe(bytes, name);
  const detail::DecodedPixels pixels = detail::decode_pixels(bytes, format, name);
  Image image(pixels.width, pixels.height);
  if (!pixels.rgba16.empty()) {
    fill(image, pixels.rgba16, [](uint16_t x) { return linear_from_srgb(static_cast<float>(x) / 65535.0f); });
  } else {
    float linear[256];
    for (int i = 0; i < 256; ++i) {
      const float x = static_cast<float>(i) / 255.0f;
      linear[i] = pixels.linear ? x : linear_from_srgb(x);
    }
    fill(image, pixels.rgba8, [&](uint8_t x) { return linear[x]; });
  }
  return image;
}

Image read_image(const std::filesystem::path& file) { return parse_image(read_file(file), file.string()); }

void write_image(const std::filesystem::path& file, const Image& image) {
  const std::string extension = lower_extension(file);
  const bool known = extension == ".exr" || extension == ".hdr" || extension == ".png" || extension == ".jpg" ||
                     extension == ".jpeg" || extension == ".tga";
  if (!known)
    throw Error(fmt::format("{}: images cannot be written as '{}'; use .exr, .hdr, .png, .jpg or .tga", file.string(),
                            extension));
  if (image.width <= 0 || image.height <= 0)
    throw Error(fmt::format("{}: an image of {}x{} pixels cannot be written; give it at least one pixel", file.string(),
                            image.width, image.height));
  if (extension != ".exr") return write_with_stb(file, extension, image);
  ExrFile exr;
  exr.width = image.width;
  exr.height = image.height;
  exr.channels = exr_channels(image);
  write_exr(file, exr);
}

std::vector<uint8_t> encode_png(const Image& image) {
  return encode_png(encode_srgb8(image), image.width, image.height);
}

std::vector<uint8_t> encode_png(std::span<const uint8_t> rgb, int width, int height) {
  const uint64_t size = uint64_t{3} * static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  const bool fits = width > 0 && height > 0 && rgb.size() == size && size < (uint64_t{1} << 30);
  std::vector<uint8_t> bytes;
  if (!fits || stbi_write_png_to_func(append_chunk, &bytes, width, height, 3, rgb.data(), width * 3) == 0) {
    throw Error(fmt::format("an image of {}x{} pixels cannot be encoded as PNG; make it smaller", width, height));
  }
  return bytes;
}

}  // namespace relume
