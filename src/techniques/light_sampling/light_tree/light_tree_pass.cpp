#include "techniques/light_sampling/light_tree/light_tree_pass.h"

namespace relume {

bool LightTreePass::run(const FrameContext& frame) {
  if (built_ && !includes(frame.changes, kRebuildsLights)) return true;
  built_ = true;
  frame.backend.run("light-tree", [&] {
    tree_.assign(build_light_tree(frame.scene.lights, settings_.infinity()));
    selector_.tree = tree_.view(frame.scene.lights);
  });
  return true;
}

}  // namespace relume
