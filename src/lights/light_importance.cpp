#include "lights/light_importance.h"

namespace relume {

std::vector<float> build_light_columns(const LightsView& view) {
  const uint32_t count = view.first_infinite;
  std::vector<float> values(size_t{LightColumns::count} * count, 0.0f);
  for (LightId i = 0; i < count; ++i) {
    const Light& light = view.lights[i];
    if (light.kind != LightKind::triangle) continue;
    const TriangleLight& t = light.triangle;
    const auto put = [&](uint32_t column, float value) { values[size_t{column} * count + i] = value; };
    const Vec3 centre = t.position(t.centre());
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<uint32_t>(axis);
      put(LightColumns::centre + k, centre[axis]);
      put(LightColumns::twice_area + k, 2.0f * t.area * t.normal[axis]);
    }
    float radius2 = 0;
    for (const Vec3& corner : {t.v0, t.v0 + t.e1, t.v0 + t.e2}) radius2 = max(radius2, length_squared(corner - centre));
    put(LightColumns::radius, std::sqrt(radius2));
    const Rgb mean = t.textured < 0 ? Rgb(1) : view.textured.triangles[static_cast<uint32_t>(t.textured)].mean_emission;
    put(LightColumns::emission, luminance(t.radiance * mean));
    put(LightColumns::two_sided, t.two_sided ? 1.0f : 0.0f);
  }
  return values;
}

}  // namespace relume
