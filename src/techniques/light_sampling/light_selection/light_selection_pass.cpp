#include "techniques/light_sampling/light_selection/light_selection_pass.h"

namespace relume {

PassDeclaration LightSelectionPass::declaration() const { return {.name = "lights", .stage = Stage::prepare}; }

bool LightSelectionPass::run(const FrameContext& frame) {
  if (built_ && !includes(frame.changes, kRebuildsLights)) return true;
  built_ = true;
  frame.backend.run("lights", [&] {
    const LightsView& lights = frame.scene.lights;
    if (selector_.kind == LightSelectorKind::uniform) {
      selector_.uniform = make_uniform_lights(lights, settings_.infinity());
    } else {
      power_.assign(build_power_lights(lights, settings_.infinity()));
      selector_.power = {{power_.view()}};
    }
  });
  return true;
}

}  // namespace relume
