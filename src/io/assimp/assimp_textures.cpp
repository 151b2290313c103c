#include "io/assimp/assimp_textures.h"

#include <algorithm>
#include <exception>

#include <assimp/scene.h>
#include <assimp/texture.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "io/bytes.h"
#include "io/texture_decode.h"

namespace relume {
namespace {

constexpr std::byte kWhite{255};
constexpr size_t kMaxEmbeddedTexels = size_t{1} << 28;

PixelFormat format_of(TextureRecipe recipe) {
  const bool is_color = recipe == TextureRecipe::color || recipe == TextureRecipe::color_and_alpha;
  return is_color ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear;
}

bool is_8_bit(const Texture& image) { return image.format != PixelFormat::rgba32_float; }

size_t byte_count(int width, int height) {
  return size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height);
}

/// First byte of the texel of `image` nearest to texel (x, y) of a texture of `width` x `height`.
size_t nearest_texel(const Texture& image, int x, int y, int width, int height) {
  const auto u = static_cast<size_t>(static_cast<int64_t>(x) * image.width / width);
  const auto v = static_cast<size_t>(static_cast<int64_t>(y) * image.height / height);
  return 4 * (v * static_cast<size_t>(image.width) + u);
}

bool has_alpha(const Texture& image) {
  for (size_t i = 3; i < image.texels.size(); i += 4) {
    if (image.texels[i] != kWhite) return true;
  }
  return false;
}

/// OBJ's "bump" may be a height map (grey) or, against its specification but often, a normal map.
bool is_grey(const Texture& image) {
  for (size_t i = 0; i + 3 < image.texels.size(); i += 4) {
    if (image.texels[i] != image.texels[i + 1] || image.texels[i] != image.texels[i + 2]) return false;
  }
  return true;
}

Texture copy_embedded(const aiTexture& source) {
  Texture texture;
  const size_t count = size_t{source.mWidth} * source.mHeight;
  if (count == 0 || count > kMaxEmbeddedTexels || !source.pcData) throw Error("an embedded image has no pixels");
  texture.width = static_cast<int>(source.mWidth);
  texture.height = static_cast<int>(source.mHeight);
  texture.texels.reserve(4 * count);
  for (size_t i = 0; i < count; ++i) {
    const aiTexel& texel = source.pcData[i];
    for (const unsigned char c : {texel.r, texel.g, texel.b, texel.a})
      texture.texels.push_back(static_cast<std::byte>(c));
  }
  return texture;
}

}  // namespace

Index AssimpTextures::request(TextureRecipe recipe, const std::string& first, const std::string& second,
                              WrapMode wrap_u, WrapMode wrap_v) {
  for (size_t i = 0; i < requests_.size(); ++i) {
    const Request& r = requests_[i];
    const Texture& t = scene_.textures[i];
    if (r.recipe == recipe && r.first == first && r.second == second && t.wrap_u == wrap_u && t.wrap_v == wrap_v)
      return static_cast<Index>(i);
  }
  add_image(first, format_of(recipe));
  add_image(second, format_of(recipe));
  requests_.push_back({recipe, first, second});
  Texture texture;
  texture.name = first.empty() ? second : first;
  texture.format = format_of(recipe);
  texture.wrap_u = wrap_u;
  texture.wrap_v = wrap_v;
  scene_.textures.push_back(std::move(texture));
  return static_cast<Index>(requests_.size()) - 1;
}

void AssimpTextures::add_image(const std::string& path, PixelFormat format) {
  if (!path.empty()) images_.try_emplace({path, format});
}

/// Paths from other machines are tried as written, then by file name beside the scene and in "textures".
std::filesystem::path AssimpTextures::find_file(const std::string& path) const {
  std::string slashes = path;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const std::filesystem::path written(slashes);
  const std::filesystem::path candidates[] = {base_dir_ / written, base_dir_ / written.filename(),
                                              base_dir_ / "textures" / written.filename()};
  std::error_code error;
  for (const auto& candidate : candidates) {
    if (std::filesystem::is_regular_file(candidate, error)) return candidate;
  }
  return candidates[0];
}

Texture AssimpTextures::decode(const std::string& path, PixelFormat format) const {
  if (const aiTexture* embedded = source_.GetEmbeddedTexture(path.c_str())) {
    if (embedded->mHeight != 0) return copy_embedded(*embedded);
    return decode_texture({reinterpret_cast<const std::byte*>(embedded->pcData), embedded->mWidth}, path, format);
  }
  return decode_texture(read_file_bytes(find_file(path)), path, format);
}

const Texture* AssimpTextures::image(const std::string& path, PixelFormat format) const {
  const auto it = images_.find({path, format});
  return it == images_.end() || it->second.texels.empty() ? nullptr : &it->second;
}

void AssimpTextures::compose(const Request& request, Texture& texture) {
  const Texture* first = image(request.first, texture.format);
  const Texture* second = image(request.second, texture.format);
  if (request.recipe == TextureRecipe::normal && first && is_grey(*first)) {
    warnings_.add(fmt::format("{}: height maps are not supported; the bumps are ignored", request.first));
    first = nullptr;
  }
  const bool is_plain =
      request.recipe != TextureRecipe::color_and_alpha && request.recipe != TextureRecipe::roughness_metal;
  if (is_plain && first) {
    texture.width = first->width;
    texture.height = first->height;
    texture.format = first->format;
    texture.texels = first->texels;
    return;
  }
  if (first && !is_8_bit(*first)) first = nullptr;
  if (second && !is_8_bit(*second)) second = nullptr;
  texture.width = std::max(first ? first->width : 1, second ? second->width : 1);
  texture.height = std::max(first ? first->height : 1, second ? second->height : 1);
  texture.texels.assign(byte_count(texture.width, texture.height), kWhite);
  if (request.recipe == TextureRecipe::normal) texture.texels[0] = texture.texels[1] = std::byte{128};
  const size_t opacity_channel = second && has_alpha(*second) ? 3 : 0;
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) {
      std::byte* texel =
          &texture.texels[4 * (static_cast<size_t>(y) * static_cast<size_t>(texture.width) + static_cast<size_t>(x))];
      const std::byte* a = first ? &first->texels[nearest_texel(*first, x, y, texture.width, texture.height)] : nullptr;
      const std::byte* b =
          second ? &second->texels[nearest_texel(*second, x, y, texture.width, texture.height)] : nullptr;
      if (request.recipe == TextureRecipe::roughness_metal) {
        if (a) texel[1] = a[0];
        if (b) texel[2] = b[0];
      } else {
        if (a) std::copy_n(a, 3, texel);
        if (b) texel[3] = b[opacity_channel];
      }
    }
  }
}

void AssimpTextures::finish() {
  std::vector<decltype(images_)::value_type*> entries;
  for (auto& entry : images_) entries.push_back(&entry);
  std::vector<std::string> problems(entries.size());
  tbb::parallel_for(size_t{0}, entries.size(), [&](size_t i) {
    try {
      entries[i]->second = decode(entries[i]->first.first, entries[i]->first.second);
    } catch (const std::exception& error) {
      problems[i] = error.what();
    }
  });
  for (const std::string& problem : problems) {
    if (!problem.empty()) warnings_.add(fmt::format("{}; the texture is left out", problem));
  }
  for (size_t i = 0; i < requests_.size(); ++i) compose(requests_[i], scene_.textures[i]);
  images_.clear();
}

bool AssimpTextures::has_transparency(Index texture) const {
  const Texture& t = scene_.textures[static_cast<size_t>(texture)];
  if (!is_8_bit(t)) return false;
  for (size_t i = 3; i < t.texels.size(); i += 4) {
    if (t.texels[i] < std::byte{128}) return true;
  }
  return false;
}

}  // namespace relume
