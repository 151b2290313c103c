// The slot "direction sampling": chooses the direction in which a path continues from a vertex. Path guiding is mixed
// with the BSDF here, so pdf() is always the density of the whole mixture.
#pragma once

#include "sampling/sampler.h"
#include "scene/surface_point.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree.h"

namespace relume {

enum class DirectionSamplerKind : int { bsdf, quadtree };

struct DirectionSampler {
  DirectionSamplerKind kind = DirectionSamplerKind::bsdf;
  QuadtreeArray quadtrees;     ///< quadtrees by region
  float bsdf_fraction = 0.5f;   ///< probability of the BSDF at guided vertices
  bool stratified = false;      ///< whether quadtrees are sampled by sample_stratified()
  View<const float> fractions;  ///< learned `bsdf_fraction` by region; empty: none

  RELUME_HD BsdfSample sample(const SurfacePoint& sp, Sampler& sampler,
                              TransportMode mode = TransportMode::radiance) const {
    if (guides(sp)) return sample_mixture(sp, sampler);
    return sample_bsdf(sp, sampler, mode);
  }

  /// pdf_w of sample() for direction `wi`; `bsdf`: the BSDF's value there.
  RELUME_HD float pdf(const SurfacePoint& sp, const Vec3& wi, const BsdfEval& bsdf) const {
    if (!guides(sp)) return bsdf.pdf_forward;
    return mixed(fraction_at(sp), bsdf.pdf_forward, quadtrees.load(sp.region).pdf(wi));
  }

 private:
  RELUME_HD bool guides(const SurfacePoint& sp) const {
    return kind == DirectionSamplerKind::quadtree && sp.region < quadtrees.tree_count() && has_non_delta(sp.bsdf);
  }
  /// Probability of the BSDF at a point. Fractions are learned without delta lobes, so points with such do not use
  /// them.
  RELUME_HD float fraction_at(const SurfacePoint& sp) const {
    return sp.region < fractions.size && !has_delta(sp.bsdf) ? fractions[sp.region] : bsdf_fraction;
  }
  RELUME_HD static float mixed(float fraction, float pdf_bsdf, float pdf_tree) {
    return fraction * pdf_bsdf + (1.0f - fraction) * pdf_tree;
  }

  RELUME_HD static BsdfSample sample_bsdf(const SurfacePoint& sp, Sampler& sampler,
                                          TransportMode mode = TransportMode::radiance) {
    const float u_lobe = sp.bsdf.lobe_count > 1 || transmits(sp.bsdf.lobes[0].kind) ? sampler.next_1d() : 0.0f;
    return relume::sample(sp, u_lobe, sampler.next_2d(), mode);
  }

  /// One sample of the mixture of BSDF and quadtree. `eta_scale` includes the ratio of densities, so that Russian
  /// roulette uses the weight of BSDF sampling. Guided directions have small weights because they are likely.
  RELUME_HD BsdfSample sample_mixture(const SurfacePoint& sp, Sampler& sampler) const {
    const DirectionalQuadtree tree = quadtrees.load(sp.region);
    const float fraction = fraction_at(sp);
    BsdfSample s;
    if (sampler.next_1d() < fraction) {
      s = sample_bsdf(sp, sampler);
      if (!s.valid) return s;
      if (s.delta) {
        s.weight /= fraction;
        return s;
      }
      s.guide_pdf_w = tree.pdf(s.wi);
      s.bsdf_pdf_w = s.pdf_w;
      const float pdf = mixed(fraction, s.pdf_w, s.guide_pdf_w);
      s.weight *= s.pdf_w / pdf;
      s.eta_scale *= s.pdf_w / pdf;
      s.pdf_w = pdf;
      return s;
    }
    const Vec2 u = sampler.next_2d();
    s.wi = stratified ? tree.sample_stratified(u) : tree.sample(u);
    const BsdfEval bsdf = eval_pdf(sp, s.wi);
    s.guide_pdf_w = tree.pdf(s.wi);
    s.bsdf_pdf_w = bsdf.pdf_forward;
    s.pdf_w = mixed(fraction, bsdf.pdf_forward, s.guide_pdf_w);
    s.valid = !is_black(bsdf.f) && bsdf.pdf_forward > 0.0f;
    if (!s.valid) return s;
    s.weight = bsdf.f * (shading_cosine(sp, s.wi) / s.pdf_w);
    s.eta_scale = bsdf.pdf_forward / s.pdf_w;
    if (glm::dot(sp.frame.n, s.wi) < 0.0f) s.eta_scale *= refraction_eta_scale(sp.bsdf);
    return s;
  }
};

}  // namespace relume
