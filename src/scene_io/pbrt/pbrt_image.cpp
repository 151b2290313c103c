#include "scene_io/pbrt/pbrt_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>

#include <fmt/format.h>

#include "core/srgb.h"
#include "image/image_size.h"
#include "image/stb_decode.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "scene_io/image_search.h"

namespace relume::pbrt {
namespace {

float number_at(const Texture& texture, size_t index) {
  if (texture.format != PixelFormat::rgba32_float)
    return static_cast<float>(std::to_integer<int>(texture.texels[index])) / 255.0f;
  float value;
  std::memcpy(&value, &texture.texels[index * sizeof value], sizeof value);
  return value;
}

size_t texel_count(const Texture& texture) {
  return static_cast<size_t>(texture.width) * static_cast<size_t>(texture.height);
}

bool is_transparent(const Texture& texture) {
  for (size_t i = 0; i < texel_count(texture); ++i) {
    if (number_at(texture, 4 * i + 3) != 1.0f) return true;
  }
  return false;
}

}  // namespace

float Encoding::decode(float code) const {
  if (srgb) return linear_from_srgb(code);
  return gamma == 1 ? code : std::pow(std::max(code, 0.0f), gamma);
}

Vec4 ImageFile::at(int x, int y, const Encoding& encoding) const {
  const size_t first = 4 * (static_cast<size_t>(y) * static_cast<size_t>(texels.width) + static_cast<size_t>(x));
  Vec4 texel;
  for (int c = 0; c < 4; ++c) texel[c] = number_at(texels, first + static_cast<size_t>(c));
  if (!is_coded) return texel;
  for (int c = 0; c < 3; ++c) texel[c] = encoding.decode(texel[c]);
  return texel;
}

ImageFile ImageFiles::decode(const std::string& name, const Location& where) {
  ImageFile file;
  file.bytes = std::make_shared<const Bytes>(read_file_bytes(find_inside(base_dir_, name, text_of(where))));
  const detail::ImageSize size = detail::read_image_size(*file.bytes, name);
  const bool is_valid = std::min(size.width, size.height) > 0 && std::max(size.width, size.height) <= kMaxImageSide;
  if (!is_valid || !budget_.take(static_cast<uint64_t>(size.width * size.height), file.bytes->size()))
    throw Error(fmt::format("{}: the image has {} x {} pixels, too many for the images of one scene; scale it down",
                            name, size.width, size.height));
  const detail::ImageFormat format = detail::detect_image_format(*file.bytes, name);
  file.is_coded = format != detail::ImageFormat::exr && format != detail::ImageFormat::hdr;
  const PixelFormat wanted = file.is_coded ? PixelFormat::rgba8_linear : PixelFormat::rgba32_float;
  file.texels = decode_texture(*file.bytes, name, wanted);
  if (const std::string repair = repair_texels(file.texels, name, wanted); !repair.empty()) warnings_.add(repair);
  file.has_alpha = is_transparent(file.texels);
  return file;
}

std::shared_ptr<const ImageFile> ImageFiles::read(const std::string& name, const Location& where) {
  const auto [entry, is_new] = files_.try_emplace(name);
  if (!is_new) return entry->second;
  try {
    entry->second = std::make_shared<const ImageFile>(decode(name, where));
  } catch (const std::exception& error) {
    warnings_.add(fmt::format("{}; a constant value replaces the image", error.what()));
  }
  return entry->second;
}

std::optional<Image> ImageFiles::read_light(const std::string& name, const Location& where) {
  const std::shared_ptr<const ImageFile> file = read(name, where);
  if (!file) return std::nullopt;
  Image image(file->texels.width, file->texels.height);
  const Encoding encoding{.srgb = true};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.at(x, y) = Rgb(file->at(x, y, encoding));
  }
  return image;
}

}  // namespace relume::pbrt
