#include "techniques/transport/bdpt/testing/weight_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "techniques/guiding/markov_chain/testing/random_states.h"

namespace relume::testing {
namespace {

BdptOptions options(LightSelectorKind selector) {
  BdptOptions o;
  o.lights = selector;
  o.russian_roulette = false;
  o.max_light_vertices = kMaxLightVertices;
  o.max_bounces = 32;
  return o;
}

void append_reversed(WholePath& path, const TracedCamera& t, size_t places) {
  for (size_t i = places; i-- > 0;) path.surfaces.push_back(t.places[i]);
}

}  // namespace

template <typename Context>
WeightCheckOf<Context>::WeightCheckOf(ZooLight light, ZooCamera camera, LightSelectorKind selector,
                                      const AssumedNumbers& numbers)
    : numbers_(numbers), frame_(dispersive(make_zoo(light, camera), 10), options(selector)), c_{frame_.context()} {
  if constexpr (Context::kLearns) {
    guides_.emplace(frame_.backend, c_.scene());
    guides_->guide(c_, 1);
  }
  c_.merging = sqr(numbers.eta);
  c_.light_paths = numbers.light_paths;
  c_.connected = sqr(numbers.connections);
}

template <typename Context>
void WeightCheckOf<Context>::guide_by_chains() {
  DirectionSampler directions;
  directions.kind = DirectionSamplerKind::markov_chains;
  directions.chains = {.grid = chains_.grid, .table = chains_.view(), .bsdf_fraction = 0.3f};
  c_.path.directions = directions;
  c_.weighs_guide = false;
}

template <typename Context>
void WeightCheckOf<Context>::fill_chains(const SurfacePoint& sp) {
  if (c_.path.directions.kind != DirectionSamplerKind::markov_chains) return;
  chains_.fill(sp, [](uint32_t number) { return random_state(number); });
  MarkovLobes lobes;
  c_.path.directions.chains.add_lobes(sp, lobes);
  guided += lobes.empty() ? 0 : 1;
}

template <typename Context>
void WeightCheckOf<Context>::run(uint32_t samples) {
  for (uint32_t i = 0; i < samples; ++i) {
    Sampler sampler = Sampler::sequence(7, i % 16, i / 16 % 16, i / 256);
    const TracedLight light = trace_light(c_, sampler);
    Sampler other = Sampler::sequence(8, i % 16, i / 16 % 16, i / 256);
    const TracedCamera camera = trace_camera(
        c_, i % 16, i / 16 % 16, other, [this](const SurfacePoint& sp) { fill_chains(sp); }, numbers_.least_camera);
    const size_t first = std::max(numbers_.least_camera, 2u) - 1;
    if (light.light != kNoLight) {
      for (size_t s = 1; s <= light.places.size(); ++s) {
        if (numbers_.least_camera == 0) to_camera(light, s, other);
        for (size_t t = first; t <= camera.places.size(); ++t) {
          to_vertex(light, s, camera, t);
          more(light, s, camera, t);
        }
      }
    }
    for (size_t t = first; t <= camera.places.size(); ++t) {
      to_light(camera, t, other);
      if (t > 1) light_met(camera, t);
    }
  }
}

template <typename Context>
void WeightCheckOf<Context>::expect_few_wrong() const {
  constexpr int kShare = Context::kLearns ? 100 : 1000;  // quadtrees have more edges
  for (int kind = 0; kind < kKinds; ++kind)
    EXPECT_LE(wrong[kind] * kShare, compared[kind]) << "strategy " << kind << ": " << example;
}

template <typename Context>
void WeightCheckOf<Context>::compare(float weight, double expected, const WholePath& path, size_t s, Strategy kind) {
  if (!(std::fabs(static_cast<double>(weight) - expected) <= 1e-4 + 0.02 * expected)) {
    ++wrong[kind];
    example = "weight " + std::to_string(weight) + " should be " + std::to_string(expected) +
              ", s = " + std::to_string(s) + " of " + std::to_string(path.surfaces.size() + 2);
  }
  ++compared[kind];
}

template <typename Context>
WholePath WeightCheckOf<Context>::from(const TracedLight& t, size_t places) const {
  WholePath path;
  path.light = t.light;
  path.infinite = t.emission.infinite;
  path.light_can_be_hit = t.emission.infinite ? !t.emission.delta_direction : !t.emission.delta_position;
  path.on_light = {t.emission.origin, barycentric(t)};
  path.from_light = t.emission.direction;
  path.light_normal = t.emission.infinite ? Vec3(0) : t.emission.normal;
  path.surfaces.assign(t.places.begin(), t.places.begin() + static_cast<long>(places));
  set_camera(path, c_.scene().camera.position);
  return path;
}

template <typename Context>
Vec2 WeightCheckOf<Context>::barycentric(const TracedLight& t) const {
  const Light& light = c_.scene().lights.lights[t.light];
  if (light.kind != LightKind::triangle) return Vec2(0);
  // Least-squares solution in the plane of the triangle.
  const TriangleLight& tri = light.triangle;
  const Vec3 d = t.emission.origin - tri.v0;
  const Vec3 n = glm::cross(tri.e1, tri.e2);
  return {glm::dot(glm::cross(d, tri.e2), n) / length_squared(n),
          glm::dot(glm::cross(tri.e1, d), n) / length_squared(n)};
}

template <typename Context>
void WeightCheckOf<Context>::set_camera(WholePath& path, const Vec3& position) const {
  path.camera = position;
  path.camera_can_be_hit = c_.scene().camera.lens_radius > 0.0f;
}

template <typename Context>
WholePath WeightCheckOf<Context>::joined(const TracedLight& light, size_t places, const TracedCamera& camera,
                                         size_t camera_places) const {
  WholePath path = from(light, places);
  path.surfaces.back().delta = false;
  append_reversed(path, camera, camera_places);
  path.surfaces[places].delta = false;
  set_camera(path, camera.ray.origin);
  return path;
}

template <typename Context>
void WeightCheckOf<Context>::to_vertex(const TracedLight& light, size_t s, const TracedCamera& camera, size_t t) {
  const SurfacePoint y = seen(c_, light.places[s - 1], -light.states[s - 1].path.ray.direction);
  const SurfacePoint z = seen(c_, camera.places[t - 1], -camera.states[t - 1].path.ray.direction);
  if (!has_non_delta(y.bsdf) || !has_non_delta(z.bsdf)) return;
  const Vec3 d = y.position - z.position;
  const float d2 = length_squared(d);
  if (!(d2 > 1e-3f)) return;
  const Vec3 w = glm::normalize(d);
  const LightSubpath& l = light.states[s - 1];
  const PathVertex v = make_path_vertex(y, l.path.throughput, l.weights.at(), Dispersion::none);
  const BsdfEval bsdf = eval_camera_vertex(c_, camera.states[t - 1], z, w);
  const AdjointEval adjoint = eval_light_vertex(c_, v, guided_point(c_, y), -w, kZooWavelength, kShutterMiddle);
  if (is_black(bsdf.f) || is_black(adjoint.f)) return;
  const WholePath path = joined(light, s, camera, t);
  compare(weight_of_vertex_connection(c_, z, camera.states[t - 1], bsdf, v, adjoint, w, d2),
          densities(path).weight(s + 1), path, s + 1, kVertexConnection);
}

template <typename Context>
void WeightCheckOf<Context>::to_camera(const TracedLight& light, size_t s, Sampler& sampler) {
  const LightSubpath& l = light.states[s - 1];
  const SurfacePoint sp = seen(c_, light.places[s - 1], -l.path.ray.direction);
  if (!has_non_delta(sp.bsdf)) return;
  const CameraSample sample = sample_wi(c_.scene().camera, sp.position, sampler.next_2d());
  if (!sample.valid()) return;
  const AdjointEval e = eval_light_vertex(c_, sp, sample.wi);
  if (is_black(e.f)) return;
  WholePath path = from(light, s);
  path.surfaces.back().delta = false;
  set_camera(path, sp.position + sample.wi * sample.distance);
  const float pdf_a = std::fabs(glm::dot(sp.ng, sample.wi)) * sample.importance / sample.pdf_w;
  compare(weight_of_camera_connection(l, sample, e, pdf_a, c_.light_paths), densities(path).weight(s + 1), path, s + 1,
          kCameraConnection);
  if (sample.delta || !(e.pdf_light > 0.0f)) return;
  // Meets the lens by continuing in this direction.
  LightSubpath onwards = l;
  onwards.weights.leave(std::fabs(glm::dot(sp.ng, sample.wi)), e.pdf_light, e.pdf_camera);
  const LensHit hit = meet_lens(c_.scene().camera, {sp.position, sample.wi, kInfinity});
  if (!(hit.importance > 0.0f)) return;
  compare(weight_of_lens_hit(c_, onwards, hit), densities(path).weight(s + 2), path, s + 2, kLensMet);
}

template <typename Context>
void WeightCheckOf<Context>::to_light(const TracedCamera& camera, size_t t, Sampler& sampler) {
  const CameraSubpath& e = camera.states[t - 1];
  const SurfacePoint sp = seen(c_, camera.places[t - 1], -e.path.ray.direction);
  if (!has_non_delta(sp.bsdf)) return;
  const LightPick pick = pick_light(c_.path, sp, sampler);
  const LightSample light = sample_picked(c_.path, sp, pick);
  if (!light.valid()) return;
  const BsdfEval bsdf = eval_camera_vertex(c_, e, sp, light.wi);
  if (is_black(bsdf.f)) return;
  WholePath path = path_to_light(camera, t, pick.id, {light.position, light.barycentric}, -light.wi);
  path.light_can_be_hit = !light.delta;
  path.surfaces.front().delta = false;
  compare(weight_of_light_connection(c_, sp, e, pick, light, bsdf), densities(path).weight(1), path, 1,
          kLightConnection);
}

/// Compares the weight where vertex `t` is on a light.
template <typename Context>
void WeightCheckOf<Context>::light_met(const TracedCamera& camera, size_t t) {
  const CameraSubpath& e = camera.states[t - 1];
  const SurfacePoint sp = seen(c_, camera.places[t - 1], -e.path.ray.direction);
  if (is_black(sp.emission) || sp.light == kNoLight) return;
  const EmissionPdf pdf = pdf_le(c_.scene().lights, sp.light, sp.emitter_point(), sp.wo);
  const WholePath path = path_to_light(camera, t - 1, sp.light, sp.emitter_point(), sp.wo);
  compare(weight_of_light_hit(c_, e, e.weights.at(), light_densities(c_, sp.light, pdf.pdf_a), pdf.pdf_w),
          densities(path).weight(0), path, 0, kLightMet);
}

template <typename Context>
WholePath WeightCheckOf<Context>::path_to_light(const TracedCamera& camera, size_t places, LightId id,
                                                const EmitterPoint& on_light, const Vec3& from_light) const {
  const Light& light = c_.scene().lights.lights[id];
  WholePath path;
  path.light = id;
  path.infinite = id >= c_.scene().lights.first_infinite;
  path.light_can_be_hit = true;
  path.on_light = on_light;
  path.from_light = from_light;
  if (light.kind == LightKind::triangle) path.light_normal = light.triangle.normal;
  append_reversed(path, camera, places);
  set_camera(path, camera.ray.origin);
  return path;
}

template class WeightCheckOf<BdptContext>;
template class WeightCheckOf<LearningContext>;

}  // namespace relume::testing
