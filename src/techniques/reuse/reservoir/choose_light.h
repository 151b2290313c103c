// Resampled importance sampling of direct light: chooses one of several candidates of light selection and of the path's
// own direction ([Bitterli20] alg. 3).
#pragma once

#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/reservoir.h"
#include "techniques/transport/path/first_scatter.h"

namespace relume {

using LightReservoir = Reservoir<LightPoint>;

/// Strategies that sample the candidates of a pixel, and their densities.
struct CandidateSource {
  const PathContext& context;
  uint32_t light_candidates = 0;  ///< candidates from light selection
  float scatter_chance = 1;       ///< probability with which the path has a direction: element of kScatterChances
  bool own_lobes = true;          ///< whether the path samples the receiver's lobes, whose colours no cache has raised

  /// Expected number of candidates at `light`, per steradian: the denominator of the balance heuristic. `pdf_light`: of
  /// sample_li(). `pdf_scatter`: of the path's direction; 0 where it cannot meet the light.
  RELUME_HD float density(float pmf, float pdf_light, float pdf_scatter) const {
    const auto count = static_cast<float>(static_cast<int>(light_candidates));
    return count * pmf * pdf_light + context.indirect.rate * scatter_chance * pdf_scatter;
  }
};

/// Candidate of light selection. Returns its weight p̂ / density.
RELUME_HD inline float draw_from_selection(const CandidateSource& source, const Receiver& r, Sampler& sampler,
                                           LightPoint& point) {
  const PathContext& c = source.context;
  const LightPick pick = pick_light(c, r.sp, sampler);
  const LightSample light = sample_picked(c, r.sp, pick);
  if (!light.valid()) return 0.0f;
  const BsdfEval bsdf = eval_pdf(r.sp, light.wi);
  if (is_black(bsdf.f)) return 0.0f;
  const float pdf_scatter = light.delta ? 0.0f : c.directions.pdf(r.sp, light.wi, bsdf);
  point = point_of(c.scene.lights, pick.id, light);
  return luminance(reflected(c.scene, r, light, bsdf)) * light.pdf_w /
         source.density(pick.pmf, light.pdf_w, pdf_scatter);
}

/// Density with which the receiver's lobes and the guide sample a direction.
RELUME_HD_NOINLINE inline float density_of_own_lobes(const PathContext& c, const SurfacePoint& sp, const Vec3& w) {
  return c.directions.pdf(sp, w, eval_pdf(sp, w));
}

/// Weight of a point that the path's direction meets, sampled with the density `pdf_scatter`. `found`: probability that
/// a hit there counts, below 1 for stochastic alpha. Candidates of light selection count directions by the density of
/// the receiver's own lobes. If the path sampled others, this strategy counts them in the same way, so that the MIS
/// weights of both add up to one.
RELUME_HD inline float weight_of_scatter(const CandidateSource& source, const Receiver& r, const LightPoint& point,
                                         float pdf_scatter, float found) {
  const PathContext& c = source.context;
  const LightSample light = light_at(c.scene.lights, point, r.sp.position);
  if (!light.valid()) return 0.0f;
  const float pmf = c.selector.pmf(r.sp, point.light);
  const float pdf_light = pmf > 0.0f ? density_of(c.scene.lights, point.light, r.sp.position, light) : 0.0f;
  const float target = luminance(reflected(c.scene, r, light));
  if (source.own_lobes) return target * light.pdf_w / (found * source.density(pmf, pdf_light, pdf_scatter));
  const float pdf = density_of_own_lobes(c, r.sp, light.wi);
  if (!(pdf > 0.0f)) return 0.0f;
  return target * light.pdf_w * (pdf / pdf_scatter) / (found * source.density(pmf, pdf_light, pdf));
}

/// Probability that a ray which meets the light's triangle at the point hits it.
RELUME_HD inline float chance_of_hit(const SceneView& scene, const LightPoint& point) {
  const TriangleLight& triangle = scene.lights.lights[point.light].triangle;
  if (triangle.textured < 0) return 1.0f;
  return opacity(scene, triangle.instance, triangle.primitive, point.coordinates.x, point.coordinates.y);
}

/// Offers the light that the path's direction meets; from infinity, there may be several.
template <typename Offer>
RELUME_HD inline void offer_scatter(const CandidateSource& source, const Receiver& r, const FirstScatter& scatter,
                                    const Offer& offer) {
  if (!(scatter.pdf_w > 0.0f)) return;
  const LightsView& lights = source.context.scene.lights;
  if (scatter.light != kNoLight) {
    const LightPoint point = point_along(lights, scatter.light, r.sp.position, scatter.direction, scatter.barycentric);
    const float found = chance_of_hit(source.context.scene, point);
    if (found > 0.0f) offer(point, scatter.resampling * weight_of_scatter(source, r, point, scatter.pdf_w, found));
    return;
  }
  const Vec2 direction = octahedral_from_direction(scatter.direction);
  for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
    const Light& light = lights.lights[id];
    const bool is_delta = light.kind == LightKind::directional && light.directional.delta();
    if (is_delta || !reservoirs_take(lights, id)) continue;
    const LightPoint point{id, direction};
    offer(point, scatter.resampling * weight_of_scatter(source, r, point, scatter.pdf_w, 1.0f));
  }
}

/// The chosen candidate as a reservoir of confidence 1, with p̂ without occlusion. If a candidate is not finite, nor is
/// `weight`.
RELUME_HD inline LightReservoir choose_light(const CandidateSource& source, const Receiver& r,
                                             const FirstScatter& scatter, Sampler& sampler, ChoiceNumbers& numbers) {
  LightReservoir chosen;
  WeightedChoice choice;
  const auto offer = [&](const LightPoint& point, float weight) {
    if (choice.offer(weight, numbers.next())) chosen.sample = point;
  };
  for (uint32_t i = 0; i < source.light_candidates; ++i) {
    sampler.start_dimension(kCandidateDimension + i);
    LightPoint point;
    offer(point, draw_from_selection(source, r, sampler, point));
  }
  offer_scatter(source, r, scatter, offer);
  chosen.confidence = 1;
  if (!is_finite(choice.sum)) {
    chosen.weight = choice.sum;
    return chosen;
  }
  if (!chosen.sample.valid()) return chosen;
  uint32_t rays = 0;
  const SceneView& scene = source.context.scene;
  chosen.target = target_at(scene, scene.lights, r, chosen.sample, false, rays);
  chosen.weight = chosen.target > 0.0f ? choice.sum / chosen.target : 0.0f;
  return chosen;
}

}  // namespace relume
