#include "scene_io/mitsuba/mitsuba_materials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "relume/error.h"

namespace relume::mitsuba {
namespace {

/// The part of a bump map's slope that a material's normal_scale can hold, from 1 to 2. The rest is a power of two
/// along u, and a rounded ratio along v, so that shapes of similar sizes share a texture.
float take_scale(Vec2& slope) {
  const float u = std::fabs(slope.x);
  if (!(u > 1e-30f && u < 1e30f && std::fabs(slope.y) < 1e30f)) return 1;
  constexpr float kRatioSteps = 4096;
  const float unit = std::exp2(std::floor(std::log2(u)));
  slope = Vec2(std::copysign(unit, slope.x), unit * std::round(slope.y / u * kRatioSteps) / kRatioSteps);
  return u / unit;
}

}  // namespace

Emission Materials::emission(const Object& emitter) {
  const Parameters p(import_, emitter);
  p.ignore({"sampling_weight"});
  Emission emission;
  const Object* child = p.child("radiance");
  if (child && !color_of(import_, *child, SpectrumUse::light)) {
    emission.texture = textures_.source(*child);
    emission.radiance = emission.texture ? emission.texture->factor : Rgb(1);
    if (emission.texture) emission.texture->factor = Rgb(1);
  } else {
    emission.radiance = color_parameter(import_, p, "radiance", Rgb(1), SpectrumUse::light);
  }
  return emission;
}

Material Materials::finish(const Surface& surface, const Emission& emission, const Vec2& stretch) {
  Material m = surface.material;
  if (surface.is_null) {
    import_.warnings.add("a lamp with a 'null' BSDF is black apart from its emission, and blocks light");
    m.metallic = 0;
    m.specular = 0;
    m.base_color = Rgb(0);
  }
  m.base_color_texture = textures_.color(surface.color, surface.opacity);
  if (const std::optional<TexturedBlend>& blend = surface.blend) {
    m.base_color_texture = textures_.mixed_color(blend->weight, blend->images, blend->colors);
    m.metallic_roughness_texture = textures_.mixed_surface(blend->weight, blend->surfaces);
  } else if (surface.roughness && surface.roughness_v) {
    m.metallic_roughness_texture = textures_.narrow_widths(*surface.roughness, *surface.roughness_v);
    m.anisotropy_texture = textures_.anisotropy(*surface.roughness, *surface.roughness_v);
  } else {
    m.metallic_roughness_texture = textures_.surface(surface.roughness, surface.roughness_is_alpha, surface.metallic);
  }
  if (surface.transmission) m.transmission_texture = textures_.scalar(*surface.transmission);
  if (surface.normals) m.normal_texture = textures_.normals(*surface.normals);
  if (surface.bumps) {
    const TextureRef& placement = surface.bumps->placement;
    if (placement.rotation_rad != 0)
      import_.warnings.add("a bump map whose to_uv rotates is not supported; its bumps are rotated");
    Vec2 slope = surface.bump_scale * placement.scale / stretch;
    m.normal_scale = take_scale(slope);
    m.normal_texture = textures_.bumps(*surface.bumps, slope);
  }
  if (surface.mixture) {
    const Mixture& mixture = *surface.mixture;
    m.mix_first = find(*mixture.parts[0], {}, nullptr, stretch);
    m.mix_second = find(*mixture.parts[1], {}, nullptr, stretch);
    m.mix_share = mixture.share;
    if (mixture.weight) m.mix_texture = textures_.scalar(*mixture.weight);
  }
  m.emission = emission.radiance;
  if (emission.texture) m.emission_texture = textures_.color(emission.texture);
  return m;
}

Index Materials::find(const Surface& surface, const Emission& emission, const Object* emitter, const Vec2& stretch) {
  const Vec2 relevant = surface.has_bumps ? stretch : Vec2(1);
  const std::tuple key{&surface, emitter, relevant.x, relevant.y};
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  constexpr size_t kMaxMaterials = size_t{1} << 17;
  if (import_.scene.materials.size() >= kMaxMaterials)
    throw Error(fmt::format("{}: the scene has more than {} materials; let shapes refer to common BSDFs",
                            import_.document.files[0], kMaxMaterials));
  const size_t index = import_.scene.materials.size();
  known_[key] = static_cast<Index>(index);
  import_.scene.materials.emplace_back();  // the parts of a mixture follow
  Material made = finish(surface, emission, stretch);
  import_.scene.materials[index] = std::move(made);
  return static_cast<Index>(index);
}

}  // namespace relume::mitsuba
