// Every kind of lobe and of material, as data for contract tests.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "materials/make_layered_bsdf.h"

namespace relume::testing {

struct BsdfCase {
  std::string name;
  float alpha = 1;  ///< of the narrowest lobe
  float eta = 1;    ///< index ratio of transmission, seen from the front
  /// Builds the BSDF for a viewer at `cos_theta_o` > 0 in front of or behind the surface.
  std::function<Bsdf(float cos_theta_o, bool front_face)> make;
};

inline std::string to_string(MicrofacetModel model) { return model == MicrofacetModel::ggx ? "ggx" : "beckmann"; }

inline Lobe make_lobe(LobeKind kind, const Microfacet& microfacet, const Interface& interface) {
  Lobe lobe{};
  lobe.kind = kind;
  lobe.film = FilmBase::none;
  lobe.anisotropic = false;
  lobe.model = microfacet.model;
  lobe.alpha = microfacet.alpha;
  lobe.color = kind == LobeKind::reflection ? interface.f0 : Rgb(0.9f, 0.6f, 0.3f);
  lobe.f90 = interface.f90;
  lobe.weight = 1;
  return lobe;
}

/// A BSDF with a single lobe.
inline BsdfCase single_lobe(LobeKind kind, const std::string& name, float roughness, MicrofacetModel model,
                            float eta = 1) {
  const Microfacet microfacet{model, roughness * roughness};
  return {name + ", r " + std::to_string(roughness).substr(0, 4) + ", " + to_string(model),
          is_glossy(kind) ? microfacet.alpha : 1.0f, eta, [=](float cos_theta_o, bool front_face) {
            Bsdf bsdf{};
            bsdf.tables = &layered_energy_tables();
            bsdf.layered = true;
            bsdf.interface = {Rgb(0.04f, 0.5f, 0.9f), 1.0f, front_face ? eta : 1.0f / eta};
            bsdf.lobes[bsdf.lobe_count++] = make_lobe(kind, microfacet, bsdf.interface);
            prepare(bsdf, cos_theta_o);
            return bsdf;
          }};
}

/// Every kind of non-delta lobe, with both microfacet models.
inline std::vector<BsdfCase> lobe_cases(const std::vector<float>& roughnesses) {
  std::vector<BsdfCase> cases;
  for (int k = 0; k < kLobeKindCount; ++k) {
    const auto kind = static_cast<LobeKind>(k);
    for (const float r : roughnesses) {
      for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann}) {
        switch (kind) {
          case LobeKind::lambert: cases.push_back(single_lobe(kind, "lambert", 1, model)); break;
          case LobeKind::covered_lambert: cases.push_back(single_lobe(kind, "covered lambert", r, model)); break;
          case LobeKind::reflection: cases.push_back(single_lobe(kind, "reflection", r, model)); break;
          case LobeKind::multiple_reflection:
            cases.push_back(single_lobe(kind, "multiple reflection", r, model));
            break;
          case LobeKind::dielectric:
            cases.push_back(single_lobe(kind, "dielectric, outside", r, model, 1.5f));
            cases.push_back(single_lobe(kind, "dielectric, inside", r, model, 1.0f / 1.5f));
            break;
          case LobeKind::thin_transmission: cases.push_back(single_lobe(kind, "thin transmission", r, model)); break;
          case LobeKind::sheen: cases.push_back(single_lobe(kind, "sheen", r, model)); break;
          case LobeKind::diffuse_transmission:
            cases.push_back(single_lobe(kind, "diffuse transmission", r, model));
            break;
          case LobeKind::specular_reflection:
          case LobeKind::smooth_dielectric:
          case LobeKind::null: break;  // delta: tested separately
        }
      }
    }
  }
  return cases;
}

/// Parameters of a material without textures.
struct MaterialCase {
  std::string name;
  MaterialSample sample;
  bool volume = false;
  float ior = 1.5f;
  std::optional<LayerSample> layers = {};
  float dispersion = 0;
  float wavelength_nm = kNoWavelength;
};

inline BsdfCase full_material(const MaterialCase& m, float roughness, MicrofacetModel model) {
  MaterialSample sample = m.sample;
  sample.roughness = roughness;
  sample.ior = index_at(m.ior, m.dispersion, m.wavelength_nm);
  MaterialData data;
  data.volume = m.volume;
  data.ior = m.ior;
  data.microfacet_model = model;
  float alpha = roughness * roughness;
  if (sample.clearcoat > 0.0f && sample.clearcoat_roughness > 0.1f)
    alpha = std::fmin(alpha, sqr(sample.clearcoat_roughness));
  return {m.name + ", r " + std::to_string(roughness).substr(0, 4) + ", " + to_string(model), alpha,
          m.volume ? sample.ior : 1.0f, [=](float cos_theta_o, bool front_face) {
            Bsdf bsdf{};
            if (m.layers) {
              make_layered_bsdf(bsdf, sample, *m.layers, data, layered_energy_tables(), cos_theta_o, front_face);
            } else {
              make_bsdf(bsdf, sample, data, energy_tables(), cos_theta_o, front_face);
            }
            return bsdf;
          }};
}

/// Dispersive glasses at both ends of the range of wavelengths.
inline void add_dispersive(std::vector<MaterialCase>& list) {
  constexpr float kFlint = 20.0f / 30.0f;
  MaterialSample clear;
  clear.metallic = 0;
  clear.transmission = 1;
  list.push_back({"violet in glass", clear, true, 1.7f, {}, kFlint, kShortestWavelength});
  list.push_back({"red in glass", clear, true, 1.7f, {}, kFlint, kLongestWavelength});
  list.push_back({"red at Abbe number 1", clear, true, 1.7f, {}, 20, kLongestWavelength});
}

/// Materials of glTF: metals, plastics, glass, walls, coats, and mixtures.
inline std::vector<MaterialCase> material_list() {
  const Rgb gold(1.0f, 0.77f, 0.34f);
  const Rgb blue(0.2f, 0.4f, 0.9f);
  const auto sample = [](const Rgb& color, float metallic, float transmission) {
    MaterialSample s;
    s.base_color = color;
    s.metallic = metallic;
    s.transmission = transmission;
    return s;
  };
  std::vector<MaterialCase> list{{"metal", sample(gold, 1, 0)},
                                 {"plastic", sample(blue, 0, 0)},
                                 {"half metal", sample(gold, 0.5f, 0)},
                                 {"glass", sample(Rgb(1), 0, 1), true},
                                 {"tinted glass", sample(blue, 0, 1), true, 1.8f},
                                 {"milky glass", sample(blue, 0, 0.5f), true},
                                 {"thin wall", sample(blue, 0, 1)},
                                 {"half thin wall", sample(gold, 0.2f, 0.6f)}};
  MaterialCase diffuse{"diffuse", sample(blue, 0, 0)};
  diffuse.sample.specular = 0;
  MaterialCase tinted{"tinted specular", sample(blue, 0, 0)};
  tinted.sample.specular = 0.7f;
  tinted.sample.specular_color = gold;
  const size_t bare = list.size();
  for (size_t i = 0; i < bare; ++i) {
    MaterialCase coated = list[i];
    coated.name = "coated " + coated.name;
    coated.sample.clearcoat = i % 2 ? 1.0f : 0.6f;
    coated.sample.clearcoat_roughness = i % 3 ? 0.2f : 0.0f;
    list.push_back(coated);
  }
  MaterialCase gilded{"gilded glass", sample(Rgb(1), 0, 1), true};
  gilded.sample.specular = 0.5f;
  gilded.sample.specular_color = Rgb(20, 15, 7);
  list.push_back(diffuse);
  list.push_back(tinted);
  list.push_back(gilded);
  list.push_back({"air", sample(blue, 0, 1), true, 1.0f});
  add_dispersive(list);
  return list;
}

using LayerChange = std::function<void(MaterialCase&, LayerSample&)>;

/// Adds a layer to the material named `base`.
inline void add_layered(std::vector<MaterialCase>& list, const std::string& base, const std::string& name,
                        const LayerChange& change) {
  for (MaterialCase m : material_list()) {
    if (m.name != base) continue;
    m.name = name + " " + base;
    m.layers.emplace();
    change(m, *m.layers);
    list.push_back(std::move(m));
  }
}

inline LayerChange film(float weight, float ior, float thickness_nm) {
  return [=](MaterialCase&, LayerSample& l) {
    l.iridescence = weight;
    l.iridescence_ior = ior;
    l.iridescence_thickness_nm = thickness_nm;
  };
}

inline void add_iridescent(std::vector<MaterialCase>& list) {
  for (const char* base : {"metal", "plastic", "glass", "thin wall", "half metal", "tinted glass"})
    add_layered(list, base, "iridescent", film(0.8f, 1.3f, 350));
  add_layered(list, "plastic", "very thin film,", film(1, 1.3f, 80));
  add_layered(list, "plastic", "thick film,", film(1, 1.3f, 960));
  add_layered(list, "tinted specular", "dense film,", film(1, 2.2f, 250));
}

/// Materials with the layers of make_layered_bsdf.h, each alone and several combined.
inline std::vector<MaterialCase> layered_material_list() {
  std::vector<MaterialCase> list;
  const auto add = [&](const std::string& base, const std::string& name, const LayerChange& change) {
    add_layered(list, base, name, change);
  };
  const auto anisotropic = [](float strength, const Vec2& direction) {
    return [=](MaterialCase&, LayerSample& l) {
      l.anisotropy = strength;
      l.anisotropy_direction = direction;
    };
  };
  add("metal", "anisotropic", anisotropic(0.7f, {0.6f, 0.8f}));
  add("half metal", "slightly anisotropic", anisotropic(0.3f, {1, 0}));
  add("coated plastic", "anisotropic", anisotropic(1.0f, {-0.8f, 0.6f}));
  const auto velvet = [](MaterialCase&, LayerSample& l) {
    l.sheen_color = Rgb(0.9f, 0.5f, 0.2f);
    l.sheen_roughness = 0.6f;
  };
  for (const char* base : {"plastic", "coated plastic", "half thin wall"}) add(base, "velvet", velvet);
  add("diffuse", "velvet of thin fibres on", [&](MaterialCase& m, LayerSample& l) {
    velvet(m, l);
    l.sheen_roughness = 0.1f;
  });
  add_iridescent(list);
  add("metal", "anisotropic iridescent", [&](MaterialCase& m, LayerSample& l) {
    film(0.8f, 1.3f, 350)(m, l);
    anisotropic(0.5f, {0, 1})(m, l);
  });
  const auto diffuse_transmission = [](MaterialCase&, LayerSample& l) {
    l.diffuse_transmission = 0.4f;
    l.diffuse_transmission_color = Rgb(0.3f, 0.9f, 0.1f);
  };
  for (const char* base : {"plastic", "diffuse", "half thin wall", "milky glass"})
    add(base, "diffusely transmitting", diffuse_transmission);
  add("diffuse", "medium below", [&](MaterialCase& m, LayerSample& l) {
    diffuse_transmission(m, l);
    m.volume = true;
  });
  const auto own_coat_normal = [](MaterialCase&, LayerSample& l) {
    l.coat_has_normal = true;
    l.coat_normal = glm::normalize(Vec3(0.2f, -0.1f, 1));
  };
  for (const char* base : {"coated metal", "coated plastic", "coated glass"})
    add(base, "own coat normal,", own_coat_normal);
  add("coated plastic", "layered", [&](MaterialCase& m, LayerSample& l) {
    for (const auto& change :
         std::vector<LayerChange>{velvet, film(0.8f, 1.3f, 350), diffuse_transmission, own_coat_normal})
      change(m, l);
  });
  return list;
}

inline std::vector<BsdfCase> material_cases(const std::vector<float>& roughnesses) {
  std::vector<BsdfCase> cases;
  for (const MaterialCase& m : material_list()) {
    for (const float r : roughnesses) {
      for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann})
        cases.push_back(full_material(m, r, model));
    }
  }
  for (const MaterialCase& m : layered_material_list()) {
    constexpr float kSmoothestAnisotropic = 0.15f;  // narrower highlights exceed the accuracy of the quadrature
    for (const float r : roughnesses) {
      const bool anisotropic = m.layers->anisotropy > 0.0f;
      cases.push_back(full_material(m, anisotropic ? std::fmax(r, kSmoothestAnisotropic) : r, MicrofacetModel::ggx));
    }
  }
  return cases;
}

/// Unit direction away from all axes.
inline Vec3 viewer(float cos_theta) {
  const float s = safe_sqrt(1.0f - cos_theta * cos_theta);
  return {s * std::cos(0.7f), s * std::sin(0.7f), cos_theta};
}

}  // namespace relume::testing
