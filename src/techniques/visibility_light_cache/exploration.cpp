#include "techniques/visibility_light_cache/exploration.h"

#include <algorithm>

namespace relume {
namespace {

Vec3 position_of(const Light& light) {
  switch (light.kind) {
    case LightKind::triangle: return light.triangle.position(Vec2(1.0f / 3.0f));
    case LightKind::point: return light.point.position;
    case LightKind::spot: return light.spot.position;
    case LightKind::directional:
    case LightKind::environment: break;
  }
  return Vec3(0);
}

}  // namespace

std::vector<AliasEntry> build_exploration(const LightsView& lights, const Vec3& camera,
                                          const ExplorationWeights& weights) {
  const uint32_t count = lights.first_infinite;
  std::vector<float> guesses[3];
  for (std::vector<float>& guess : guesses) guess.assign(count, 0.0f);
  // Nearer than a hundredth of the scene is as good as here.
  const float nearest2 = sqr(0.01f * lights.bounds.radius);
  for (LightId i = 0; i < count; ++i) {
    const float watts = luminance(power(lights, i));
    if (!(watts > 0.0f)) continue;
    guesses[0][i] = watts;
    guesses[1][i] = lights.lights[i].changed ? 1.0f : 0.0f;
    guesses[2][i] = 1.0f / std::max(length_squared(position_of(lights.lights[i]) - camera), nearest2);
  }
  const float shares[3] = {weights.energy, weights.change, weights.distance};
  std::vector<float> blend(count, 0.0f);
  for (int g = 0; g < 3; ++g) {
    double sum = 0;
    for (const float w : guesses[g]) sum += static_cast<double>(w);
    if (!(sum > 0)) continue;
    for (LightId i = 0; i < count; ++i)
      blend[i] += shares[g] * static_cast<float>(static_cast<double>(guesses[g][i]) / sum);
  }
  return build_alias_table(blend);
}

}  // namespace relume
