// Learns in each region the fraction of directions that the BSDF samples, from the second moment of earlier samples.
#pragma once

#include "core/region.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Second moments that a region's samples would have had with each of several fractions.
struct MixtureMoments {
  static constexpr uint32_t kFractions = 9;
  static constexpr float kStep = 1.0f / (kFractions + 1);
  static constexpr float kMost = 1e37f;  ///< limit of sums

  float sums[kFractions] = {};
  float samples = 0;  ///< number of samples in the sums

  RELUME_HD static float fraction(uint32_t k) { return kStep * static_cast<float>(k + 1); }
};

/// Fraction used until a region has samples, and its weight in samples.
struct FractionPrior {
  float fraction = 0.5f;
  float samples = 32;
};

/// The fraction α with the least second moment. The prior adds samples that α must share: with the prior fraction p,
/// their second moment is p² / α + (1 − p)² / (1 − α), which is least at p. A parabola interpolates between the
/// fractions.
RELUME_HD inline float best_fraction(const MixtureMoments& m, const FractionPrior& prior) {
  constexpr uint32_t kLast = MixtureMoments::kFractions - 1;
  const float at = prior.fraction / MixtureMoments::kStep - 0.5f;
  const auto nearest = static_cast<uint32_t>(clamp(at, 0.0f, static_cast<float>(kLast)));
  if (!(m.sums[nearest] > 0.0f) || !(m.samples > 0.0f)) return prior.fraction;
  const float scale = m.samples / m.sums[nearest];
  float costs[MixtureMoments::kFractions];
  uint32_t best = 0;
  for (uint32_t k = 0; k <= kLast; ++k) {
    const float alpha = MixtureMoments::fraction(k);
    costs[k] =
        scale * m.sums[k] + prior.samples * (sqr(prior.fraction) / alpha + sqr(1.0f - prior.fraction) / (1.0f - alpha));
    if (costs[k] < costs[best]) best = k;
  }
  if (best == 0 || best == kLast) return MixtureMoments::fraction(best);
  const float bend = costs[best - 1] - 2.0f * costs[best] + costs[best + 1];
  const float slope = 0.5f * (costs[best - 1] - costs[best + 1]);
  const float shift = bend > 0.0f ? clamp(slope / bend, -0.5f, 0.5f) : 0.0f;
  return MixtureMoments::fraction(best) + MixtureMoments::kStep * (is_finite(shift) ? shift : 0.0f);
}

/// Adds the samples of a region to its moments; one call per region and fraction. A sample with the contribution x,
/// drawn with density p, has the second moment x² p / p_α under the mixture p_α = α p_bsdf + (1 − α) p_tree. x is the
/// luminance of the sampled radiance times that of the BSDF. Records count by their weight. Sums keep kKept of their
/// value in each frame. At most kMostSamples are read, spread evenly: while regions are few, each has more than one
/// thread should read.
struct LearnFractionsKernel {
  static constexpr float kKept = 15.0f / 16;
  static constexpr uint32_t kMostSamples = 4096;

  SampleGroupsView samples;
  View<MixtureMoments> moments;  ///< by region

  RELUME_HD void operator()(uint32_t region, uint32_t k) const {
    const uint32_t count = samples.counts[region];
    if (count == 0) return;
    const uint32_t read = relume::min(count, kMostSamples);
    const float alpha = MixtureMoments::fraction(k);
    float sum = 0;
    float used = 0;
    for (uint32_t i = 0; i < read; ++i) {
      const VertexSample& s = samples.sample(region, static_cast<uint32_t>(uint64_t{i} * count / read));
      const float x = s.value * unpack_density(s.bsdf);
      if (!(x > 0.0f)) continue;
      const float mixture = alpha * unpack_guide_density(s.bsdf) + (1.0f - alpha) * unpack_guide_density(s.densities);
      const float moment = x * x * unpack_density(s.densities) / mixture * s.weight;
      if (!is_finite(moment)) continue;
      sum += moment;
      ++used;
    }
    MixtureMoments& m = moments[region];
    m.sums[k] = relume::min(kKept * m.sums[k] + sum, MixtureMoments::kMost);
    if (k == 0) m.samples = kKept * m.samples + used;
  }
};

/// Gives each region the moments of its origin, and the fraction that follows from them.
struct InheritFractionsKernel {
  View<const uint32_t> previous;       ///< origin by region
  View<const MixtureMoments> moments;  ///< by origin; empty: none
  FractionPrior prior;
  View<MixtureMoments> next;
  View<float> fractions;

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t from = previous[region];
    const MixtureMoments m = from < moments.size ? moments[from] : MixtureMoments{};
    next[region] = m;
    fractions[region] = best_fraction(m, prior);
  }
};

}  // namespace relume
