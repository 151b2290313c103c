// A guided point for tests of direction samplers.
#pragma once

#include <vector>

#include "materials/testing/bsdf_charts.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/guiding/directional_quadtree/testing/random_tree.h"
#include "testing/histogram.h"

namespace relume::testing {

/// A sampler with a quadtree of radiance and one of importance for region 0 only.
struct Guide {
  explicit Guide(float bsdf_fraction, bool stratified) {
    sampler.kind = DirectionSamplerKind::quadtree;
    words.resize(4);
    sampler.quadtrees = {mutable_view_of(words), 128};
    sampler.quadtrees.store(0, random_tree(128, 5));
    importance.resize(4);
    sampler.importance = mutable_view_of(importance);
    store_importance(random_tree(128, 9));
    sampler.bsdf_fraction = bsdf_fraction;
    sampler.stratified = stratified;
  }

  void store_importance(const DirectionalQuadtree& tree) const {
    QuadtreeArray{sampler.importance, 128}.store(0, tree);
  }

  std::vector<uint32_t> words;
  std::vector<uint32_t> importance;
  DirectionSampler sampler;
};

/// A point in region 0 whose frame is rotated against the world's.
inline SurfacePoint make_point(const BsdfCase& c) {
  SurfacePoint sp{};
  sp.frame = make_frame(glm::normalize(Vec3(0.3f, 0.9f, -0.2f)));
  sp.ng = sp.frame.n;
  sp.wo_local = glm::normalize(Vec3(0.4f, -0.3f, 0.6f));
  sp.bsdf = c.make(sp.wo_local.z, true);
  sp.region = 0;
  return sp;
}

/// Random numbers of the i-th sample, independent of the others: stratification would make χ² too small.
inline Sampler numbers(uint32_t i) { return Sampler::sequence(11, i, 0, 0, 0); }

/// Reflecting and transmitting lobes of all widths, some with a delta lobe over a wide one.
inline std::vector<BsdfCase> materials(const std::vector<float>& roughnesses = {0.0f, 0.3f, 0.8f}) {
  return material_cases(roughnesses);
}

/// A chart of directions around the material's peak, if it has one.
inline DirectionChart chart_of(const BsdfCase& c, const SurfacePoint& sp) {
  const PeakDirections peaks = peak_directions(c, sp.wo_local);
  return {make_frame(sp.frame.to_world(peaks.above)), clamp(double{c.alpha}, 0.02, 0.5)};
}

inline constexpr uint32_t kMixtureSamples = 40000;
// With 256 bins, χ² detects a density that is wrong by 6 %; with 576, 7 %.
inline constexpr int kBins = 16;

inline Histogram histogram_of(const Guide& guide, const SurfacePoint& sp, const DirectionChart& chart,
                              TransportMode mode = TransportMode::radiance) {
  Histogram histogram(kBins);
  for (uint32_t i = 0; i < kMixtureSamples; ++i) {
    Sampler u = numbers(i);
    const BsdfSample s = guide.sampler.sample(sp, u, mode);
    if (!s.valid || s.delta) {
      histogram.add_outside();
      continue;
    }
    const Vec2 p = chart.coordinates(s.wi);
    histogram.add(static_cast<double>(p.x), static_cast<double>(p.y));
  }
  return histogram;
}

}  // namespace relume::testing
