#include "scene_io/texture_decode.h"

#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "core/srgb.h"
#include "image/rgbe.h"
#include "image/stb_decode.h"
#include "relume/image_io.h"

namespace relume {
namespace {

template <typename T>
void set_texels(Texture& texture, const std::vector<T>& values) {
  texture.texels.resize(values.size() * sizeof(T));
  std::memcpy(texture.texels.data(), values.data(), texture.texels.size());
}

/// Texture of linear values, opaque without `alpha`.
Texture float_texture(const Image& image, const ExrChannel* alpha) {
  Texture texture;
  texture.width = image.width;
  texture.height = image.height;
  texture.format = PixelFormat::rgba32_float;
  std::vector<float> values(image.pixels.size() * 4);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) values[4 * i + static_cast<size_t>(c)] = image.pixels[i][c];
    values[4 * i + 3] = alpha != nullptr ? alpha->values[i] : 1.0f;
  }
  set_texels(texture, values);
  return texture;
}

Texture texture_from_exr(std::span<const std::byte> bytes, const std::string& name) {
  const ExrFile exr = parse_exr(bytes, name);
  return float_texture(image_from_exr(exr, {}, name), exr.find("A"));
}

/// Converts integer `samples` to floats in [0, 1]; decodes RGB from sRGB if `decode`.
template <typename T>
std::vector<float> to_float(const std::vector<T>& samples, bool decode) {
  constexpr float kScale = 1.0f / static_cast<float>(std::numeric_limits<T>::max());
  std::vector<float> values(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    const float x = static_cast<float>(samples[i]) * kScale;
    values[i] = decode && i % 4 != 3 ? linear_from_srgb(x) : x;
  }
  return values;
}

std::vector<uint8_t> round_to_8_bit(const std::vector<uint16_t>& samples) {
  std::vector<uint8_t> values(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) values[i] = static_cast<uint8_t>((samples[i] * 255u + 32767u) / 65535u);
  return values;
}

Texture texture_from_stb(std::span<const std::byte> bytes, detail::ImageFormat format, const std::string& name,
                         PixelFormat wanted) {
  const detail::DecodedPixels pixels = detail::decode_pixels(bytes, format, name);
  Texture texture;
  texture.width = pixels.width;
  texture.height = pixels.height;
  const bool is_16_bit = !pixels.rgba16.empty();
  const bool is_float = wanted == PixelFormat::rgba32_float || (wanted == PixelFormat::rgba8_linear && is_16_bit);
  if (is_float) {
    const bool decode = wanted == PixelFormat::rgba32_float && !pixels.linear;
    set_texels(texture, is_16_bit ? to_float(pixels.rgba16, decode) : to_float(pixels.rgba8, decode));
  } else {
    set_texels(texture, is_16_bit ? round_to_8_bit(pixels.rgba16) : pixels.rgba8);
  }
  texture.format = is_float ? PixelFormat::rgba32_float : wanted;
  return texture;
}

}  // namespace

Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, PixelFormat wanted) {
  const detail::ImageFormat format = detail::detect_image_format(bytes, name);
  Texture texture;
  switch (format) {
    case detail::ImageFormat::exr: texture = texture_from_exr(bytes, name); break;
    case detail::ImageFormat::hdr: texture = float_texture(detail::parse_rgbe(bytes, name), nullptr); break;
    default: texture = texture_from_stb(bytes, format, name, wanted); break;
  }
  texture.name = name;
  return texture;
}

bool DecodeBudget::take(uint64_t texels, uint64_t file_bytes) {
  file_bytes_ += file_bytes;
  if (texels_ + texels > kFreeTexels + kTexelsPerByte * file_bytes_) return false;
  texels_ += texels;
  return true;
}

std::string repair_texels(Texture& texture, const std::string& name, PixelFormat wanted) {
  if (texture.format != PixelFormat::rgba32_float) return {};
  const float largest = wanted == PixelFormat::rgba8_linear ? 1.0f : kMaxRadiance;
  size_t repaired = 0;
  for (size_t i = 0; i < texture.texels.size(); i += sizeof(float)) {
    float value;
    std::memcpy(&value, &texture.texels[i], sizeof value);
    if (value >= 0.0f && value <= largest) continue;
    value = value > largest ? largest : 0.0f;
    std::memcpy(&texture.texels[i], &value, sizeof value);
    ++repaired;
  }
  if (repaired == 0) return {};
  return fmt::format("{}: {} values are negative, above {:g} or not finite; the nearest valid values replace them",
                     name, repaired, largest);
}

}  // namespace relume
