#include "io/texture_decode.h"

#include <cstring>
#include <memory>

#include <stb_image.h>

#include "core/error.h"

namespace relume {
namespace {

constexpr int kMaxTexels = 1 << 28;

}  // namespace

Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, PixelFormat wanted) {
  Texture texture;
  texture.name = name;
  texture.format = wanted;
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  if (bytes.size() > 0x7fffffffu || !stbi_info_from_memory(data, size, &texture.width, &texture.height, nullptr))
    throw Error(name + ": this is not an image in a supported format; use PNG or JPEG");
  if (static_cast<int64_t>(texture.width) * texture.height > kMaxTexels) throw Error(name + ": the image is too large");
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &texture.width, &texture.height, nullptr, 4), stbi_image_free);
  if (!pixels) throw Error(name + ": the image is damaged; export it anew");
  texture.texels.resize(size_t{4} * static_cast<size_t>(texture.width) * static_cast<size_t>(texture.height));
  std::memcpy(texture.texels.data(), pixels.get(), texture.texels.size());
  return texture;
}

}  // namespace relume
