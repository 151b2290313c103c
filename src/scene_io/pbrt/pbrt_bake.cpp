// Bakes surfaces to textures.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "core/parallel.h"
#include "core/srgb.h"
#include "scene_io/pbrt/pbrt_surface.h"

namespace relume::pbrt {
namespace {

constexpr int kMaxSide = 8192;
constexpr int kMaxPatternSide = 2048;  // without images
constexpr int kCellTexels = 16;        // of a checkerboard, if it is combined with other textures
constexpr int kSmallSide = 64;         // beyond the budget
constexpr uint64_t kFreeTexels = uint64_t{1} << 24;
constexpr uint64_t kTexelsPerTexel = 16;  // of the images

/// A texture of a material, and the members of a surface that it stores.
struct Channels {
  TextureRef Material::*texture;
  bool is_color;
  Vec4 (*texel)(const Surface&);
  void (*set_constant)(const Surface&, Material&);
  void (*set_textured)(Material&);
};

constexpr std::array kChannels = {
    Channels{&Material::base_color_texture, true, [](const Surface& s) { return Vec4(s.base_color, s.alpha); },
             [](const Surface& s, Material& m) {
               m.base_color = s.base_color;
               m.alpha = s.alpha;
             },
             [](Material& m) {
               m.base_color = Rgb(1);
               m.alpha = 1;
             }},
    Channels{&Material::metallic_roughness_texture, false,
             [](const Surface& s) { return Vec4(0, s.roughness, s.metallic, 1); },
             [](const Surface& s, Material& m) {
               m.roughness = s.roughness;
               m.metallic = s.metallic;
             },
             [](Material& m) { m.roughness = m.metallic = 1; }},
    Channels{&Material::specular_texture, false, [](const Surface& s) { return Vec4(1, 1, 1, s.specular); },
             [](const Surface& s, Material& m) { m.specular = s.specular; }, [](Material& m) { m.specular = 1; }},
    Channels{&Material::specular_color_texture, true, [](const Surface& s) { return Vec4(s.specular_color, 1); },
             [](const Surface& s, Material& m) { m.specular_color = s.specular_color; },
             [](Material& m) { m.specular_color = Rgb(1); }},
    Channels{&Material::transmission_texture, false, [](const Surface& s) { return Vec4(Rgb(s.transmission), 1); },
             [](const Surface& s, Material& m) { m.transmission = s.transmission; },
             [](Material& m) { m.transmission = 1; }},
    Channels{&Material::clearcoat_texture, false, [](const Surface& s) { return Vec4(Rgb(s.clearcoat), 1); },
             [](const Surface& s, Material& m) { m.clearcoat = s.clearcoat; }, [](Material& m) { m.clearcoat = 1; }},
    Channels{&Material::clearcoat_roughness_texture, false,
             [](const Surface& s) { return Vec4(Rgb(s.clearcoat_roughness), 1); },
             [](const Surface& s, Material& m) { m.clearcoat_roughness = s.clearcoat_roughness; },
             [](Material& m) { m.clearcoat_roughness = 1; }},
    Channels{&Material::diffuse_transmission_texture, false,
             [](const Surface& s) { return Vec4(1, 1, 1, s.diffuse_transmission); },
             [](const Surface& s, Material& m) { m.diffuse_transmission = s.diffuse_transmission; },
             [](Material& m) { m.diffuse_transmission = 1; }},
    Channels{&Material::diffuse_transmission_color_texture, true,
             [](const Surface& s) { return Vec4(s.diffuse_transmission_color, 1); },
             [](const Surface& s, Material& m) { m.diffuse_transmission_color = s.diffuse_transmission_color; },
             [](Material& m) { m.diffuse_transmission_color = Rgb(1); }}};

void add_leaves(const TextureNode* node, std::vector<const TextureNode*>& leaves) {
  if (!node) return;
  if (node->kind == TextureNode::Kind::image || node->kind == TextureNode::Kind::checkerboard) leaves.push_back(node);
  for (const TextureNode* input : node->inputs) add_leaves(input, leaves);
}

std::array<std::byte, 4> encoded(const Vec4& texel, bool is_color) {
  std::array<std::byte, 4> bytes;
  for (size_t c = 0; c < 4; ++c) {
    const float value = texel[static_cast<int>(c)];
    bytes[c] = std::byte{quantise_unorm8(is_color && c < 3 ? srgb_from_linear(value) : value)};
  }
  return bytes;
}

/// Whether two texels differ by more than rounding.
bool differ(const Vec4& a, const Vec4& b) {
  constexpr float kRounding = 1e-5f;
  return glm::any(glm::greaterThan(glm::abs(a - b), Vec4(kRounding)));
}

/// Whether a texture repeats the texels of an image file.
bool repeats(const Texture& texture, const ImageFile& image) {
  return image.texels.format == PixelFormat::rgba8_linear && image.texels.width == texture.width &&
         image.texels.height == texture.height && image.texels.texels == texture.texels;
}

}  // namespace

/// Part of the texture coordinates that a baked image covers.
struct SurfaceBaker::Domain {
  UvMapping mapping;  ///< (s, t) in [0, 1]² is the image
  int width = 1;
  int height = 1;
  WrapMode wrap = WrapMode::repeat;
  FilterMode filter = FilterMode::linear;
  const ImageFile* image = nullptr;  ///< the only image

  /// Coordinates of the centre of a texel.
  Vec2 uv(int x, int y) const {
    const Vec2 st((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                  1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
    return (st - mapping.offset) / mapping.scale;
  }
};

SurfaceBaker::Domain SurfaceBaker::domain_of(const SurfaceModel& model) {
  std::vector<const TextureNode*> leaves;
  for (const TextureNode* node : model.nodes) add_leaves(node, leaves);
  Domain domain;
  if (leaves.empty()) return domain;
  const auto mapping_of = [](const TextureNode& leaf) {
    UvMapping mapping = leaf.mapping;
    if (leaf.kind == TextureNode::Kind::checkerboard) mapping = {mapping.scale / 2.0f, mapping.offset / 2.0f};
    return mapping;
  };
  const bool is_common = std::all_of(leaves.begin(), leaves.end(), [&](const TextureNode* leaf) {
    return mapping_of(*leaf) == mapping_of(*leaves[0]) && leaf->mapping.scale.x != 0 && leaf->mapping.scale.y != 0;
  });
  const bool has_image = std::any_of(leaves.begin(), leaves.end(),
                                     [](const TextureNode* leaf) { return leaf->kind == TextureNode::Kind::image; });
  if (is_common) domain.mapping = mapping_of(*leaves[0]);
  const auto limit = static_cast<float>(has_image ? kMaxSide : kMaxPatternSide);
  for (const TextureNode* leaf : leaves) {
    const Vec2 repeats = is_common ? Vec2(1) : glm::max(glm::abs(leaf->mapping.scale), Vec2(1));
    const bool is_image = leaf->kind == TextureNode::Kind::image;
    const float cell = static_cast<float>(is_common && !has_image ? 1 : kCellTexels);
    const Vec2 size =
        is_image ? Vec2(static_cast<float>(leaf->image->texels.width), static_cast<float>(leaf->image->texels.height))
                 : Vec2(is_common ? 2 * cell : cell);
    domain.width = std::max(domain.width, static_cast<int>(std::min(std::ceil(size.x * repeats.x), limit)));
    domain.height = std::max(domain.height, static_cast<int>(std::min(std::ceil(size.y * repeats.y), limit)));
    if (is_image) domain.image = leaf->image.get();
    if (is_image) allowed_ += kTexelsPerTexel * static_cast<uint64_t>(size.x * size.y);
    if (is_image) domain.wrap = leaf->wrap;
    if (is_image ? leaf->nearest : is_common && !has_image) domain.filter = FilterMode::nearest;
  }
  if (!is_common) domain.wrap = WrapMode::repeat;
  if (!is_common) warnings_.note("textures of different mappings are combined for coordinates from 0 to 1");
  return domain;
}

void SurfaceBaker::add_textures(const SurfaceModel& model, const Domain& domain, Material& material) {
  const auto rows = static_cast<size_t>(domain.height);
  const auto columns = static_cast<size_t>(domain.width);
  const auto surface_at = [&](size_t x, size_t y) {
    return model.at(domain.uv(static_cast<int>(x), static_cast<int>(y)));
  };
  const Surface first = surface_at(0, 0);
  std::vector<std::array<bool, kChannels.size()>> varies(rows);
  parallel_for(rows, [&](size_t y) {
    varies[y].fill(false);
    for (size_t x = 0; x < columns; ++x) {
      const Surface surface = surface_at(x, y);
      for (size_t k = 0; k < kChannels.size(); ++k)
        varies[y][k] = varies[y][k] || differ(kChannels[k].texel(surface), kChannels[k].texel(first));
    }
  });
  for (size_t k = 0; k < kChannels.size(); ++k) {
    if (std::none_of(varies.begin(), varies.end(), [&](const auto& row) { return row[k]; })) continue;
    Texture texture;
    texture.texels.resize(4 * rows * columns);
    parallel_for(rows, [&](size_t y) {
      for (size_t x = 0; x < columns; ++x) {
        const auto bytes = encoded(kChannels[k].texel(surface_at(x, y)), kChannels[k].is_color);
        std::memcpy(&texture.texels[4 * (y * columns + x)], bytes.data(), bytes.size());
      }
    });
    kChannels[k].set_textured(material);
    material.*kChannels[k].texture = add(std::move(texture), model, domain, kChannels[k].is_color);
  }
}

TextureRef SurfaceBaker::add(Texture texture, const SurfaceModel& model, const Domain& domain, bool is_color) {
  texture.name = model.uniform.name;
  texture.width = domain.width;
  texture.height = domain.height;
  texture.format = is_color ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear;
  texture.wrap_u = texture.wrap_v = domain.wrap;
  texture.filter = domain.filter;
  if (domain.image && repeats(texture, *domain.image)) texture.file = domain.image->bytes;
  TextureRef ref;
  ref.texture = static_cast<Index>(scene_.textures.size());
  const UvMapping& map = domain.mapping;
  ref.scale = map.scale;
  ref.offset = {map.offset.x, 1 - map.scale.y - map.offset.y};  // v points down
  scene_.textures.push_back(std::move(texture));
  return ref;
}

bool SurfaceBaker::keeps_image(const SurfaceModel& model) const {
  const TextureNode* node = model.plain_color;
  return node && node->kind == TextureNode::Kind::image && node->encoding.srgb && node->scale == 1 && !node->invert &&
         !node->image->has_alpha && node->image->texels.format == PixelFormat::rgba8_linear;
}

void SurfaceBaker::add_normal_map(const SurfaceModel& model, Material& material) {
  if (model.normal_map.empty()) return;
  const auto [known, is_new] = normal_maps_.try_emplace(model.normal_map, kNone);
  if (is_new) {
    const std::shared_ptr<const ImageFile> image = images_.read(model.normal_map, model.where);
    if (!image) return;
    Texture texture = image->texels;
    texture.name = model.normal_map;
    texture.file = image->bytes;
    known->second = static_cast<Index>(scene_.textures.size());
    scene_.textures.push_back(std::move(texture));
  }
  material.normal_texture.texture = known->second;
}

Material SurfaceBaker::bake(const SurfaceModel& model) {
  Material material = model.uniform;
  Domain domain = domain_of(model);
  const Surface surface = model.at(domain.uv(0, 0));
  for (const Channels& channels : kChannels) channels.set_constant(surface, material);
  if (domain.width > 1 || domain.height > 1) {
    const uint64_t texels = static_cast<uint64_t>(domain.width) * static_cast<uint64_t>(domain.height);
    texels_ += texels;
    if (texels_ > kFreeTexels + allowed_) {
      warnings_.add("the textures of the materials have too many texels; some become small");
      domain.width = std::min(domain.width, kSmallSide);
      domain.height = std::min(domain.height, kSmallSide);
      domain.image = nullptr;
    }
    if (keeps_image(model) && domain.image && domain.width == domain.image->texels.width) {
      Texture texture;
      texture.texels = domain.image->texels.texels;
      material.base_color = Rgb(1);
      material.base_color_texture = add(std::move(texture), model, domain, true);
    } else {
      add_textures(model, domain, material);
    }
  }
  add_normal_map(model, material);
  return material;
}

}  // namespace relume::pbrt
