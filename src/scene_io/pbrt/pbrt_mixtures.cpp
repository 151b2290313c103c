// Mixtures of materials.
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/vec.h"
#include "scene_io/pbrt/pbrt_materials.h"

namespace relume::pbrt {
namespace {

constexpr int kMaxNesting = 8;

/// Whether the surface reflects as a Lambertian one, of which mixtures are linear in the colour.
bool is_diffuse(const Surface& s) {
  return s.metallic == 0 && s.specular == 0 && s.transmission == 0 && s.clearcoat == 0 && s.diffuse_transmission == 0;
}

}  // namespace

Index Materials::part(const MaterialEntity& entity, const Look& look, int depth) {
  const std::string key = fmt::format("part {} {}", static_cast<const void*>(&entity), look.inside_medium);
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const Index index = reserve(key);
  Material made = make(entity, look, index, depth);
  scene_.materials[static_cast<size_t>(index)] = std::move(made);
  return index;
}

/// Makes a mixture of the material, which holds the means of its parts.
void Materials::add_parts(const MaterialEntity& entity, const Look& look, const TextureNode& amount, int depth,
                          Material& material) {
  const std::vector<std::string> names = entity.parameters.strings("materials");
  SurfaceModel share;
  share.at = [&amount](const Vec2& uv) { return Surface{.clearcoat = saturate(value_at(amount, uv).x)}; };
  share.nodes = {&amount};
  const Material baked = baker_.bake(share);  // a linear texture
  material.mix_share = baked.clearcoat;
  material.mix_texture = baked.clearcoat_texture;
  material.mix_first = part(named(names[0], entity.parameters.where()), look, depth + 1);
  material.mix_second = part(named(names[1], entity.parameters.where()), look, depth + 1);
}

SurfaceModel Materials::mix(const Parameters& parameters, int depth) {
  const std::vector<std::string> names = parameters.strings("materials");
  if (names.size() != 2) fail(parameters.where(), "a mix has two names in 'string materials'; give both");
  if (depth >= kMaxNesting)
    fail(parameters.where(), fmt::format("more than {} mixed materials are nested; simplify them", kMaxNesting));
  std::array<SurfaceModel, 2> parts;
  for (size_t i = 0; i < 2; ++i) parts[i] = model(named(names[i], parameters.where()), depth + 1);
  const TextureNode* given = textures_.number(parameters, "amount");
  const TextureNode* amount = given ? given : textures_.constant(Rgb(0.5f));
  const Surface a = parts[0].at(Vec2(0.5f));
  const Surface b = parts[1].at(Vec2(0.5f));
  const bool is_glassy = a.transmission > 0 || a.clearcoat > 0;
  SurfaceModel model;
  const size_t mapped = parts[0].normal_map.empty() ? 1 : 0;
  model.normal_map = parts[mapped].normal_map;
  model.where = parts[mapped].where;
  model.uniform = is_glassy || b.metallic < a.metallic ? parts[0].uniform : parts[1].uniform;
  for (const SurfaceModel& part : parts) model.nodes.insert(model.nodes.end(), part.nodes.begin(), part.nodes.end());
  model.nodes.push_back(amount);
  const bool is_metal_over_base = a.metallic != b.metallic && a.transmission == 0 && b.transmission == 0;
  const bool is_metalness = is_metal_over_base && have_equal_colors(parts[0], parts[1]);
  const bool has_mixture = parts[0].amount || parts[1].amount;
  if (has_mixture || (!is_metalness && !(is_diffuse(a) && is_diffuse(b)))) {
    model.amount = amount;
    model.normal_map.clear();  // the parts have their own
  }
  if (is_metal_over_base && !is_metalness) {
    const size_t metal = a.metallic > b.metallic ? 0 : 1;
    const float base_f0 = sqr((parts[1 - metal].uniform.ior - 1) / (parts[1 - metal].uniform.ior + 1));
    model.uniform.ior = kMixedIndex;
    model.at = [over = parts[metal].at, base = parts[1 - metal].at, metal, base_f0, amount](const Vec2& uv) {
      const float second = saturate(value_at(*amount, uv).x);
      return covered(base(uv), base_f0, over(uv), metal == 1 ? second : 1 - second);
    };
    return model;
  }
  const size_t base = a.metallic > b.metallic ? 1 : 0;
  if (is_metal_over_base) model.uniform.ior = parts[base].uniform.ior;
  model.at = [first = parts[0].at, second = parts[1].at, amount, is_metal_over_base, base](const Vec2& uv) {
    const Surface p = first(uv), q = second(uv);
    Surface result = mixed(p, q, value_at(*amount, uv).x);
    if (is_metal_over_base) result.specular = base == 0 ? p.specular : q.specular;  // of the base alone
    return result;
  };
  return model;
}

}  // namespace relume::pbrt
