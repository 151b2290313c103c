#include "scene/view_lighting.h"

#include <vector>

#include "core/hash.h"
#include "core/parallel.h"
#include "sampling/alias_table.h"
#include "scene/surface_point.h"

namespace relume {
namespace {

constexpr uint32_t kColumns = 24;
constexpr uint32_t kRows = 16;
constexpr uint32_t kSamples = 32;  // per pixel and group of lights
constexpr float kShadowMargin = 1e-3f;

/// Lights [first, end), chosen in proportion to their power.
class LightGroup {
 public:
  LightGroup(const LightsView& lights, LightId first, LightId end) : first_(first) {
    std::vector<float> weights;
    for (LightId id = first; id < end; ++id) weights.push_back(selection_weight(lights, id));
    entries_ = build_alias_table(weights);
  }

  /// Luminance of the direct irradiance on the visible side of the surface.
  float irradiance(const SceneView& scene, const SurfacePoint& sp, uint32_t pixel) const {
    const AliasTable table{view_of(entries_)};
    if (table.empty()) return 0;
    float sum = 0;
    for (uint32_t i = 0; i < kSamples; ++i) {
      const float stratum = (static_cast<float>(i) + to_unit_float(hash(pixel, i, 0u))) / kSamples;
      const DiscreteSample light = table.sample({stratum, hash(pixel, i, 1u)});
      const Vec2 u(to_unit_float(hash(pixel, i, 2u)), to_unit_float(hash(pixel, i, 3u)));
      const LightSample s = sample_li(scene.lights, first_ + light.index, sp.position, u);
      const float cosine = glm::dot(sp.frame.n, s.wi);
      if (!s.valid() || !(cosine > 0.0f)) continue;
      Ray ray = sp.spawn_ray(s.wi);
      ray.t_max = s.distance * (1.0f - kShadowMargin) - s.clearance;
      if (ray.t_max > 0.0f && occluded(scene.accel, ray, pixel)) continue;
      sum += luminance(s.radiance) * cosine / (s.pdf_w * light.pmf);
    }
    return sum / kSamples;
  }

 private:
  LightId first_;
  std::vector<AliasEntry> entries_;
};

}  // namespace

ViewLighting estimate_view_lighting(const SceneView& scene) {
  const LightGroup finite(scene.lights, 0, scene.lights.first_infinite);
  const LightGroup infinite(scene.lights, scene.lights.first_infinite, scene.lights.lights.size);
  std::vector<ViewLighting> pixels(kColumns * kRows);
  parallel_for(pixels.size(), [&](size_t i) {
    const auto pixel = static_cast<uint32_t>(i);
    const Vec2 cell(static_cast<float>(pixel % kColumns) + 0.5f, static_cast<float>(pixel / kColumns) + 0.5f);
    const Vec2 raster = cell / Vec2(kColumns, kRows) * scene.camera.resolution;
    const Ray ray = generate(scene.camera, raster, Vec2(0.5f));
    const Hit hit = intersect_from_camera(scene.accel, ray, pixel);
    if (!hit.valid()) return;
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, 0.0f, sp);
    const float near_light = finite.irradiance(scene, sp, pixel);
    const float far_light = infinite.irradiance(scene, sp, pixel);
    pixels[i] = {near_light, far_light, relume::min(near_light, far_light)};
  });
  ViewLighting sum;
  for (const ViewLighting& pixel : pixels) {
    sum.finite += pixel.finite;
    sum.infinite += pixel.infinite;
    sum.comparable += pixel.comparable;
  }
  return sum;
}

}  // namespace relume
