#include "techniques/light_sampling/light_selection/infinite_lights.h"

namespace relume {

bool takes_part(const LightsView& lights, LightId light, LightsAtInfinity infinity) {
  const Light& l = lights.lights[light];
  if (infinity == LightsAtInfinity::all) return true;
  if (infinity == LightsAtInfinity::unreachable && l.kind == LightKind::directional) return l.directional.delta();
  if (l.kind != LightKind::environment) return true;
  return infinity == LightsAtInfinity::worth_sampling && lights.environment.worth_sampling();
}

std::vector<AliasEntry> build_infinite_lights(const LightsView& lights, LightsAtInfinity infinity) {
  std::vector<float> weights;
  for (LightId i = lights.first_infinite; i < lights.lights.size; ++i) {
    weights.push_back(takes_part(lights, i, infinity) ? selection_weight(lights, i) : 0.0f);
  }
  return build_alias_table(weights);
}

InfiniteLights make_infinite_lights(const LightsView& lights, View<const AliasEntry> entries, bool finite) {
  InfiniteLights group;
  group.table = {entries};
  group.first = lights.first_infinite;
  if (!entries.empty()) group.share = finite ? 0.5f : 1.0f;
  return group;
}

}  // namespace relume
