#include "scene_io/assimp/assimp_textures.h"

#include <algorithm>
#include <cstring>
#include <exception>

#include <fmt/format.h>

#include "core/activity.h"
#include "core/parallel.h"
#include "core/srgb.h"
#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/image_search.h"
#include "scene_io/texture_decode.h"

namespace relume {
namespace {

const Vec4 kFlatNormal(128.0f / 255.0f, 128.0f / 255.0f, 1, 1);

PixelFormat format_of(TextureRecipe recipe) {
  const bool is_color = recipe == TextureRecipe::color || recipe == TextureRecipe::color_and_alpha;
  return is_color ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear;
}

bool is_8_bit(const Texture& image) { return image.format != PixelFormat::rgba32_float; }

/// Value `index` of an image with four values per texel; bytes map to [0, 1].
float number_at(const Texture& image, size_t index) {
  if (is_8_bit(image)) return static_cast<float>(std::to_integer<int>(image.texels[index])) / 255.0f;
  float value;
  std::memcpy(&value, &image.texels[index * sizeof value], sizeof value);
  return value;
}

size_t number_count(const Texture& image) {
  return size_t{4} * static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
}

/// Index of the first value of `image`'s texel nearest to texel (x, y) of `texture`.
size_t nearest_texel(const Texture& image, int x, int y, const Texture& texture) {
  const auto u = static_cast<size_t>(static_cast<int64_t>(x) * image.width / texture.width);
  const auto v = static_cast<size_t>(static_cast<int64_t>(y) * image.height / texture.height);
  return 4 * (v * static_cast<size_t>(image.width) + u);
}

bool has_alpha(const Texture& image) {
  for (size_t i = 3; i < number_count(image); i += 4) {
    if (number_at(image, i) != 1.0f) return true;
  }
  return false;
}

/// Distinguishes height maps (grey) from normal maps. OBJ's "bump" specifies a height map, but often holds a normal
/// map.
bool is_grey(const Texture& image) {
  for (size_t i = 0; i < number_count(image); i += 4) {
    const float red = number_at(image, i);
    if (red != number_at(image, i + 1) || red != number_at(image, i + 2)) return false;
  }
  return true;
}

/// Appends a texel in the texture's format.
void append(Texture& texture, const Vec4& texel) {
  if (is_8_bit(texture)) {
    for (int c = 0; c < 4; ++c) texture.texels.push_back(std::byte{quantise_unorm8(texel[c])});
  } else {
    const auto* first = reinterpret_cast<const std::byte*>(&texel);
    texture.texels.insert(texture.texels.end(), first, first + sizeof texel);
  }
}

Texture texture_from_texels(const EmbeddedImage& source) {
  const bool has_texels =
      source.width > 0 && source.height > 0 &&
      source.bytes.size() == size_t{4} * static_cast<size_t>(source.width) * static_cast<size_t>(source.height);
  if (!has_texels) throw Error("an embedded image has no pixels");
  Texture texture;
  texture.width = source.width;
  texture.height = source.height;
  texture.texels = source.bytes;
  return texture;
}

}  // namespace

Texture AssimpTextures::decode(const std::string& path, PixelFormat format) const {
  const auto embedded = imported_.embedded.find(path);
  if (embedded == imported_.embedded.end())
    return decode_texture(read_file_bytes(find_image(base_dir_, path, path)), path, format);
  if (embedded->second.height != 0) return texture_from_texels(embedded->second);
  return decode_texture(embedded->second.bytes, path, format);
}

const Texture* AssimpTextures::image(const std::string& path, PixelFormat format) const {
  const auto it = images_.find({path, format});
  return it == images_.end() || it->second.texels.empty() ? nullptr : &it->second;
}

void AssimpTextures::compose(const TextureRequest& request, Texture& texture, Warnings& warnings) const {
  const Texture* first = image(request.first, texture.format);
  const Texture* second = image(request.second, texture.format);
  if (request.recipe == TextureRecipe::normal && first && is_grey(*first)) {
    warnings.add(fmt::format("{}: height maps are not supported; the bumps are ignored", request.first));
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
  const bool is_color = request.recipe == TextureRecipe::color_and_alpha;
  // One float image makes the combined texture float.
  if ((first && !is_8_bit(*first)) || (second && !is_8_bit(*second))) texture.format = PixelFormat::rgba32_float;
  texture.width = std::max(first ? first->width : 1, second ? second->width : 1);
  texture.height = std::max(first ? first->height : 1, second ? second->height : 1);
  const bool decode = is_color && first && is_8_bit(*first) && !is_8_bit(texture);
  texture.texels.reserve(static_cast<size_t>(texture.width) * static_cast<size_t>(texture.height) *
                         (is_8_bit(texture) ? 4 : sizeof(Vec4)));
  const size_t opacity_channel = second && has_alpha(*second) ? 3 : 0;
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) {
      Vec4 texel = request.recipe == TextureRecipe::normal ? kFlatNormal : Vec4(1);
      const size_t a = first ? nearest_texel(*first, x, y, texture) : 0;
      const size_t b = second ? nearest_texel(*second, x, y, texture) : 0;
      if (is_color) {
        for (int c = 0; first && c < 3; ++c) {
          const float number = number_at(*first, a + static_cast<size_t>(c));
          texel[c] = decode ? linear_from_srgb(number) : number;
        }
        if (second) texel.w = number_at(*second, b + opacity_channel);
      } else {
        if (first) texel.y = number_at(*first, a);
        if (second) texel.z = number_at(*second, b);
      }
      append(texture, texel);
    }
  }
}

void AssimpTextures::decode_images() {
  std::vector<Images::value_type*> entries;
  for (auto& entry : images_) entries.push_back(&entry);
  std::vector<std::string> problems(entries.size());
  std::vector<std::string> repairs(entries.size());
  parallel_for(entries.size(), [&](size_t i) {
    try {
      const auto& [path, format] = entries[i]->first;
      entries[i]->second = decode(path, format);
      repairs[i] = repair_texels(entries[i]->second, path, format);
    } catch (const std::exception& error) {
      problems[i] = error.what();
    }
  });
  for (const std::string& problem : problems) {
    if (!problem.empty()) warnings_.add(fmt::format("{}; the texture is left out", problem));
  }
  for (const std::string& repair : repairs) {
    if (!repair.empty()) warnings_.add(repair);
  }
}

void AssimpTextures::finish() {
  const std::vector<TextureRequest>& requests = imported_.textures;
  std::vector<Texture>& textures = imported_.scene.textures;
  for (const TextureRequest& request : requests) {
    Texture& texture = textures.emplace_back();
    texture.name = request.first.empty() ? request.second : request.first;
    texture.format = format_of(request.recipe);
    texture.wrap_u = request.wrap_u;
    texture.wrap_v = request.wrap_v;
    for (const std::string& path : {request.first, request.second}) {
      if (!path.empty()) images_.try_emplace({path, texture.format});
    }
  }
  decode_images();
  std::vector<Warnings> warnings(requests.size(), Warnings(""));
  Activity activity("decoding textures", requests.size());
  parallel_for(requests.size(), [&](size_t i) {
    compose(requests[i], textures[i], warnings[i]);
    activity.part_done();
  });
  for (const Warnings& part : warnings) warnings_.add(part);
  for (const TextureRequest& request : requests)
    missing_.push_back(image(request.first, format_of(request.recipe)) == nullptr);
  images_.clear();
}

void AssimpTextures::darken_missing_lamps() const {
  for (const Index lamp : imported_.texture_lamps) {
    Material& material = imported_.scene.materials[static_cast<size_t>(lamp)];
    if (missing_[static_cast<size_t>(material.emission_texture.texture)]) material.emission = Rgb(0);
  }
}

void AssimpTextures::mask_transparent_textures() const {
  for (Material& material : imported_.scene.materials) {
    const bool undecided = material.alpha_mode == AlphaMode::opaque && material.base_color_texture.used();
    if (undecided && has_transparency(material.base_color_texture.texture)) material.alpha_mode = AlphaMode::mask;
  }
}

bool AssimpTextures::has_transparency(Index texture) const {
  const Texture& t = imported_.scene.textures[static_cast<size_t>(texture)];
  for (size_t i = 3; i < number_count(t); i += 4) {
    if (number_at(t, i) < 0.5f) return true;
  }
  return false;
}

}  // namespace relume
