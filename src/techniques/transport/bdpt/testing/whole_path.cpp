#include "techniques/transport/bdpt/testing/whole_path.h"

#include <cmath>

namespace relume::testing {

template <typename Context>
SurfacePoint seen(const Context& c, const Place& place, const Vec3& wo) {
  SurfacePoint sp;
  make_surface_point(c.scene(), {place.position, -wo, kInfinity}, place.hit, 0.0f, sp, kZooWavelength);
  find_region(c, sp);
  return sp;
}

template <typename Context>
TracedLight trace_light(const Context& c, Sampler& sampler) {
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

template <typename Context>
TracedCamera trace_camera(const Context& c, uint32_t x, uint32_t y, Sampler& sampler,
                          const std::function<void(const SurfacePoint&)>& at_vertex, uint32_t restart) {
  TracedCamera t;
  CameraSubpath e;
  NoRecorder recorder;
  NoPolicy policy;
  start_camera_subpath(c, x, y, sampler, e);
  e.path.wavelength_nm = kZooWavelength;
  t.ray = e.path.ray;
  for (Hit hit = intersect(c.scene().accel, e.path.ray, 0); hit.valid() && e.count() < 7;
       hit = intersect(c.scene().accel, e.path.ray, sampler.ray_id())) {
    SurfacePoint sp;
    make_surface_point(c.scene(), e.path.ray, hit, 0.0f, sp, kZooWavelength);
    if constexpr (Context::kLearns) sp.region = c.recording.lookup.region_at(sp);
    e.weights.arrive(glm::dot(sp.ng, sp.wo), sqr(hit.t));
    if (e.count() == restart) e.weights.restart();
    sampler.start_dimension(kCameraDimensions + e.path.bounce * kDimensionsPerBounce);
    t.places.push_back({hit, sp.position, sp.ng, false});
    t.states.push_back(e);
    at_vertex(sp);
    if (sp.bsdf.empty() || !continue_camera_subpath(c, sp, e, sampler, recorder, policy)) break;
    t.places.back().delta = e.path.delta;
  }
  return t;
}

template <typename Context>
Densities<Context>::Densities(const Context& c, const WholePath& path, double eta, size_t least_camera)
    : c_(c), path_(path), eta_(eta), least_camera_(least_camera), k_(path.surfaces.size() + 1) {
  light_.assign(k_ + 1, 0);
  camera_.assign(k_ + 1, 0);
  ends();
  for (size_t i = 1; i < k_; ++i) scatter(i);
}

template <typename Context>
double Densities<Context>::of(size_t s) const {
  if (s + least_camera_ > k_ + 1) return 0;
  if (s == 0 && !path_.light_can_be_hit) return 0;
  if (s == k_ + 1 && !path_.camera_can_be_hit) return 0;
  if (s > 1 && s <= k_ && delta(s - 1)) return 0;  // x(s − 1) cannot be connected
  if (s >= 1 && s < k_ && delta(s)) return 0;      // xs cannot be connected
  double p = samples(s);
  for (size_t i = 0; i <= k_; ++i) p *= i < s ? light_[i] : camera_[i];
  const double direct = static_cast<double>(weighting_pmf(c_, path_.light) / c_.emission.pmf(path_.light));
  return s == 1 ? p * direct : p;
}

template <typename Context>
double Densities<Context>::samples(size_t s) const {
  if (s >= k_) return static_cast<double>(c_.light_paths);
  return s >= 2 ? std::sqrt(static_cast<double>(c_.connected)) : 1.0;
}

template <typename Context>
double Densities<Context>::of_merging(size_t i) const {
  if (delta(i) || i + least_camera_ > k_ + 1) return 0;
  double p = eta_;
  for (size_t j = 0; j <= i; ++j) p *= light_[j];
  for (size_t j = i; j <= k_; ++j) p *= camera_[j];
  return p;
}

template <typename Context>
double Densities<Context>::sum_of_squares() const {
  double sum = 0;
  for (size_t j = 0; j <= k_ + 1; ++j) sum += of(j) * of(j);
  for (size_t i = 1; i < k_; ++i) sum += of_merging(i) * of_merging(i);
  return sum;
}

template <typename Context>
double Densities<Context>::weight(size_t s) const {
  return of(s) * of(s) / sum_of_squares();
}

template <typename Context>
double Densities<Context>::weight_of_merging(size_t i) const {
  return of_merging(i) * of_merging(i) / sum_of_squares();
}

template <typename Context>
Vec3 Densities<Context>::position(size_t i) const {
  return i == 0 ? path_.on_light.position : (i == k_ ? path_.camera : path_.surfaces[i - 1].position);
}

template <typename Context>
Vec3 Densities<Context>::towards(size_t from, size_t to) const {
  if (path_.infinite && from == 0) return path_.from_light;
  if (path_.infinite && to == 0) return -path_.from_light;
  return glm::normalize(position(to) - position(from));
}

/// Converts a density per solid angle at `from` to one per area at `to`.
template <typename Context>
double Densities<Context>::per_area(size_t from, size_t to) const {
  if (path_.infinite && (from == 0 || to == 0)) return to == 0 ? 1 : cosine(to, from);
  return cosine(to, from) / static_cast<double>(length_squared(position(to) - position(from)));
}

template <typename Context>
double Densities<Context>::cosine(size_t at, size_t other) const {
  const Vec3 w = towards(at, other);
  Vec3 n(0);
  if (at == 0) n = path_.light_normal;
  if (at == k_ && c_.scene().camera.projection == Projection::perspective) n = c_.scene().camera.axes.n;
  if (at > 0 && at < k_) n = path_.surfaces[at - 1].ng;
  return is_black(n) ? 1.0 : std::fabs(static_cast<double>(glm::dot(n, w)));
}

template <typename Context>
void Densities<Context>::ends() {
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

template <typename Context>
void Densities<Context>::scatter(size_t i) {
  const Vec3 to_light = towards(i, i - 1);
  const Vec3 to_camera = towards(i, i + 1);
  const SurfacePoint from_light = seen(c_, path_.surfaces[i - 1], to_light);
  const SurfacePoint from_camera = seen(c_, path_.surfaces[i - 1], to_camera);
  const GuidedPoint guide = guided_point(c_, from_camera);
  double by_light = 1;
  double by_camera = 1;
  if (delta(i)) {
    by_light = static_cast<double>(light_fraction(c_, guide));
    by_camera = static_cast<double>(delta_density_ratio(from_light, to_camera) * guide.fraction);
  } else {
    const bool same_frame = same_shading_frame(from_light, to_camera) && same_shading_frame(from_camera, to_light);
    const float from_bsdf = same_frame ? eval_pdf(from_light, to_camera).pdf_forward : 0.0f;
    by_light = static_cast<double>(light_pdf(c_, guide, to_camera, from_bsdf));
    by_camera = static_cast<double>(camera_pdf(c_, guide, to_light, eval_pdf(from_camera, to_light).pdf_forward));
  }
  if (i + 1 <= k_) light_[i + 1] = by_light * per_area(i, i + 1);
  camera_[i - 1] = by_camera * per_area(i, i - 1);
}

template SurfacePoint seen(const BdptContext&, const Place&, const Vec3&);
template SurfacePoint seen(const LearningContext&, const Place&, const Vec3&);
template TracedLight trace_light(const BdptContext&, Sampler&);
template TracedLight trace_light(const LearningContext&, Sampler&);
template TracedCamera trace_camera(const BdptContext&, uint32_t, uint32_t, Sampler&,
                                   const std::function<void(const SurfacePoint&)>&, uint32_t);
template TracedCamera trace_camera(const LearningContext&, uint32_t, uint32_t, Sampler&,
                                   const std::function<void(const SurfacePoint&)>&, uint32_t);
template class Densities<BdptContext>;
template class Densities<LearningContext>;

}  // namespace relume::testing
