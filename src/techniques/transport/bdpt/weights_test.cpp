// Compares the incremental weights of the subpaths with weights from all strategies' densities of the whole path.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "techniques/transport/bdpt/testing/bdpt_frame.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

/// A surface vertex, and whether its subpath scattered there by a delta lobe.
struct Place {
  Hit hit;
  Vec3 position;
  Vec3 ng;
  bool delta = false;
};

struct TracedLight {
  EmissionSample emission;
  LightId light = kNoLight;
  std::vector<Place> places;
  std::vector<LightSubpath> states;  ///< state on arrival at each vertex
};

struct TracedCamera {
  Ray ray;  ///< camera ray
  std::vector<Place> places;
  std::vector<CameraSubpath> states;
};

/// Surface point of a vertex for a viewer along `wo`.
SurfacePoint seen(const SceneView& scene, const Place& place, const Vec3& wo) {
  SurfacePoint sp;
  make_surface_point(scene, {place.position, -wo, kInfinity}, place.hit, 0.0f, sp, kZooWavelength);
  return sp;
}

TracedLight trace_light(const BdptContext& c, Sampler& sampler) {
  TracedLight t;
  LightSubpath l;
  Sampler copy = sampler;
  if (!start_light_subpath(c, sampler, l)) return t;
  l.path.wavelength_nm = kZooWavelength;
  copy.start_dimension(kLightDimensions);
  t.light = c.emission.sample(copy.reusable(copy.next_1d())).light;
  const Vec2 u = copy.next_2d();
  t.emission = sample_le(c.scene().lights, t.light, u, copy.next_2d());
  while (l.count < 6) {
    const Hit hit = intersect(c.scene().accel, l.path.ray, sampler.ray_id());
    SurfacePoint sp;
    if (!hit.valid() || !arrive(c, hit, l, sp)) break;
    sampler.start_dimension(kLightDimensions + l.count * kLightDimensionsPerVertex);
    t.places.push_back({hit, sp.position, sp.ng, false});
    t.states.push_back(l);
    if (!continue_light_subpath(c, sp, l, sampler)) break;
    t.places.back().delta = l.path.delta;
  }
  return t;
}

TracedCamera trace_camera(const BdptContext& c, uint32_t x, uint32_t y, Sampler& sampler) {
  TracedCamera t;
  CameraSubpath e;
  start_camera_subpath(c, x, y, sampler, e);
  e.path.wavelength_nm = kZooWavelength;
  t.ray = e.path.ray;
  for (Hit hit = intersect(c.scene().accel, e.path.ray, 0); hit.valid() && e.count() < 7;
       hit = intersect(c.scene().accel, e.path.ray, sampler.ray_id())) {
    SurfacePoint sp;
    make_surface_point(c.scene(), e.path.ray, hit, 0.0f, sp, kZooWavelength);
    e.weights.arrive(glm::dot(sp.ng, sp.wo), sqr(hit.t));
    sampler.start_dimension(kCameraDimensions + e.path.bounce * kDimensionsPerBounce);
    t.places.push_back({hit, sp.position, sp.ng, false});
    t.states.push_back(e);
    if (sp.bsdf.empty() || !continue_camera_subpath(c, sp, e, sampler)) break;
    t.places.back().delta = e.path.delta;
  }
  return t;
}

/// All inputs to the densities of a whole path, from the light over surfaces to the camera.
struct WholePath {
  LightId light;
  bool infinite;
  bool light_can_be_hit;
  EmitterPoint on_light;
  Vec3 from_light;  ///< towards the first surface
  Vec3 light_normal{0};
  std::vector<Place> surfaces;
  Vec3 camera;
  bool camera_can_be_hit;
};

/// p_s for s = 0 … k + 1, zero for impossible strategies.
class Densities {
 public:
  Densities(const BdptContext& c, const WholePath& path) : c_(c), path_(path), k_(path.surfaces.size() + 1) {
    light_.assign(k_ + 1, 0);
    camera_.assign(k_ + 1, 0);
    ends();
    for (size_t i = 1; i < k_; ++i) scatter(i);
  }

  double of(size_t s) const {
    if (s == 0 && !path_.light_can_be_hit) return 0;
    if (s == k_ + 1 && !path_.camera_can_be_hit) return 0;
    if (s > 1 && s <= k_ && delta(s - 1)) return 0;  // x(s − 1) cannot be connected
    if (s >= 1 && s < k_ && delta(s)) return 0;      // xs cannot be connected
    double p = 1;
    for (size_t i = 0; i <= k_; ++i) p *= i < s ? light_[i] : camera_[i];
    const double direct = static_cast<double>(weighting_pmf(c_, path_.light) / c_.emission.pmf(path_.light));
    return s == 1 ? p * direct : p;
  }

  double weight(size_t s) const {
    double sum = 0;
    for (size_t j = 0; j <= k_ + 1; ++j) sum += of(j) * of(j);
    return of(s) * of(s) / sum;
  }

 private:
  bool delta(size_t i) const { return i >= 1 && i < k_ && path_.surfaces[i - 1].delta; }
  Vec3 position(size_t i) const {
    return i == 0 ? path_.on_light.position : (i == k_ ? path_.camera : path_.surfaces[i - 1].position);
  }
  Vec3 towards(size_t from, size_t to) const {
    if (path_.infinite && from == 0) return path_.from_light;
    if (path_.infinite && to == 0) return -path_.from_light;
    return glm::normalize(position(to) - position(from));
  }
  /// Converts a density per solid angle at `from` to one per area at `to`.
  double per_area(size_t from, size_t to) const {
    if (path_.infinite && (from == 0 || to == 0)) return to == 0 ? 1 : cosine(to, from);
    return cosine(to, from) / static_cast<double>(length_squared(position(to) - position(from)));
  }
  double cosine(size_t at, size_t other) const {
    const Vec3 w = towards(at, other);
    Vec3 n(0);
    if (at == 0) n = path_.light_normal;
    if (at == k_ && c_.scene().camera.projection == Projection::perspective) n = c_.scene().camera.axes.n;
    if (at > 0 && at < k_) n = path_.surfaces[at - 1].ng;
    return is_black(n) ? 1.0 : std::fabs(static_cast<double>(glm::dot(n, w)));
  }

  void ends() {
    const EmissionPdf le = pdf_le(c_.scene().lights, path_.light, path_.on_light, path_.from_light);
    const double pmf = static_cast<double>(c_.emission.pmf(path_.light));
    const bool point = !path_.infinite && !path_.light_can_be_hit;
    const bool parallel_delta = path_.infinite && !path_.light_can_be_hit;
    light_[0] = pmf * (point || parallel_delta ? 1.0 : static_cast<double>(path_.infinite ? le.pdf_w : le.pdf_a));
    light_[1] = static_cast<double>(path_.infinite ? le.pdf_a : le.pdf_w) * per_area(0, 1);
    const Ray out{path_.camera, towards(k_, k_ - 1), kInfinity};
    const CameraPdf we = pdf_of_generated(c_.scene().camera, out);
    if (c_.scene().camera.projection == Projection::orthographic) {
      camera_[k_] = 1;
      camera_[k_ - 1] = static_cast<double>(we.pdf_a) * cosine(k_ - 1, k_);
    } else {
      camera_[k_] = static_cast<double>(we.pdf_a);
      camera_[k_ - 1] = static_cast<double>(we.pdf_w) * per_area(k_, k_ - 1);
    }
  }

  void scatter(size_t i) {
    const Vec3 to_light = towards(i, i - 1);
    const Vec3 to_camera = towards(i, i + 1);
    const SurfacePoint from_light = seen(c_.scene(), path_.surfaces[i - 1], to_light);
    const SurfacePoint from_camera = seen(c_.scene(), path_.surfaces[i - 1], to_camera);
    double by_light = 1;
    double by_camera = 1;
    if (delta(i)) {
      by_camera = static_cast<double>(delta_density_ratio(from_light, to_camera));
    } else {
      const bool same_frame = same_shading_frame(from_light, to_camera) && same_shading_frame(from_camera, to_light);
      by_light = same_frame ? static_cast<double>(eval_pdf(from_light, to_camera).pdf_forward) : 0.0;
      by_camera = static_cast<double>(eval_pdf(from_camera, to_light).pdf_forward);
    }
    if (i + 1 <= k_) light_[i + 1] = by_light * per_area(i, i + 1);
    camera_[i - 1] = by_camera * per_area(i, i - 1);
  }

  const BdptContext& c_;
  const WholePath& path_;
  size_t k_;
  std::vector<double> light_;
  std::vector<double> camera_;
};

enum Strategy : int { kVertexConnection, kCameraConnection, kLightConnection, kLightMet, kLensMet, kKinds };

/// Compares the weights of all strategies on random paths of one scene.
class WeightCheck {
 public:
  WeightCheck(ZooLight light, ZooCamera camera, LightSelectorKind selector)
      : frame_(dispersive(make_zoo(light, camera), 10), options(selector)), c_(frame_.context()) {}

  void run(uint32_t samples) {
    for (uint32_t i = 0; i < samples; ++i) {
      Sampler sampler = Sampler::sequence(7, i % 16, i / 16 % 16, i / 256);
      const TracedLight light = trace_light(c_, sampler);
      Sampler other = Sampler::sequence(8, i % 16, i / 16 % 16, i / 256);
      const TracedCamera camera = trace_camera(c_, i % 16, i / 16 % 16, other);
      if (light.light != kNoLight) {
        for (size_t s = 1; s <= light.places.size(); ++s) {
          to_camera(light, s, other);
          for (size_t t = 1; t <= camera.places.size(); ++t) to_vertex(light, s, camera, t);
        }
      }
      for (size_t t = 1; t <= camera.places.size(); ++t) {
        to_light(camera, t, other);
        if (t > 1) light_met(camera, t);
      }
    }
  }

  int compared[kKinds] = {};
  int wrong[kKinds] = {};
  std::string example;  ///< last wrong weight

 private:
  static BdptOptions options(LightSelectorKind selector) {
    BdptOptions o;
    o.lights = selector;
    o.russian_roulette = false;
    o.max_light_vertices = kMaxLightVertices;
    o.max_bounces = 32;
    return o;
  }

  void compare(float weight, const WholePath& path, size_t s, Strategy kind) {
    const double expected = Densities(c_, path).weight(s);
    if (!(std::fabs(static_cast<double>(weight) - expected) <= 1e-4 + 0.02 * expected)) {
      ++wrong[kind];
      example = "weight " + std::to_string(weight) + " should be " + std::to_string(expected) +
                ", s = " + std::to_string(s) + " of " + std::to_string(path.surfaces.size() + 2);
    }
    ++compared[kind];
  }

  WholePath from(const TracedLight& t, size_t places) const {
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

  Vec2 barycentric(const TracedLight& t) const {
    const Light& light = c_.scene().lights.lights[t.light];
    if (light.kind != LightKind::triangle) return Vec2(0);
    // Least-squares solution in the plane of the triangle.
    const TriangleLight& tri = light.triangle;
    const Vec3 d = t.emission.origin - tri.v0;
    const Vec3 n = glm::cross(tri.e1, tri.e2);
    return {glm::dot(glm::cross(d, tri.e2), n) / length_squared(n),
            glm::dot(glm::cross(tri.e1, d), n) / length_squared(n)};
  }

  void set_camera(WholePath& path, const Vec3& position) const {
    path.camera = position;
    path.camera_can_be_hit = c_.scene().camera.lens_radius > 0.0f;
  }

  static void append_reversed(WholePath& path, const TracedCamera& t, size_t places) {
    for (size_t i = places; i-- > 0;) path.surfaces.push_back(t.places[i]);
  }

  void to_vertex(const TracedLight& light, size_t s, const TracedCamera& camera, size_t t) {
    const SurfacePoint y = seen(c_.scene(), light.places[s - 1], -light.states[s - 1].path.ray.direction);
    const SurfacePoint z = seen(c_.scene(), camera.places[t - 1], -camera.states[t - 1].path.ray.direction);
    if (!has_non_delta(y.bsdf) || !has_non_delta(z.bsdf)) return;
    const Vec3 d = y.position - z.position;
    const float d2 = length_squared(d);
    if (!(d2 > 1e-3f)) return;
    const Vec3 w = glm::normalize(d);
    const LightSubpath& l = light.states[s - 1];
    const PathVertex v = make_path_vertex(y, l.path.throughput, l.weights.at(), Dispersion::none);
    const BsdfEval bsdf = eval_camera_vertex(camera.states[t - 1], z, w);
    const AdjointEval adjoint = eval_vertex(c_.scene(), v, -w, kZooWavelength);
    if (is_black(bsdf.f) || is_black(adjoint.f)) return;
    WholePath path = from(light, s);
    path.surfaces.back().delta = false;
    append_reversed(path, camera, t);
    path.surfaces[s].delta = false;
    set_camera(path, camera.ray.origin);
    compare(weight_of_vertex_connection(z, camera.states[t - 1], bsdf, v, adjoint, w, d2), path, s + 1,
            kVertexConnection);
  }

  void to_camera(const TracedLight& light, size_t s, Sampler& sampler) {
    const LightSubpath& l = light.states[s - 1];
    const SurfacePoint sp = seen(c_.scene(), light.places[s - 1], -l.path.ray.direction);
    if (!has_non_delta(sp.bsdf)) return;
    const CameraSample sample = sample_wi(c_.scene().camera, sp.position, sampler.next_2d());
    if (!sample.valid()) return;
    const AdjointEval e = eval_adjoint(sp, sample.wi);
    if (is_black(e.f)) return;
    WholePath path = from(light, s);
    path.surfaces.back().delta = false;
    set_camera(path, sp.position + sample.wi * sample.distance);
    const float pdf_a = std::fabs(glm::dot(sp.ng, sample.wi)) * sample.importance / sample.pdf_w;
    compare(weight_of_camera_connection(l, sample, e, pdf_a), path, s + 1, kCameraConnection);
    if (sample.delta || !(e.pdf_light > 0.0f)) return;
    // Meets the lens by continuing in this direction.
    LightSubpath onwards = l;
    onwards.weights.leave(std::fabs(glm::dot(sp.ng, sample.wi)), e.pdf_light, e.pdf_camera);
    const LensHit hit = meet_lens(c_.scene().camera, {sp.position, sample.wi, kInfinity});
    if (!(hit.importance > 0.0f)) return;
    compare(weight_of_lens_hit(c_.scene().camera, onwards, hit), path, s + 2, kLensMet);
  }

  void to_light(const TracedCamera& camera, size_t t, Sampler& sampler) {
    const CameraSubpath& e = camera.states[t - 1];
    const SurfacePoint sp = seen(c_.scene(), camera.places[t - 1], -e.path.ray.direction);
    if (!has_non_delta(sp.bsdf)) return;
    const LightPick pick = pick_light(c_.path, sp, sampler);
    const LightSample light = sample_picked(c_.path, sp, pick);
    if (!light.valid()) return;
    const BsdfEval bsdf = eval_camera_vertex(e, sp, light.wi);
    if (is_black(bsdf.f)) return;
    WholePath path = path_to_light(camera, t, pick.id, {light.position, light.barycentric}, -light.wi);
    path.light_can_be_hit = !light.delta;
    path.surfaces.front().delta = false;
    compare(weight_of_light_connection(c_, sp, e, pick, light, bsdf), path, 1, kLightConnection);
  }

  /// Compares the weight where vertex `t` is on a light.
  void light_met(const TracedCamera& camera, size_t t) {
    const CameraSubpath& e = camera.states[t - 1];
    const SurfacePoint sp = seen(c_.scene(), camera.places[t - 1], -e.path.ray.direction);
    if (is_black(sp.emission) || sp.light == kNoLight) return;
    const EmissionPdf pdf = pdf_le(c_.scene().lights, sp.light, sp.emitter_point(), sp.wo);
    const WholePath path = path_to_light(camera, t - 1, sp.light, sp.emitter_point(), sp.wo);
    compare(weight_of_light_hit(c_, e, e.weights.at(), light_densities(c_, sp.light, pdf.pdf_a), pdf.pdf_w), path, 0,
            kLightMet);
  }

  WholePath path_to_light(const TracedCamera& camera, size_t places, LightId id, const EmitterPoint& on_light,
                          const Vec3& from_light) const {
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

  BdptFrame frame_;
  BdptContext c_;
};

/// Allows for rounding: a direction may fall into the neighbouring texel of an environment, which has another density.
void expect_few_wrong(const WeightCheck& check) {
  for (int kind = 0; kind < kKinds; ++kind)
    EXPECT_LE(check.wrong[kind] * 1000, check.compared[kind]) << "strategy " << kind << ": " << check.example;
}

TEST(BdptWeights, MatchTheProductsOfAllDensities) {
  int compared[kKinds] = {};
  for (const ZooLight light : kZooLights) {
    if (light == ZooLight::constant) continue;  // found by s = 0 only: a single strategy
    for (const ZooCamera camera : kZooCameras) {
      SCOPED_TRACE(std::string(kZooLightNames[static_cast<int>(light)]) + " " +
                   kZooCameraNames[static_cast<int>(camera)]);
      WeightCheck check(light, camera, LightSelectorKind::power);
      check.run(2048);
      expect_few_wrong(check);
      EXPECT_GT(check.compared[kCameraConnection], 100);
      EXPECT_GT(check.compared[kLightConnection], 30);
      for (int kind = 0; kind < kKinds; ++kind) compared[kind] += check.compared[kind];
    }
  }
  EXPECT_GT(compared[kVertexConnection], 5000);
  EXPECT_GT(compared[kLightMet], 100);
  EXPECT_GT(compared[kLensMet], 100);
}

TEST(BdptWeights, AccountForLightSelectionOfConnections) {
  WeightCheck check(ZooLight::mixed, ZooCamera::pinhole, LightSelectorKind::uniform);
  check.run(4096);
  expect_few_wrong(check);
  EXPECT_GT(check.compared[kLightConnection], 1000);
  EXPECT_GT(check.compared[kLightMet], 10);
}

}  // namespace
}  // namespace relume::testing
