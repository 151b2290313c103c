// Key frames of materials, lights and cameras.
#include <map>

#include "scene/animated_parameters.h"
#include "scene/compiled_scene.h"

namespace relume {

void CompiledScene::apply_parameter_animation() {
  apply_parameters(source_, time_s_);
  if (camera_node_ != kNone)
    camera_ = source_.cameras[static_cast<size_t>(source_.nodes[static_cast<size_t>(camera_node_)].camera)];
}

Change CompiledScene::animate_parameters() {
  if (source_.parameter_animation.empty()) return Change::none;
  std::map<Index, Material> materials;  // animated materials in their previous state
  for (const ParameterChannel& c : source_.parameter_animation) {
    if (c.part == AnimatedPart::material)
      materials.try_emplace(c.index, source_.materials[static_cast<size_t>(c.index)]);
  }
  apply_parameter_animation();
  Change change = Change::none;
  for (auto& [index, before] : materials) {
    Material& now = source_.materials[static_cast<size_t>(index)];
    if (same_material(now, before)) continue;
    std::swap(now, before);  // replace_material() compares with the previous state
    change |= replace_material(index, before);
  }
  return change;
}

}  // namespace relume
