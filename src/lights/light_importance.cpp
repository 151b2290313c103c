#include "lights/light_importance.h"

namespace relume {
namespace {

CompactLight compact_form(const LightsView& view, const Light& light) {
  CompactLight compact;
  if (light.kind != LightKind::triangle) {
    compact.emission = CompactLight::kPunctual;
    return compact;
  }
  const TriangleLight& t = light.triangle;
  compact.centre = t.position(t.centre());
  compact.twice_area = 2.0f * t.area * t.normal;
  float radius2 = 0;
  for (const Vec3& corner : {t.v0, t.v0 + t.e1, t.v0 + t.e2})
    radius2 = max(radius2, length_squared(corner - compact.centre));
  compact.radius = t.two_sided ? -std::sqrt(radius2) : std::sqrt(radius2);
  const Rgb mean = t.textured < 0 ? Rgb(1) : view.textured.triangles[static_cast<uint32_t>(t.textured)].mean_emission;
  compact.emission = luminance(t.radiance * mean);
  return compact;
}

}  // namespace

std::vector<CompactLight> compact_lights(const LightsView& view) {
  std::vector<CompactLight> compact;
  compact.reserve(view.first_infinite);
  for (LightId i = 0; i < view.first_infinite; ++i) compact.push_back(compact_form(view, view.lights[i]));
  return compact;
}

}  // namespace relume
