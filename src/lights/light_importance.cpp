#include "lights/light_importance.h"

namespace relume {

std::vector<CompactLight> compact_lights(const LightsView& view) {
  std::vector<CompactLight> compact;
  compact.reserve(view.first_infinite);
  for (LightId i = 0; i < view.first_infinite; ++i) compact.push_back(compact_form(view, view.lights[i]));
  return compact;
}

}  // namespace relume
