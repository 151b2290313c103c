// The BSDF at one surface point: a few lobes, evaluated by a switch. All directions are local: +Z is the shading normal
// on the side of wo. `f` excludes the cosine; densities are per solid angle of wi.
#pragma once

#include "materials/lobes/coat_with_normal.h"
#include "materials/lobes/dielectric.h"
#include "materials/lobes/lambert.h"
#include "materials/lobes/reflection.h"
#include "materials/lobes/sheen.h"
#include "materials/lobes/thin_transmission.h"
#include "materials/lobes_of_point.h"

namespace relume {

/// Value and density of lobe i; zero for delta lobes. `interface`: that of the BSDF, either as stored or flipped.
/// `kLayered`: bsdf.layered.
template <bool kLayered>
RELUME_HD inline LobeEval eval_lobe(const Bsdf& bsdf, const Interface& interface, int i, const Vec3& wo, const Vec3& wi,
                                    TransportMode mode) {
  const Lobe& lobe = bsdf.lobes[i];
  const InterfaceDetail& detail = bsdf.detail;
  switch (lobe.kind) {
    case LobeKind::lambert: return lambert::eval(lobe, wi);
    case LobeKind::covered_lambert:
      return covered_lambert::eval<kLayered>(lobe, interface, detail, *bsdf.tables, wo, wi);
    case LobeKind::reflection:
      if (kLayered && bsdf.coat_has_normal && bsdf.is_coat(i)) return coat_with_normal::eval(lobe, detail, wo, wi);
      return reflection::eval<kLayered>(lobe, detail, wo, wi);
    case LobeKind::multiple_reflection: return multiple_reflection::eval<kLayered>(lobe, detail, *bsdf.tables, wo, wi);
    case LobeKind::dielectric: return dielectric::eval<kLayered>(lobe, interface, detail, wo, wi, mode);
    case LobeKind::thin_transmission: return thin_transmission::eval<kLayered>(lobe, interface, detail, wo, wi);
    case LobeKind::sheen: return kLayered ? sheen::eval(lobe, *bsdf.tables, wo, wi) : LobeEval{};
    case LobeKind::diffuse_transmission:
      return kLayered ? diffuse_transmission::eval(lobe, interface, detail, *bsdf.tables, wo, wi, mode) : LobeEval{};
    case LobeKind::specular_reflection:
    case LobeKind::smooth_dielectric:
    case LobeKind::null: return {};
  }
  return {};
}

/// Samples a direction, for delta lobes with its weight. `u_side` chooses between reflection and refraction.
template <bool kLayered>
RELUME_HD inline LobeSample sample_lobe(const Bsdf& bsdf, int i, const Vec3& wo, float u_side, const Vec2& u,
                                        TransportMode mode) {
  const Lobe& lobe = bsdf.lobes[i];
  const Interface& interface = bsdf.interface;
  const InterfaceDetail& detail = bsdf.detail;
  if (kLayered && bsdf.coat_has_normal && bsdf.is_coat(i)) return coat_with_normal::sample(lobe, detail, wo, u);
  switch (lobe.kind) {
    case LobeKind::lambert:
    case LobeKind::covered_lambert:
    case LobeKind::multiple_reflection: return lambert::sample(u);
    case LobeKind::reflection: return reflection::sample<kLayered>(lobe, detail, wo, u);
    case LobeKind::dielectric: return dielectric::sample<kLayered>(lobe, interface, detail, wo, u_side, u);
    case LobeKind::thin_transmission: return thin_transmission::sample(lobe, wo, u);
    case LobeKind::specular_reflection: return specular_reflection::sample<kLayered>(lobe, detail, wo);
    case LobeKind::smooth_dielectric:
      return smooth_dielectric::sample<kLayered>(lobe, interface, detail, wo, u_side, mode);
    case LobeKind::null: return null_transmission::sample<kLayered>(lobe, interface, detail, wo);
    case LobeKind::sheen: return sheen::sample(u);
    case LobeKind::diffuse_transmission: return diffuse_transmission::sample(interface, u_side, u);
  }
  return {};
}

/// Directional albedo of the lobe at `cos_theta`, for sampling probabilities. Exact for reflection; an estimate for
/// transmission, anisotropic microfacets and films.
RELUME_HD_INLINE Rgb lobe_albedo(const Lobe& lobe, const Interface& interface, const EnergyTables& tables,
                                 float cos_theta) {
  const EnergyTable& table = tables.of(lobe.model);
  switch (lobe.kind) {
    case LobeKind::lambert: return lobe.color * lobe.weight;
    case LobeKind::covered_lambert:
    case LobeKind::diffuse_transmission:
      return lobe.color * covered_lambert::transmitted(lobe, interface, table, cos_theta) * lobe.weight;
    case LobeKind::sheen: return lobe.color * (sheen::albedo(lobe, tables, cos_theta) * lobe.weight);
    case LobeKind::reflection: return reflection::albedo(lobe, table, cos_theta) * lobe.weight;
    case LobeKind::multiple_reflection: return multiple_reflection::albedo(lobe, table, cos_theta) * lobe.weight;
    case LobeKind::specular_reflection: return fresnel_schlick(lobe.color, Rgb(lobe.f90), cos_theta) * lobe.weight;
    case LobeKind::dielectric:
    case LobeKind::smooth_dielectric: {
      const Rgb reflected = dielectric::reflectance(interface, cos_theta);
      return (reflected + lobe.color * (Rgb(1) - reflected)) * lobe.weight;
    }
    case LobeKind::thin_transmission:
    case LobeKind::null:
      return lobe.color * (Rgb(1) - fresnel_schlick(interface.f0, Rgb(interface.f90), cos_theta)) * lobe.weight;
  }
  return Rgb(0);
}

/// Transmittance of the clearcoat at `cos_theta` to its normal.
RELUME_HD inline float coat_transmittance(const Bsdf& bsdf, float cos_theta) {
  if (!bsdf.has_coat()) return 1.0f;
  return 1.0f - luminance(lobe_albedo(bsdf.lobes[0], bsdf.interface, *bsdf.tables, std::fabs(cos_theta)));
}

/// Transmittance of the sheen.
RELUME_HD inline float sheen_transmittance(const Bsdf& bsdf, float cos_theta) {
  if (!bsdf.has_sheen()) return 1.0f;
  return 1.0f - bsdf.sheen * sheen::albedo(bsdf.lobes[bsdf.sheen_lobe()], *bsdf.tables, cos_theta);
}

/// Transmittance of the layers above a lobe.
struct LayerTransmittance {
  float below_coat;
  float below_sheen;

  RELUME_HD float to(const Bsdf& bsdf, int lobe) const {
    if (bsdf.is_coat(lobe)) return 1.0f;
    return bsdf.has_sheen() && lobe == bsdf.sheen_lobe() ? below_coat : below_sheen;
  }
};

/// Transmittance along one direction.
RELUME_HD_INLINE LayerTransmittance layer_transmittance(const Bsdf& bsdf, float cos_theta) {
  if (!bsdf.has_coat() && !bsdf.has_sheen()) return {1.0f, 1.0f};
  const float below_coat = coat_transmittance(bsdf, cos_theta);
  return {below_coat, below_coat * sheen_transmittance(bsdf, cos_theta)};
}

/// Transmittance on the way in and out. The coat is passed twice. Below sheen it is the smaller transmittance of the
/// two directions, which is reciprocal and conserves energy (KHR_materials_sheen).
template <bool kLayered>
RELUME_HD_INLINE LayerTransmittance layer_transmittance(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi) {
  LayerTransmittance t{1.0f, 1.0f};
  if (bsdf.has_coat()) {
    const bool own_normal = kLayered && bsdf.coat_has_normal;
    const float cos_o = own_normal ? glm::dot(wo, bsdf.detail.coat_normal) : wo.z;
    const float cos_i = own_normal ? glm::dot(wi, bsdf.detail.coat_normal) : wi.z;
    t.below_coat = coat_transmittance(bsdf, cos_o) * coat_transmittance(bsdf, cos_i);
  }
  t.below_sheen = t.below_coat;
  if (kLayered && bsdf.has_sheen())
    t.below_sheen *= relume::min(sheen_transmittance(bsdf, wo.z), sheen_transmittance(bsdf, wi.z));
  return t;
}

enum class Side : uint8_t { same, other };  ///< side of the surface relative to the viewer of a BSDF

/// The interface as a viewer on that side sees it.
RELUME_HD inline Interface interface_from(const Bsdf& bsdf, Side side) {
  return side == Side::same ? bsdf.interface : flipped(bsdf.interface);
}

namespace bsdf_detail {

/// Sets at(i), a reference, to the probability of lobe i. `albedo(lobe)`: of lobes, for the viewer at `cos_theta`.
template <typename Albedo, typename At>
RELUME_HD_INLINE bool set_probabilities(const Bsdf& bsdf, float cos_theta, const Albedo& albedo, const At& at) {
  if (bsdf.lobe_count == 1) {
    at(0) = 1.0f;
    return true;
  }
  const LayerTransmittance layers = layer_transmittance(bsdf, cos_theta);
  float sum = 0;
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    const float probability = luminance(albedo(bsdf.lobes[i])) * layers.to(bsdf, i);
    at(i) = probability;
    sum += probability;
  }
  if (!(sum > 0.0f)) return false;
  for (int i = 0; i < bsdf.lobe_count; ++i) at(i) /= sum;
  return true;
}

}  // namespace bsdf_detail

/// Probabilities of the lobes for a viewer at `cos_theta` on that side. Returns false if nothing is reflected.
RELUME_HD inline bool lobe_probabilities(const Bsdf& bsdf, float cos_theta, Side side, float probabilities[kMaxLobes]) {
  const Interface interface = interface_from(bsdf, side);
  const auto albedo = [&](const Lobe& lobe) { return lobe_albedo(lobe, interface, *bsdf.tables, cos_theta); };
  return bsdf_detail::set_probabilities(bsdf, cos_theta, albedo, [&](int i) -> float& { return probabilities[i]; });
}

/// Computes the sampling probabilities of the lobes for wo. Removes all lobes of a BSDF that reflects nothing.
RELUME_HD inline void prepare(Bsdf& bsdf, float cos_theta_o) {
  const auto albedo = [&](const Lobe& lobe) { return lobe_albedo(lobe, bsdf.interface, *bsdf.tables, cos_theta_o); };
  const auto at = [&](int i) -> float& { return bsdf.lobes[i].probability; };
  if (!bsdf_detail::set_probabilities(bsdf, cos_theta_o, albedo, at)) bsdf.lobe_count = 0;
}

namespace bsdf_detail {

/// reverse_pdf() for given lobe probabilities.
template <bool kLayered>
RELUME_HD inline float mixture_pdf(const Bsdf& bsdf, const float probabilities[kMaxLobes], const Vec3& from,
                                   const Vec3& to, Side side) {
  const Interface interface = interface_from(bsdf, side);
  float pdf = 0;
  for (int i = 0; i < bsdf.lobe_count; ++i)
    pdf += probabilities[i] * eval_lobe<kLayered>(bsdf, interface, i, from, to, TransportMode::radiance).pdf_w;
  return pdf;
}

}  // namespace bsdf_detail

/// Density of sampling wo for a viewer at wi, whose lobe probabilities differ.
RELUME_HD inline float reverse_pdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi) {
  const Side side = wi.z > 0.0f ? Side::same : Side::other;
  float probabilities[kMaxLobes];
  if (!lobe_probabilities(bsdf, std::fabs(wi.z), side, probabilities)) return 0.0f;
  const Vec3 from = side == Side::same ? wi : -wi;
  const Vec3 to = side == Side::same ? wo : -wo;
  return bsdf.layered ? bsdf_detail::mixture_pdf<true>(bsdf, probabilities, from, to, side)
                      : bsdf_detail::mixture_pdf<false>(bsdf, probabilities, from, to, side);
}

/// Whether the BSDF is a single Lambert lobe: by far the most frequent case, with a faster code path.
RELUME_HD inline bool is_lambert(const Bsdf& bsdf) {
  return bsdf.lobe_count == 1 && bsdf.lobes[0].kind == LobeKind::lambert;
}

namespace bsdf_detail {

template <bool kReverse, bool kLayered>
RELUME_HD inline BsdfEval eval_pdf_of_mixture(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, TransportMode mode) {
  BsdfEval result;
  const LayerTransmittance layers = layer_transmittance<kLayered>(bsdf, wo, wi);
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    const Lobe& lobe = bsdf.lobes[i];
    const LobeEval e = eval_lobe<kLayered>(bsdf, bsdf.interface, i, wo, wi, mode);
    result.f += e.f * (lobe.weight * layers.to(bsdf, i));
    result.pdf_forward += lobe.probability * e.pdf_w;
  }
  if constexpr (kReverse) result.pdf_reverse = reverse_pdf(bsdf, wo, wi);
  return result;
}

template <bool kReverse>
RELUME_HD_NOINLINE inline BsdfEval eval_pdf_of_layers(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi,
                                                      TransportMode mode) {
  return eval_pdf_of_mixture<kReverse, true>(bsdf, wo, wi, mode);
}

}  // namespace bsdf_detail

/// BSDF value and densities of all non-delta lobes. Requires wo.z > 0.
template <bool kReverse = false>
RELUME_HD_INLINE BsdfEval eval_pdf(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi,
                                   TransportMode mode = TransportMode::radiance) {
  if (!is_lambert(bsdf)) {
    return bsdf.layered ? bsdf_detail::eval_pdf_of_layers<kReverse>(bsdf, wo, wi, mode)
                        : bsdf_detail::eval_pdf_of_mixture<kReverse, false>(bsdf, wo, wi, mode);
  }
  const LobeEval e = lambert::eval(bsdf.lobes[0], wi);
  return {e.f, e.pdf_w, kReverse && wi.z > 0.0f ? cosine_hemisphere_pdf(wo.z) : 0.0f};
}

namespace bsdf_detail {

template <bool kLayered>
RELUME_HD inline Rgb eval_specular(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi) {
  const LayerTransmittance layers = layer_transmittance<kLayered>(bsdf, wo, wi);
  Rgb f(0);
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    const Lobe& lobe = bsdf.lobes[i];
    if (!is_specular(lobe.kind)) continue;
    const LobeEval e = eval_lobe<kLayered>(bsdf, bsdf.interface, i, wo, wi, TransportMode::radiance);
    f += e.f * (lobe.weight * layers.to(bsdf, i));
  }
  return f;
}

}  // namespace bsdf_detail

/// Part of eval_pdf().f from specular lobes.
RELUME_HD inline Rgb eval_specular(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi) {
  return bsdf.layered ? bsdf_detail::eval_specular<true>(bsdf, wo, wi)
                      : bsdf_detail::eval_specular<false>(bsdf, wo, wi);
}

/// Factor 1/η² in the BSDF for directions on the viewer's other side, shared by all lobes.
RELUME_HD inline float refraction_eta_scale(const Bsdf& bsdf) {
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (is_rough_transmission(bsdf.lobes[i].kind)) return transport_scale(bsdf.interface.eta, TransportMode::radiance);
  }
  return 1.0f;
}

namespace bsdf_detail {

template <bool kLayered>
RELUME_HD inline BsdfSample sample_mixture(const Bsdf& bsdf, const Vec3& wo, float u_lobe, const Vec2& u,
                                           TransportMode mode) {
  if (bsdf.empty()) return {};
  int i = 0;
  while (i + 1 < bsdf.lobe_count && u_lobe >= bsdf.lobes[i].probability) u_lobe -= bsdf.lobes[i++].probability;
  const Lobe& lobe = bsdf.lobes[i];
  if (!(lobe.probability > 0.0f)) return {};
  const float u_side = clamp(u_lobe / lobe.probability, 0.0f, kOneMinusEpsilon);

  const LobeSample s = sample_lobe<kLayered>(bsdf, i, wo, u_side, u, mode);
  if (!s.valid) return {};
  BsdfSample result;
  if (transmits(lobe.kind) && s.wi.z < 0.0f) result.eta_scale = transport_scale(bsdf.interface.eta, mode);
  result.wi = s.wi;
  result.delta = is_delta(lobe.kind);
  if (result.delta) {
    const float let_through = bsdf.is_coat(i) ? 1.0f : layer_transmittance<kLayered>(bsdf, wo, s.wi).to(bsdf, i);
    result.weight = s.weight * (lobe.weight * let_through / lobe.probability);
    result.alpha = 0.0f;
    result.valid = true;
    return result;
  }
  const BsdfEval e = eval_pdf_of_mixture<false, kLayered>(bsdf, wo, s.wi, mode);
  if (!(e.pdf_forward > 0.0f)) return {};
  result.weight = e.f * (std::fabs(s.wi.z) / e.pdf_forward);
  result.pdf_w = e.pdf_forward;
  result.alpha = is_glossy(lobe.kind) ? lobe.alpha : 1.0f;
  result.valid = true;
  return result;
}

RELUME_HD_NOINLINE inline BsdfSample sample_layered_mixture(const Bsdf& bsdf, const Vec3& wo, float u_lobe,
                                                            const Vec2& u, TransportMode mode) {
  return sample_mixture<true>(bsdf, wo, u_lobe, u, mode);
}

}  // namespace bsdf_detail

/// Samples a direction from the mixture of all lobes.
RELUME_HD inline BsdfSample sample(const Bsdf& bsdf, const Vec3& wo, float u_lobe, const Vec2& u,
                                   TransportMode mode = TransportMode::radiance) {
  if (is_lambert(bsdf)) {
    const Vec3 wi = cosine_hemisphere_from_square(u);
    return {wi, bsdf.lobes[0].color, cosine_hemisphere_pdf(wi.z), 1.0f, 1.0f, false, wi.z > 0.0f};
  }
  if (bsdf.layered) return bsdf_detail::sample_layered_mixture(bsdf, wo, u_lobe, u, mode);
  return bsdf_detail::sample_mixture<false>(bsdf, wo, u_lobe, u, mode);
}

/// Directional albedo of all reflected and transmitted light: the divisor of demodulation.
RELUME_HD inline Rgb albedo(const Bsdf& bsdf, float cos_theta_o) {
  const LayerTransmittance layers = layer_transmittance(bsdf, cos_theta_o);
  Rgb sum(0);
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    sum += lobe_albedo(bsdf.lobes[i], bsdf.interface, *bsdf.tables, cos_theta_o) * layers.to(bsdf, i);
  }
  return sum;
}

}  // namespace relume
