#include "scene_io/pbrt/pbrt_materials.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "core/vec.h"
#include "scene_io/coated_albedo.h"

namespace relume::pbrt {
namespace {

constexpr Rgb kLuminance(0.2126f, 0.7152f, 0.0722f);

Rgb largest(const TextureNode& node) {
  constexpr int kSamples = 64;
  if (node.is_constant()) return node.value;
  Rgb result(0);
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const Vec2 uv((static_cast<float>(i % kSamples) + 0.5f) / kSamples,
                  (static_cast<float>(i / kSamples) + 0.5f) / kSamples);
    result = glm::max(result, value_at(node, uv));
  }
  return result;
}

Rgb in_range(const Rgb& color) { return glm::clamp(color, Rgb(0), Rgb(1)); }

}  // namespace

const MaterialEntity& Materials::entity_of(const Look& look) const {
  return look.material_name.empty() ? *look.material : named(look.material_name, look.where);
}

const MaterialEntity& Materials::named(const std::string& name, const Location& where) const {
  const auto material = description_.materials.find(name);
  if (material == description_.materials.end())
    fail(where, fmt::format("there is no material '{}'; define it with MakeNamedMaterial", name));
  return *material->second;
}

Index Materials::of(const Look& look, float area, size_t faces) {
  const MaterialEntity& entity = entity_of(look);
  const bool has_power = look.area_light && look.area_light->parameters.number("power", -1) > 0;
  const std::string key = fmt::format(
      "{} {} {} {} {} {}", static_cast<const void*>(&entity), static_cast<const void*>(look.area_light.get()),
      look.inside_medium, look.alpha_texture, look.alpha, has_power ? fmt::format("{} {}", area, faces) : "");
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  const bool is_interface = entity.kind == "interface" || entity.kind == "none" || entity.kind.empty();
  if (is_interface) {
    if (look.area_light) warnings_.add("area lights with the material 'interface' are ignored, as in pbrt");
    if (!look.inside_medium.empty())
      warnings_.add("media without a dielectric boundary are not supported; they are left out");
    return known_[key] = kNone;
  }
  const Index index = reserve(key);
  Material material = make(entity, look, index, 0);
  if (look.area_light && look.alpha_texture.empty() && look.alpha <= 0)
    warnings_.add("invisible area lights, with alpha 0, are not supported; they do not emit");
  if (look.area_light) add_emission(*look.area_light, area, faces, material);
  scene_.materials[static_cast<size_t>(index)] = std::move(material);
  return index;
}

/// Adds an empty material, which the parts of a mixture follow.
Index Materials::reserve(const std::string& key) {
  scene_.materials.emplace_back();
  return known_[key] = static_cast<Index>(scene_.materials.size()) - 1;
}

/// A material without emission. Parts of mixtures (depth > 0) have no alpha: the mixture has it.
Material Materials::make(const MaterialEntity& entity, const Look& look, Index index, int depth) {
  SurfaceModel made = model(entity, depth);
  entity.parameters.warn_of_unused(fmt::format("material '{}'", entity.kind), warnings_);
  if (depth == 0) add_alpha(look, made);
  made.uniform.name = entity.name.empty() ? fmt::format("{} {}", entity.kind, index) : entity.name;
  Material material = baker_.bake(made);
  material.double_sided = true;
  const bool is_volume = material.thickness > 0 && material.transmission > 0;
  const bool expects_volume = depth == 0 && !made.amount;  // mixtures may have one part of glass
  if (!look.inside_medium.empty() && (is_volume || expects_volume)) add_medium(look.inside_medium, material);
  if (made.amount) add_parts(entity, look, *made.amount, depth, material);
  return material;
}

SurfaceModel Materials::model(const MaterialEntity& entity, int depth) {
  using Make = SurfaceModel (Materials::*)(const Parameters&);
  static const std::map<std::string_view, Make> kKinds = {{"diffuse", &Materials::diffuse},
                                                          {"conductor", &Materials::conductor},
                                                          {"coateddiffuse", &Materials::coated_diffuse},
                                                          {"coatedconductor", &Materials::coated_conductor},
                                                          {"dielectric", &Materials::dielectric},
                                                          {"thindielectric", &Materials::thin_dielectric},
                                                          {"diffusetransmission", &Materials::diffuse_transmission},
                                                          {"subsurface", &Materials::subsurface}};
  const Parameters& p = entity.parameters;
  const auto kind = kKinds.find(entity.kind);
  SurfaceModel result;
  if (entity.kind == "mix") {
    result = mix(p, depth);
  } else if (kind != kKinds.end()) {
    result = (this->*kind->second)(p);
  } else {
    warnings_.add(fmt::format("materials of type '{}' are not supported; grey diffuse ones replace them", entity.kind));
    result = diffuse({});
  }
  if (p.find("displacement", {"texture", "float"}))
    warnings_.add("displacement is not supported; surfaces keep their shape");
  if (entity.kind == "mix") return result;
  result.normal_map = p.string("normalmap");
  result.where = p.where();
  return result;
}

const TextureNode* Materials::color_or(const Parameters& parameters, std::string_view name, float otherwise) {
  const TextureNode* node = textures_.color(parameters, name);
  return node ? node : textures_.constant(Rgb(otherwise));
}

std::function<float(const Vec2&)> Materials::roughness(const Parameters& parameters, const std::string& prefix,
                                                       SurfaceModel& model) {
  const bool remap = parameters.boolean("remaproughness", true);
  const TextureNode* both = textures_.number(parameters, prefix + "roughness");
  const TextureNode* u = textures_.number(parameters, prefix + "uroughness");
  const TextureNode* v = textures_.number(parameters, prefix + "vroughness");
  if (!both) both = textures_.constant(Rgb(0));
  if (!u) u = both;
  if (!v) v = both;
  if (u->is_constant() && v->is_constant()) {
    const float alpha_u = sqr(perceptual_roughness(u->value.x, remap));
    const float alpha_v = sqr(perceptual_roughness(v->value.x, remap));
    const float base = set_anisotropy(alpha_u, alpha_v, model.uniform);
    return [base](const Vec2&) { return base; };
  }
  if (u != v) warnings_.add("textures of uroughness and vroughness are not supported; their mean is used");
  model.nodes.insert(model.nodes.end(), {u, v});
  return [u, v, remap](const Vec2& uv) {
    return perceptual_roughness((value_at(*u, uv).x + value_at(*v, uv).x) / 2, remap);
  };
}

SurfaceModel Materials::diffuse(const Parameters& parameters) {
  SurfaceModel model;
  const TextureNode* color = color_or(parameters, "reflectance", 0.5f);
  model.nodes = {color};
  model.plain_color = color;
  model.at = [color](const Vec2& uv) {
    Surface s;
    s.base_color = in_range(value_at(*color, uv));
    s.roughness = 1;
    s.specular = 0;
    return s;
  };
  return model;
}

std::function<Rgb(const Vec2&)> Materials::metal_color(const Parameters& parameters, const std::string& prefix,
                                                       float outside, SurfaceModel& model) {
  if (const TextureNode* color = textures_.color(parameters, "reflectance")) {
    model.nodes.push_back(color);
    if (outside == 1) return [color](const Vec2& uv) { return in_range(value_at(*color, uv)); };
    return [color, outside](const Vec2& uv) { return reflectance_in_coat(in_range(value_at(*color, uv)), outside); };
  }
  if (parameters.find(prefix + "eta", {"texture"}) || parameters.find(prefix + "k", {"texture"}))
    warnings_.add("textures of a conductor's index are not supported; that of copper is used");
  const ComplexIndex copper = *conductor_named("Cu");
  const IndexValue eta = colors_.index(parameters, prefix + "eta").value_or(IndexValue{copper.eta, {}});
  const IndexValue k = colors_.index(parameters, prefix + "k").value_or(IndexValue{copper.k, {}});
  const Rgb f0 = in_range(conductor_reflectance(eta, k, outside));
  return [f0](const Vec2&) { return f0; };
}

SurfaceModel Materials::conductor(const Parameters& parameters) {
  SurfaceModel model;
  const auto color = metal_color(parameters, "", 1, model);
  const auto rough = roughness(parameters, "", model);
  model.at = [color, rough](const Vec2& uv) {
    Surface s;
    s.base_color = color(uv);
    s.metallic = 1;
    s.roughness = rough(uv);
    return s;
  };
  return model;
}

SurfaceModel Materials::coated_diffuse(const Parameters& parameters) {
  SurfaceModel model;
  const TextureNode* color = color_or(parameters, "reflectance", 0.5f);
  model.nodes = {color};
  const DielectricIndex index = colors_.dielectric(parameters, "eta");
  model.uniform.ior = index.ior;
  const auto rough = roughness(parameters, "", model);
  const float inner = inner_reflectance(index.ior);
  if (const auto albedo = textures_.color(parameters, "albedo"); albedo && max_component(largest(*albedo)) > 0)
    warnings_.add("media in the coats of materials are not supported; the coats are clear");
  for (const char* ignored : {"thickness", "g"}) textures_.number(parameters, ignored);
  for (const char* ignored : {"maxdepth", "nsamples"}) parameters.integer(ignored, 0);
  model.at = [color, rough, inner](const Vec2& uv) {
    Surface s;
    s.base_color = albedo_below_coat(in_range(value_at(*color, uv)), inner);
    s.roughness = rough(uv);
    return s;
  };
  return model;
}

SurfaceModel Materials::coated_conductor(const Parameters& parameters) {
  SurfaceModel model;
  const DielectricIndex index = colors_.dielectric(parameters, "interface.eta");
  if (std::fabs(index.ior - 1.5f) > 0.05f)
    warnings_.add(fmt::format("coats of conductors have the index 1.5 instead of {}", index.ior));
  SurfaceModel coat;  // whose anisotropy is not supported
  const auto coat_rough = roughness(parameters, "interface.", coat);
  model.nodes = coat.nodes;
  const auto color = metal_color(parameters, "conductor.", index.ior, model);
  const auto rough = roughness(parameters, "conductor.", model);
  for (const char* ignored : {"thickness", "g"}) textures_.number(parameters, ignored);
  for (const char* ignored : {"maxdepth", "nsamples"}) parameters.integer(ignored, 0);
  model.at = [color, rough, coat_rough](const Vec2& uv) {
    Surface s;
    s.base_color = color(uv);
    s.metallic = 1;
    s.roughness = rough(uv);
    s.clearcoat = 1;
    s.clearcoat_roughness = coat_rough(uv);
    return s;
  };
  return model;
}

SurfaceModel Materials::dielectric(const Parameters& parameters) {
  SurfaceModel model;
  const DielectricIndex index = colors_.dielectric(parameters, "eta");
  model.uniform.ior = index.ior;
  model.uniform.dispersion = index.dispersion;
  model.uniform.thickness = 1;
  const auto rough = roughness(parameters, "", model);
  model.at = [rough](const Vec2& uv) {
    Surface s;
    s.transmission = 1;
    s.roughness = rough(uv);
    return s;
  };
  return model;
}

SurfaceModel Materials::thin_dielectric(const Parameters& parameters) {
  SurfaceModel model;
  model.uniform.ior = thin_wall_index(std::min(colors_.dielectric(parameters, "eta").ior, 40.0f));
  model.at = [](const Vec2&) {
    Surface s;
    s.transmission = 1;
    return s;
  };
  return model;
}

SurfaceModel Materials::diffuse_transmission(const Parameters& parameters) {
  SurfaceModel model;
  const TextureNode* reflected = color_or(parameters, "reflectance", 0.25f);
  const TextureNode* passed = color_or(parameters, "transmittance", 0.25f);
  const float scale = std::clamp(parameters.number("scale", 1), 0.0f, 1e6f);
  const float reflectance = max_component(largest(*reflected));
  const float transmittance = max_component(largest(*passed));
  const float sum = reflectance + transmittance;
  const float share = sum > 0 ? std::clamp(transmittance / sum, 0.001f, 0.999f) : 0.5f;
  if (scale * sum > 1.001f)
    warnings_.add(
        "a diffuse transmission's largest reflectance and transmittance sum to more than 1; both are limited");
  model.nodes = {reflected, passed};
  model.at = [=](const Vec2& uv) {
    Surface s;
    s.base_color = in_range(value_at(*reflected, uv) * scale / (1 - share));
    s.roughness = 1;
    s.specular = 0;
    s.diffuse_transmission = share;
    s.diffuse_transmission_color = in_range(value_at(*passed, uv) * scale / share);
    return s;
  };
  return model;
}

SurfaceModel Materials::subsurface(const Parameters& parameters) {
  warnings_.add("subsurface scattering is not supported; a coated diffuse material replaces it");
  return coated_diffuse(parameters);
}

void Materials::add_alpha(const Look& look, SurfaceModel& model) {
  if (look.alpha_texture.empty() && look.alpha >= 1) return;
  const TextureNode* alpha = look.alpha_texture.empty() ? textures_.constant(Rgb(look.alpha))
                                                        : textures_.float_texture(look.alpha_texture, look.where);
  model.uniform.alpha_mode = AlphaMode::blend;
  model.plain_color = nullptr;
  model.nodes.push_back(alpha);
  model.at = [inner = std::move(model.at), alpha](const Vec2& uv) {
    Surface s = inner(uv);
    s.alpha = saturate(value_at(*alpha, uv).x);
    return s;
  };
}

void Materials::add_medium(const std::string& name, Material& material) {
  const auto medium = description_.media.find(name);
  const bool is_volume = material.thickness > 0 && material.transmission > 0;
  if (medium == description_.media.end() || medium->second.kind != "homogeneous" || !is_volume) {
    warnings_.add("only homogeneous media inside dielectrics are supported; other media are left out");
    return;
  }
  const Parameters& p = medium->second.parameters;
  if (!p.string("preset").empty()) warnings_.add("presets of media are not supported; the default absorption is used");
  const Rgb absorption = colors_.coefficient(p, "sigma_a").value_or(Rgb(1)) * std::max(p.number("scale", 1), 0.0f);
  const Rgb scattering = colors_.coefficient(p, "sigma_s").value_or(Rgb(1));
  if (max_component(scattering) > 0) warnings_.add("media do not scatter; only their absorption is used");
  p.number("g", 0);
  p.warn_of_unused("medium 'homogeneous'", warnings_);
  if (const float most = max_component(absorption); most > 0 && is_finite(most)) {
    material.attenuation_distance = std::min(1 / most, 1e9f);
    material.attenuation_color = glm::exp(-absorption * material.attenuation_distance);
  }
}

void Materials::add_emission(const AreaLightEntity& light, float area, size_t faces, Material& material) {
  const Parameters& p = light.parameters;
  if (light.kind != "diffuse") fail(p.where(), fmt::format("there is no area light '{}'; use diffuse", light.kind));
  material.double_sided = p.boolean("twosided", false);
  Rgb radiance = colors_.light(p, "L").value_or(Rgb(1)) * std::max(p.number("scale", 1), 0.0f);
  float mean = 1;
  if (const std::string name = p.string("filename"); !name.empty()) {
    const std::optional<Image> image = images_.read_light(name, p.where());
    if (image) {
      Texture texture;
      texture.name = name;
      texture.width = image->width;
      texture.height = image->height;
      texture.format = PixelFormat::rgba32_float;
      texture.wrap_u = texture.wrap_v = WrapMode::clamp;
      double sum = 0;
      for (const Rgb& pixel : image->pixels) {
        const Vec4 texel(pixel, 1);
        const auto* bytes = reinterpret_cast<const std::byte*>(&texel);
        texture.texels.insert(texture.texels.end(), bytes, bytes + sizeof texel);
        sum += static_cast<double>(glm::dot(pixel, kLuminance));
      }
      mean = static_cast<float>(sum / static_cast<double>(image->pixels.size()));
      material.emission_texture.texture = static_cast<Index>(scene_.textures.size());
      scene_.textures.push_back(std::move(texture));
    }
  }
  if (const float power = p.number("power", -1); power > 0 && area > 0 && mean > 0)
    radiance *= power * static_cast<float>(faces) / (kPi * area * mean * (material.double_sided ? 2.0f : 1.0f));
  for (int c = 0; c < 3; ++c) material.emission[c] = radiance[c] > 0 ? std::min(radiance[c], kMaxRadiance) : 0.0f;
}

}  // namespace relume::pbrt
