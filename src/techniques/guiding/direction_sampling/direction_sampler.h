// The slot "direction sampling": chooses the direction in which a path continues from a vertex. Path guiding is mixed
// with the BSDF here, so pdf() is always the density of the whole mixture.
#pragma once

#include "core/hash.h"
#include "sampling/sampler.h"
#include "scene/surface_point.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree.h"
#include "techniques/guiding/markov_chain/markov_guide.h"

namespace relume {

enum class DirectionSamplerKind : int { bsdf, quadtree, markov_chains };

/// Independent random numbers, for candidates beyond the first: a bounce has few dimensions of a sequence.
struct HashedNumbers {
  uint32_t seed = 0;
  uint32_t count = 0;

  RELUME_HD float next_1d() { return to_unit_float(hash(seed, count++)); }
  RELUME_HD Vec2 next_2d() {
    const float x = next_1d();
    return {x, next_1d()};
  }
};

/// What the density of the mixture depends on at a surface point, to evaluate it without the point.
struct GuidedPoint {
  uint32_t region = kNoRegion;  ///< region with a quadtree; kNoRegion: the point is not guided
  float fraction = 1;           ///< probability of the BSDF
};

/// A direction of the mixture, with the values that the BSDF alone gives it: for estimators that repeat the random
/// numbers of the BSDF without the guide.
struct SeparateDirection {
  BsdfSample bsdf;      ///< weight, eta_scale and pdf_w are those of the BSDF
  float ratio = 1;      ///< density of the BSDF over that of the mixture: factor of the weight of the direction
  float fraction = 1;   ///< probability with which the mixture asks the BSDF
  bool guided = false;  ///< whether the guide chose the direction, so that no numbers of the BSDF repeat it
};

struct DirectionSampler {
  DirectionSamplerKind kind = DirectionSamplerKind::bsdf;
  QuadtreeArray quadtrees;      ///< quadtrees by region
  float bsdf_fraction = 0.5f;   ///< probability of the BSDF at guided vertices
  bool stratified = false;      ///< whether quadtrees are sampled by sample_stratified()
  View<const float> fractions;  ///< learned `bsdf_fraction` by region; empty: none
  uint32_t candidates = 1;      ///< directions of which one is resampled at glossy vertices; 1: no resampling
  MarkovGuide chains;           ///< chains around vertices
  View<uint32_t> importance;    ///< as `quadtrees`, with importance, for light subpaths; empty: these are not guided

  RELUME_HD BsdfSample sample(const SurfacePoint& sp, Sampler& sampler,
                              TransportMode mode = TransportMode::radiance) const {
    if (mode == TransportMode::importance) return sample_importance(sp, sampler);
    if (has_chains(sp)) {
      MarkovLobes lobes;
      chains.add_lobes(sp, lobes);
      if (!lobes.empty()) return sample_mixture(sp, lobes, chains.bsdf_fraction, sampler);
    }
    if (!guides(sp)) return sample_bsdf(sp, sampler);
    const DirectionalQuadtree tree = quadtrees.load(sp.region);
    return resamples(sp) ? resample(sp, tree, sampler) : sample_mixture(sp, drawn_from(tree), fraction_at(sp), sampler);
  }

  /// Samples the mixture without resampling. `least_fraction`: least probability of the BSDF; 1: no guide. `u`:
  /// uniform in [0, 1), independent of the sampler's next numbers; it chooses between BSDF and guide. The BSDF takes
  /// the numbers that it takes without a guide.
  RELUME_HD_NOINLINE SeparateDirection sample_separately(const SurfacePoint& sp, float least_fraction, float u,
                                                         Sampler& sampler) const {
    if (!(least_fraction < 1.0f)) return {sample_bsdf(sp, sampler)};
    if (has_chains(sp)) {
      MarkovLobes lobes;
      chains.add_lobes(sp, lobes);
      if (!lobes.empty()) return separate(sp, lobes, relume::max(chains.bsdf_fraction, least_fraction), u, sampler);
    }
    if (!guides(sp)) return {sample_bsdf(sp, sampler)};
    const DirectionalQuadtree tree = quadtrees.load(sp.region);
    return separate(sp, drawn_from(tree), relume::max(fraction_at(sp), least_fraction), u, sampler);
  }

  /// pdf_w of sample() for direction `wi`; `bsdf`: the BSDF's value there. With resampling, that of a candidate.
  RELUME_HD float pdf(const SurfacePoint& sp, const Vec3& wi, const BsdfEval& bsdf) const {
    if (has_chains(sp)) {
      MarkovLobes lobes;
      chains.add_lobes(sp, lobes);
      return lobes.empty() ? bsdf.pdf_forward : mixed(chains.bsdf_fraction, bsdf.pdf_forward, lobes.pdf(wi));
    }
    if (!guides(sp)) return bsdf.pdf_forward;
    return mixed(fraction_at(sp), bsdf.pdf_forward, quadtrees.load(sp.region).pdf(wi));
  }

  /// Of points with quadtrees; others are not guided.
  RELUME_HD GuidedPoint guided(const SurfacePoint& sp) const {
    return guides(sp) ? GuidedPoint{sp.region, fraction_at(sp)} : GuidedPoint{};
  }
  /// pdf_w of sample() for direction `wi` at a point; `pdf_bsdf`: that of the BSDF. sample() rejects directions that
  /// the BSDF never samples, so their density is 0.
  RELUME_HD float pdf(const GuidedPoint& point, const Vec3& wi, float pdf_bsdf) const {
    if (point.region == kNoRegion || !(pdf_bsdf > 0.0f)) return pdf_bsdf;
    return mixed(point.fraction, pdf_bsdf, quadtrees.load(point.region).pdf(wi));
  }

  /// The same for light subpaths: pdf_w of sample() with TransportMode::importance.
  RELUME_HD float importance_pdf(const GuidedPoint& point, const Vec3& wi, float pdf_bsdf) const {
    if (!(pdf_bsdf > 0.0f) || !has_importance(point.region)) return pdf_bsdf;
    return mixed(bsdf_fraction, pdf_bsdf, pdf_of_quadtree(importance_trees(), point.region, wi));
  }
  /// Probability with which light subpaths sample the BSDF at a point.
  RELUME_HD float importance_fraction(const GuidedPoint& point) const {
    return has_importance(point.region) ? bsdf_fraction : 1.0f;
  }

 private:
  /// A quadtree with the chosen form of sampling.
  struct DrawnTree {
    const DirectionalQuadtree& tree;
    bool stratified;

    RELUME_HD float pdf(const Vec3& w) const { return tree.pdf(w); }
    RELUME_HD Vec3 sample(const Vec2& u) const { return stratified ? tree.sample_stratified(u) : tree.sample(u); }
  };
  RELUME_HD DrawnTree drawn_from(const DirectionalQuadtree& tree) const { return {tree, stratified}; }

  /// Whether chains may guide a point: if any of the drawn ones has a lobe.
  RELUME_HD bool has_chains(const SurfacePoint& sp) const {
    return kind == DirectionSamplerKind::markov_chains && has_non_delta(sp.bsdf);
  }
  RELUME_HD bool guides(const SurfacePoint& sp) const {
    return kind == DirectionSamplerKind::quadtree && sp.region < quadtrees.tree_count() && has_non_delta(sp.bsdf);
  }
  RELUME_HD QuadtreeArray importance_trees() const { return {importance, quadtrees.bit_count}; }
  /// Whether the tree of importance of a region guides light subpaths. Camera subpaths have not reached regions with a
  /// uniform tree: half of its directions would be lost below the horizon, for no gain.
  RELUME_HD bool has_importance(uint32_t region) const {
    const QuadtreeArray trees = importance_trees();
    return region < trees.tree_count() && !trees.is_uniform(region);
  }
  /// Probability of the BSDF at a point. Fractions are learned without delta lobes, so points with such do not use
  /// them.
  RELUME_HD float fraction_at(const SurfacePoint& sp) const {
    return sp.region < fractions.size && !has_delta(sp.bsdf) ? fractions[sp.region] : bsdf_fraction;
  }
  RELUME_HD static float mixed(float fraction, float pdf_bsdf, float pdf_guide) {
    return fraction * pdf_bsdf + (1.0f - fraction) * pdf_guide;
  }

  /// Whether a direction is resampled. Delta lobes cannot be: their directions have no density.
  RELUME_HD bool resamples(const SurfacePoint& sp) const {
    return candidates > 1 && has_glossy(sp.bsdf) && !has_delta(sp.bsdf);
  }

  template <typename Numbers>
  RELUME_HD static BsdfSample sample_bsdf(const SurfacePoint& sp, Numbers& numbers,
                                          TransportMode mode = TransportMode::radiance) {
    const float u_lobe = sp.bsdf.lobe_count > 1 || transmits(sp.bsdf.lobes[0].kind) ? numbers.next_1d() : 0.0f;
    return relume::sample(sp, u_lobe, numbers.next_2d(), mode);
  }

  RELUME_HD BsdfSample sample_importance(const SurfacePoint& sp, Sampler& sampler) const {
    if (!has_non_delta(sp.bsdf) || !has_importance(sp.region))
      return sample_bsdf(sp, sampler, TransportMode::importance);
    const DirectionalQuadtree tree = importance_trees().load(sp.region);
    return sample_mixture<TransportMode::importance>(sp, drawn_from(tree), bsdf_fraction, sampler);
  }

  /// Draws candidates from the mixture and keeps one with a probability in proportion to w = t / p, where the target t
  /// is the BSDF with the cosine times the density of the quadtree (resampled importance sampling). With the mean of w
  /// over w as a factor of its weight f cos θ / p, the expected value of weight × h is ∫ f cos θ h for every function h
  /// of the direction. MIS weights are such a function: they sum to one with `pdf_w`, the density p of a candidate, as
  /// they do without resampling. The target has a uniform part, so that directions that the tree neglects have bounded
  /// factors.
  RELUME_HD BsdfSample resample(const SurfacePoint& sp, const DirectionalQuadtree& tree, Sampler& sampler) const {
    constexpr uint32_t kSalt = 0x3c6ef372u;
    constexpr float kUniform = 0.1f;
    BsdfSample kept;
    float kept_weight = 0;
    float sum = 0;
    const auto offer = [&](const BsdfSample& s, float u) {
      if (!s.valid) return;
      const float density = (1.0f - kUniform) * s.guide_pdf_w + kUniform * sphere_pdf();
      const float weight = luminance(s.weight) * density;
      sum += weight;
      if (!(u * sum < weight)) return;
      kept = s;
      kept_weight = weight;
    };
    const DrawnTree drawn = drawn_from(tree);
    const float fraction = fraction_at(sp);
    offer(sample_mixture(sp, drawn, fraction, sampler), 0.0f);
    HashedNumbers numbers{hash(sampler.ray_id(), kSalt)};
    for (uint32_t i = 1; i < candidates; ++i) {
      const BsdfSample s = sample_mixture(sp, drawn, fraction, numbers);
      offer(s, numbers.next_1d());
    }
    if (!(kept_weight > 0.0f)) return {};
    kept.resampling = sum / (static_cast<float>(candidates) * kept_weight);
    kept.weight *= kept.resampling;
    kept.eta_scale *= kept.resampling;
    return kept;
  }

  /// sample_separately() of a mixture; its parameters are those of sample_mixture().
  template <typename Guide>
  RELUME_HD static SeparateDirection separate(const SurfacePoint& sp, const Guide& guide, float fraction, float u,
                                              Sampler& sampler) {
    SeparateDirection d;
    BsdfSample& s = d.bsdf;
    d.fraction = fraction;
    d.guided = !(u < fraction);
    if (d.guided) {
      s.wi = guide.sample(sampler.next_2d());
      const BsdfEval bsdf = eval_pdf(sp, s.wi);
      s.pdf_w = bsdf.pdf_forward;
      s.valid = !is_black(bsdf.f) && bsdf.pdf_forward > 0.0f;
      if (!s.valid) return d;
      s.weight = bsdf.f * (shading_cosine(sp, s.wi) / s.pdf_w);
      if (glm::dot(sp.frame.n, s.wi) < 0.0f) s.eta_scale = refraction_eta_scale(sp.bsdf);
    } else {
      s = sample_bsdf(sp, sampler);
      if (!s.valid) return d;
    }
    if (s.delta) {
      d.ratio = 1.0f / fraction;
      return d;
    }
    s.guide_pdf_w = guide.pdf(s.wi);
    s.bsdf_pdf_w = s.pdf_w;
    d.ratio = s.pdf_w / mixed(fraction, s.pdf_w, s.guide_pdf_w);
    return d;
  }

  /// One sample of the mixture of BSDF and guide, a DrawnTree or MarkovLobes; `fraction`: probability of the BSDF.
  /// `eta_scale` includes the ratio of densities, so that Russian roulette uses the weight of BSDF sampling. Guided
  /// directions have small weights because they are likely.
  template <TransportMode kMode = TransportMode::radiance, typename Guide, typename Numbers>
  RELUME_HD static BsdfSample sample_mixture(const SurfacePoint& sp, const Guide& guide, float fraction,
                                             Numbers& numbers) {
    BsdfSample s;
    if (numbers.next_1d() < fraction) {
      s = sample_bsdf(sp, numbers, kMode);
      if (!s.valid) return s;
      if (s.delta) {
        s.weight /= fraction;
        return s;
      }
      s.guide_pdf_w = guide.pdf(s.wi);
      s.bsdf_pdf_w = s.pdf_w;
      const float pdf = mixed(fraction, s.pdf_w, s.guide_pdf_w);
      s.weight *= s.pdf_w / pdf;
      s.eta_scale *= s.pdf_w / pdf;
      s.pdf_w = pdf;
      return s;
    }
    const Vec2 u = numbers.next_2d();
    s.wi = guide.sample(u);
    const BsdfEval bsdf = eval_pdf(sp, s.wi, kMode);
    s.guide_pdf_w = guide.pdf(s.wi);
    s.bsdf_pdf_w = bsdf.pdf_forward;
    s.pdf_w = mixed(fraction, bsdf.pdf_forward, s.guide_pdf_w);
    s.valid = !is_black(bsdf.f) && bsdf.pdf_forward > 0.0f;
    if (!s.valid) return s;
    s.weight = bsdf.f * (shading_cosine(sp, s.wi) / s.pdf_w);
    s.eta_scale = bsdf.pdf_forward / s.pdf_w;
    if (kMode == TransportMode::radiance && glm::dot(sp.frame.n, s.wi) < 0.0f)
      s.eta_scale *= refraction_eta_scale(sp.bsdf);
    return s;
  }
};

}  // namespace relume
