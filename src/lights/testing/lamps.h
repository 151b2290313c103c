// Many lights for tests of light selection.
#pragma once

#include <vector>

#include "core/hash.h"
#include "lights/light.h"

namespace relume::testing {

/// Triangles of radiance 1 under a ceiling at 3 m, spread over `edge` × `edge` metres.
inline std::vector<Light> make_lamps(uint32_t count, float edge) {
  std::vector<Light> lights(count);
  for (uint32_t i = 0; i < count; ++i) {
    const auto random = [i](uint32_t k) { return to_unit_float(hash(i, k)); };
    TriangleLight t{};
    t.v0 = {edge * random(0), 3, edge * random(1)};
    t.e1 = {0.3f, 0, 0};
    t.e2 = {0, 0, 0.3f};
    t.normal = {0, -1, 0};
    t.area = 0.045f;
    t.radiance = Rgb(1);
    t.textured = -1;
    lights[i].kind = LightKind::triangle;
    lights[i].triangle = t;
  }
  return lights;
}

}  // namespace relume::testing
