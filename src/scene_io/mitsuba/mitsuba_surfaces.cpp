#include "scene_io/mitsuba/mitsuba_surfaces.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "scene_io/coated_albedo.h"
#include "scene_io/spectra/named_spectra.h"

namespace relume::mitsuba {
namespace {

constexpr float kLargestIor = 1000;  // of Material

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Index of refraction, given as a number or by the name of a substance.
float index_of(const Parameters& p, const std::string& name, const char* otherwise) {
  const Value* value = p.value(name);
  if (value && !std::holds_alternative<std::string>(*value)) {
    const double index = p.number(name, 1);
    if (!(index > 0 && index <= kLargestIor)) p.fail(fmt::format("'{}' of {} is not in (0, 1000]", name, index));
    return static_cast<float>(index);
  }
  const std::string substance = lower(p.text(name, otherwise));
  const std::optional<DielectricIndex> index = dielectric_named(substance);
  if (!index)
    p.fail(fmt::format("'{}' names the unknown substance '{}'; give its index of refraction", name, substance));
  return index->ior;
}

float relative_index(const Parameters& p, const char* inside) {
  return index_of(p, "int_ior", inside) / index_of(p, "ext_ior", "air");
}

float f0_of(float ior) { return sqr((ior - 1) / (ior + 1)); }

/// Reflectance at normal incidence of a metal.
float f0_of(float eta, float k) { return (sqr(eta - 1) + sqr(k)) / (sqr(eta + 1) + sqr(k)); }

/// Colour of the same hue and saturation whose luminance is 1.
Rgb tint_of(const Rgb& color) { return luminance(color) > 0 ? color / luminance(color) : Rgb(1); }

/// Luminance without rounding error for grey.
float scalar_of(const Rgb& color) { return color.r == color.g && color.g == color.b ? color.r : luminance(color); }

MicrofacetModel model_of(const Parameters& p) {
  const std::string name = lower(p.text("distribution", "beckmann"));
  if (name != "beckmann" && name != "ggx") p.fail(fmt::format("its distribution '{}' is not beckmann or ggx", name));
  return name == "ggx" ? MicrofacetModel::ggx : MicrofacetModel::beckmann;
}

bool is_table(const Value& value) {
  const auto* text = std::get_if<SpectrumText>(&value);
  return text && !text->is_constant();
}

/// Spectrum of an index of refraction; of a colour, its red channel.
Spectrum table_of(const Value& value) {
  if (const auto* text = std::get_if<SpectrumText>(&value))
    return text->is_constant() ? constant_spectrum(text->spectrum.values[0]) : text->spectrum;
  return constant_spectrum(color_of(value, SpectrumUse::reflectance).value_or(Rgb(0)).r);
}

}  // namespace

void set_widths(float alpha_u, float alpha_v, Material& material) {
  const float narrow = clamp(std::min(alpha_u, alpha_v), 0, 1);
  const float wide = clamp(std::max(alpha_u, alpha_v), 0, 1);
  material.roughness = std::sqrt(narrow);
  if (wide - narrow < 1e-4f) return;
  // KHR_materials_anisotropy: the width along the direction is mix(α, 1, strength²).
  material.anisotropy = std::sqrt((wide - narrow) / (1 - narrow));
  material.anisotropy_rotation_rad = alpha_u < alpha_v ? kPi / 2 : 0;
  material.microfacet_model = MicrofacetModel::ggx;
}

void Surfaces::read_color(const Parameters& p, const std::string& name, const Rgb& fallback, Surface& surface) {
  surface.material.base_color = fallback;
  const Object* child = p.child(name);
  if (child && child->type == "mesh_attribute") {
    const Parameters attribute(import_, *child);
    const std::string source = attribute.text("name", "");
    if (source == "vertex_color") {
      surface.material.base_color = Rgb(1);
      surface.uses_vertex_colors = true;
    } else {
      import_.warnings.add(fmt::format("the mesh attribute '{}' is not supported; the default replaces it", source));
    }
  } else if (child && !color_of(import_, *child, SpectrumUse::reflectance)) {
    surface.color = textures_.source(*child);
    if (surface.color) surface.material.base_color = Rgb(1);
  } else {
    surface.material.base_color = color_parameter(import_, p, name, fallback, SpectrumUse::reflectance);
  }
  surface.material.base_color = glm::clamp(surface.material.base_color, Rgb(0), Rgb(1));
}

bool Surfaces::is_texture(const Parameters& p, const std::string& name) {
  const Object* child = p.child(name);
  return child && !color_of(import_, *child, SpectrumUse::reflectance);
}

float Surfaces::read_scalar(const Parameters& p, const std::string& name, float fallback,
                            std::optional<TextureSource>* texture) {
  if (is_texture(p, name)) {
    const std::optional<TextureSource> source = textures_.source(*p.child(name));
    if (source && texture) {
      *texture = source;
      return 1;
    }
    if (!source) return fallback;
    import_.warnings.add(
        fmt::format("{}: a texture is not supported as its '{}'; its mean replaces it", name_of(p.object()), name));
    return scalar_of(textures_.mean(*source));
  }
  return scalar_of(color_parameter(import_, p, name, Rgb(fallback), SpectrumUse::reflectance));
}

void Surfaces::read_alpha(const Parameters& p, Surface& surface) {
  p.ignore({"sample_visible"});
  surface.material.microfacet_model = model_of(p);
  if (p.has("alpha_u") || p.has("alpha_v")) {
    const bool has_textures = is_texture(p, "alpha_u") && is_texture(p, "alpha_v");
    const float alpha_u = read_scalar(p, "alpha_u", 0.1f, has_textures ? &surface.roughness : nullptr);
    const float alpha_v = read_scalar(p, "alpha_v", 0.1f, has_textures ? &surface.roughness_v : nullptr);
    set_widths(alpha_u, alpha_v, surface.material);
    if (surface.roughness && surface.roughness_v) {
      surface.material.anisotropy = 1;
      surface.material.microfacet_model = MicrofacetModel::ggx;
    }
    return;
  }
  surface.roughness_is_alpha = true;
  surface.material.roughness = safe_sqrt(saturate(read_scalar(p, "alpha", 0.1f, &surface.roughness)));
}

void Surfaces::read_specular(const Parameters& p, Surface& surface) {
  const Rgb color = color_parameter(import_, p, "specular_reflectance", Rgb(1), SpectrumUse::reflectance);
  const float largest = saturate(max_component(color));
  surface.material.specular = largest;
  if (largest > 0) surface.material.specular_color = glm::min(color / largest, Rgb(1));
}

Surface Surfaces::diffuse(const Parameters& p) {
  Surface s;
  s.material.metallic = 0;
  s.material.specular = 0;
  read_color(p, "reflectance", Rgb(0.5f), s);
  return s;
}

Rgb Surfaces::conductor_reflectance(const Parameters& p) {
  if (const std::string material = p.text("material", "none"); material != "none" && !p.has("eta")) {
    const std::optional<ComplexIndex> index = conductor_named(material);
    if (!index) p.fail(fmt::format("the material '{}' is unknown; give eta and k, or the material 'none'", material));
    return conductor_f0(*index);
  }
  if (p.child("eta") || p.child("k")) {
    const Rgb eta = color_parameter(import_, p, "eta", Rgb(0), SpectrumUse::light);
    const Rgb k = color_parameter(import_, p, "k", Rgb(1), SpectrumUse::light);
    return {f0_of(eta.r, k.r), f0_of(eta.g, k.g), f0_of(eta.b, k.b)};
  }
  const Value eta = p.value("eta") ? *p.value("eta") : Value(0.0);
  const Value k = p.value("k") ? *p.value("k") : Value(1.0);
  if (is_table(eta) || is_table(k)) return conductor_f0({table_of(eta), table_of(k)});
  const Rgb e = color_of(eta, SpectrumUse::reflectance).value_or(Rgb(0));
  const Rgb i = color_of(k, SpectrumUse::reflectance).value_or(Rgb(1));
  return {f0_of(e.r, i.r), f0_of(e.g, i.g), f0_of(e.b, i.b)};
}

Surface Surfaces::conductor(const Parameters& p) {
  Surface s;
  s.material.metallic = 1;
  s.material.roughness = 0;
  if (p.object().type == "roughconductor") read_alpha(p, s);
  read_color(p, "specular_reflectance", Rgb(1), s);
  s.material.base_color *= glm::clamp(conductor_reflectance(p), Rgb(0), Rgb(1));
  return s;
}

Surface Surfaces::dielectric(const Parameters& p) {
  Surface s;
  const bool is_thin = p.object().type == "thindielectric";
  s.material.metallic = 0;
  s.material.roughness = 0;
  s.material.transmission = 1;
  s.material.thickness = is_thin ? 0.0f : 1.0f;  // not 0: it refracts
  if (p.object().type == "roughdielectric") read_alpha(p, s);
  const float index = relative_index(p, "bk7");
  s.is_inverted = index < 1 && !is_thin;
  s.material.ior = std::clamp(std::max(index, 1 / index), 1.0f, kLargestIor);
  if (is_thin) {
    // Light reflected between both sides adds to the reflectance: 2R / (1 + R).
    const float root = std::sqrt(2 * f0_of(s.material.ior) / (1 + f0_of(s.material.ior)));
    s.material.ior = std::min((1 + root) / (1 - root), kLargestIor);
  }
  read_color(p, "specular_transmittance", Rgb(1), s);
  read_specular(p, s);
  return s;
}

Surface Surfaces::plastic(const Parameters& p) {
  Surface s;
  s.material.metallic = 0;
  s.material.roughness = 0;
  if (p.object().type == "roughplastic" || (p.object().type == "pplastic" && p.has("alpha"))) read_alpha(p, s);
  const float index = relative_index(p, "polypropylene");
  s.material.ior = std::clamp(std::max(index, 1 / index), 1.0f, kLargestIor);
  read_color(p, "diffuse_reflectance", Rgb(0.5f), s);
  read_specular(p, s);
  if (p.boolean("nonlinear", false)) {
    const float inner = inner_reflectance(s.material.ior);
    if (s.color) {
      s.color->inner_reflectance = inner;
    } else {
      s.material.base_color = albedo_below_coat(s.material.base_color, inner);
    }
  }
  return s;
}

void Surfaces::read_principled_layers(const Parameters& p, Surface& s) {
  Material& m = s.material;
  const Rgb tint = tint_of(m.base_color);
  m.specular_color = glm::mix(Rgb(1), tint, saturate(read_scalar(p, "spec_tint", 0, nullptr)));
  // A quarter of the energy of a dielectric layer, as in the model of Disney.
  m.clearcoat = 0.25f * saturate(read_scalar(p, "clearcoat", 0, nullptr));
  m.clearcoat_roughness = std::sqrt(lerp(0.1f, 0.001f, saturate(read_scalar(p, "clearcoat_gloss", 0, nullptr))));
  const float sheen = saturate(read_scalar(p, "sheen", 0, nullptr));
  const float sheen_tint = saturate(read_scalar(p, "sheen_tint", 0, nullptr));
  m.sheen_color = glm::clamp(sheen * glm::mix(Rgb(1), tint, sheen_tint), Rgb(0), Rgb(1));
  m.sheen_roughness = 0.5f;
  if (sheen > 0) import_.warnings.add("the sheen of 'principled' becomes that of KHR_materials_sheen, roughness 0.5");
  if (p.has("flatness")) {
    read_scalar(p, "flatness", 0, nullptr);
    import_.warnings.add("the flatness of 'principled' is not supported and is ignored");
  }
}

Surface Surfaces::principled(const Parameters& p) {
  p.ignore({"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate",
            "specular_reflectance_sampling_rate", "specular_transmittance_sampling_rate",
            "diffuse_transmittance_sampling_rate"});
  Surface s;
  Material& m = s.material;
  const bool is_thin = p.object().type == "principledthin";
  read_color(p, "base_color", Rgb(0.5f), s);
  m.metallic = is_thin ? 0.0f : saturate(read_scalar(p, "metallic", 0, &s.metallic));
  m.transmission = saturate(read_scalar(p, "spec_trans", 0, &s.transmission));
  m.thickness = m.transmission > 0 && !is_thin ? 1.0f : 0.0f;
  const float roughness = saturate(read_scalar(p, "roughness", 0.5f, &s.roughness));
  m.roughness = roughness;
  if (const float anisotropic = saturate(read_scalar(p, "anisotropic", 0, nullptr)); anisotropic > 0) {
    const float aspect = std::sqrt(1 - 0.9f * anisotropic);
    if (s.roughness) {
      import_.warnings.add("a 'principled' with a roughness texture is not anisotropic");
    } else {
      set_widths(sqr(roughness) / aspect, sqr(roughness) * aspect, m);
    }
  }
  const auto specular = static_cast<float>(p.number("specular", 0.5));
  const float from_specular = 2 / (1 - std::sqrt(0.08f * saturate(specular))) - 1;
  const float eta = p.has("eta") ? read_scalar(p, "eta", 1.5f, nullptr) : is_thin ? 1.5f : from_specular;
  m.ior = eta > 0 ? std::clamp(std::max(eta, 1 / eta), 1.0f, kLargestIor) : 1.5f;
  // Mitsuba tints each interface by the root of the base colour.
  if (m.transmission == 1 && !s.color && !is_thin) m.base_color = glm::sqrt(m.base_color);
  if (is_thin) {
    m.diffuse_transmission = saturate(read_scalar(p, "diff_trans", 0, nullptr) / 2);
    m.diffuse_transmission_color = m.base_color;
  }
  read_principled_layers(p, s);
  return s;
}

}  // namespace relume::mitsuba
