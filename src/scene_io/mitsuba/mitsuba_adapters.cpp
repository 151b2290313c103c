// BSDFs that change or join others.
#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "scene_io/mitsuba/mitsuba_surfaces.h"

namespace relume::mitsuba {
namespace {

bool is_one_of(const std::string& type, std::initializer_list<std::string_view> types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

/// A parameter of either material: of `b` if its weight is larger.
template <typename T>
const T& chosen(const T& a, const T& b, float weight) {
  return weight > 0.5f ? b : a;
}

/// Whether the surface reflects as a Lambertian one of uniform colour, of which mixtures are linear in the colour.
bool is_diffuse(const Surface& s) {
  const Material& m = s.material;
  return !s.mixture && !s.blend && !s.color && !s.normals && !s.has_bumps && m.metallic == 0 && m.specular == 0 &&
         m.transmission == 0 && m.clearcoat == 0 && m.diffuse_transmission == 0 && is_black(m.sheen_color);
}

}  // namespace

const Surface& Surfaces::of(const Object& bsdf) {
  if (const auto known = known_.find(&bsdf); known != known_.end()) return known->second;
  const Parameters p(import_, bsdf);
  Surface surface = convert(p);
  surface.material.name = bsdf.id.empty() ? bsdf.type : bsdf.id;
  return known_.emplace(&bsdf, std::move(surface)).first->second;
}

Surface Surfaces::convert(const Parameters& p) {
  const std::string& type = p.object().type;
  if (is_one_of(type, {"dielectric", "roughdielectric", "thindielectric"})) return dielectric(p);
  if (type == "mask") return mask(p);
  if (is_one_of(type, {"bumpmap", "normalmap"})) return bumped(p);
  if (type == "blendbsdf") return blend(p);
  if (type == "twosided") return nested(p);
  Surface surface;
  if (is_one_of(type, {"null", "polarizer", "retarder", "circular"})) {
    surface.is_null = true;
    if (type != "null")
      import_.warnings.add(fmt::format("{} is not supported; it lets all light pass", name_of(p.object())));
    return surface;
  }
  if (is_one_of(type, {"conductor", "roughconductor"})) {
    surface = conductor(p);
  } else if (is_one_of(type, {"plastic", "roughplastic", "pplastic"})) {
    surface = plastic(p);
  } else if (is_one_of(type, {"principled", "principledthin"})) {
    surface = principled(p);
  } else {
    if (type != "diffuse")
      import_.warnings.add(fmt::format("{} is not supported; a diffuse surface replaces it", name_of(p.object())));
    surface = diffuse(p);
  }
  surface.has_black_back = surface.material.transmission == 0 && type != "principledthin";
  return surface;
}

Surface Surfaces::nested(const Parameters& p) {
  const std::vector<const Object*> inner = p.children({"bsdf"});
  if (inner.empty()) p.fail("it contains no BSDF; add one");
  if (inner.size() > 1)
    import_.warnings.add("a 'twosided' with two BSDFs is not supported; the first is on both sides");
  Surface surface = of(*inner[0]);
  surface.is_two_sided = true;
  return surface;
}

Surface Surfaces::mask(const Parameters& p) {
  const std::vector<const Object*> inner = p.children({"bsdf"});
  if (inner.size() != 1) p.fail("it needs one BSDF");
  Surface surface = of(*inner[0]);
  Material& m = surface.material;
  m.alpha *= saturate(read_scalar(p, "opacity", 0.5f, &surface.opacity));
  if (m.alpha < 1 || surface.opacity) m.alpha_mode = AlphaMode::blend;
  if (surface.opacity && surface.color && !same_placement(*surface.color, *surface.opacity)) {
    import_.warnings.add(
        "a 'mask' whose opacity and colour have different to_uv or wrap_mode is not supported; "
        "those of the colour are used");
  }
  return surface;
}

Surface Surfaces::bumped(const Parameters& p) {
  const std::vector<const Object*> inner = p.children({"bsdf"});
  if (inner.size() != 1) p.fail("it needs one BSDF");
  p.ignore({"flip_invalid_normals", "use_shadowing_function"});
  Surface surface = of(*inner[0]);
  const bool is_bump = p.object().type == "bumpmap";
  surface.bump_scale = static_cast<float>(is_bump ? p.number("scale", 1) : 1.0);
  const std::vector<const Object*> textures = p.children({"texture"});
  if (textures.size() != 1) p.fail("it needs one texture");
  std::optional<TextureSource>& map = is_bump ? surface.bumps : surface.normals;
  map = textures_.source(*textures[0]);
  surface.has_bumps = surface.has_bumps || (is_bump && map);
  if (map) {
    if (is_bump) surface.bump_scale *= luminance(map->factor);
    map->factor = Rgb(1);  // larger ones exceed the range of images
  }
  (is_bump ? surface.normals : surface.bumps).reset();
  return surface;
}

Surface mixture(const Surface& a, const Surface& b, float weight) {
  Surface mixed = chosen(a, b, weight);
  Material& m = mixed.material;
  const auto mix = [&](float w, auto Material::*member) {
    m.*member = glm::mix(a.material.*member, b.material.*member, w);
  };
  for (auto member : {&Material::alpha, &Material::metallic, &Material::roughness, &Material::clearcoat,
                      &Material::clearcoat_roughness, &Material::diffuse_transmission})
    mix(weight, member);
  for (auto member : {&Material::base_color, &Material::sheen_color, &Material::diffuse_transmission_color})
    mix(weight, member);
  // What metals lack comes from the other material alone.
  const float dielectric_a = (1 - weight) * (1 - a.material.metallic);
  const float dielectric_b = weight * (1 - b.material.metallic);
  const float sum = dielectric_a + dielectric_b;
  const float dielectric = sum > 0 ? dielectric_b / sum : weight;
  for (auto member : {&Material::ior, &Material::specular, &Material::transmission}) mix(dielectric, member);
  mix(dielectric, &Material::specular_color);
  m.thickness = std::max(a.material.thickness, b.material.thickness);
  return mixed;
}

void Surfaces::blend_textures(const TextureSource& weight, const Surface& a, const Surface& b, Surface& mixed) {
  TexturedBlend blend{.weight = weight, .images = {a.color, b.color}};
  const Surface* ends[] = {&a, &b};
  for (size_t i = 0; i < 2; ++i) {
    const Surface& end = *ends[i];
    blend.colors[i] = end.material.base_color;
    if (blend.images[i] && !same_placement(*blend.images[i], weight)) {
      blend.colors[i] *= textures_.mean(*blend.images[i]);
      blend.images[i].reset();
    }
    float roughness = end.material.roughness;
    if (end.roughness) {
      const float mean = luminance(textures_.mean(*end.roughness));
      roughness *= end.roughness_is_alpha ? safe_sqrt(mean) : mean;
    }
    const float metallic = end.metallic ? luminance(textures_.mean(*end.metallic)) : 1.0f;
    blend.surfaces[i] = Rgb(1, roughness, end.material.metallic * metallic);
  }
  mixed.color.reset();
  mixed.roughness.reset();
  mixed.roughness_v.reset();
  mixed.metallic.reset();
  mixed.material.base_color = Rgb(1);
  mixed.material.roughness = mixed.material.metallic = 1;
  mixed.blend = std::move(blend);
}

Surface Surfaces::blend(const Parameters& p) {
  const std::vector<const Object*> inner = p.children({"bsdf"});
  if (inner.size() != 2) p.fail("it needs two BSDFs");
  std::optional<TextureSource> texture;
  float weight = saturate(read_scalar(p, "weight", 0.5f, &texture));
  const Surface& a = of(*inner[0]);
  const Surface& b = of(*inner[1]);
  if (a.is_null != b.is_null) {
    // The other one, with an opacity.
    Surface surface = a.is_null ? b : a;
    if (texture) weight = luminance(textures_.mean(*texture));
    surface.material.alpha *= a.is_null ? weight : 1 - weight;
    surface.material.alpha_mode = AlphaMode::blend;
    return surface;
  }
  Surface mixed = mixture(a, b, texture ? luminance(textures_.mean(*texture)) : weight);
  mixed.mixture.reset();  // that of the chosen part
  mixed.has_bumps = a.has_bumps || b.has_bumps;
  if (texture) blend_textures(*texture, a, b, mixed);
  if (a.opacity || b.opacity)
    import_.warnings.add("textures of opacity inside a 'blendbsdf' are not supported; they may be left out");
  if (a.uses_vertex_colors != b.uses_vertex_colors || a.is_inverted != b.is_inverted)
    import_.warnings.add(
        "BSDFs of a 'blendbsdf' that differ in vertex colours or in the side of their inside are not supported; "
        "those of the larger weight are used");
  if (mixed.material.alpha < 1) mixed.material.alpha_mode = AlphaMode::blend;
  const auto depth_of = [](const Surface& s) { return s.mixture ? s.mixture->depth : 0; };
  const int depth = 1 + std::max(depth_of(a), depth_of(b));
  if (depth > kMaxMixDepth) {
    import_.warnings.add("more than 16 nested BSDFs of type 'blendbsdf' become one with interpolated parameters");
  } else if (texture || !is_diffuse(a) || !is_diffuse(b)) {
    mixed.mixture = {{&a, &b}, texture ? 1.0f : weight, texture, depth};
    mixed.normals.reset();  // the parts have their own
    mixed.bumps.reset();
  }
  return mixed;
}

}  // namespace relume::mitsuba
