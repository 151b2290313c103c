#include <utility>

#include "scene/compiled_scene.h"
#include "scene/studio.h"
#include "scene_io/pbrt/pbrt_write_scene.h"

namespace relume::pbrt {

Scene with_defaults(Scene scene, Output& output) {
  const bool has_camera = find_camera(scene, "") != kNone;
  const bool is_automatic = scene.environment.kind == EnvironmentKind::automatic;
  const bool may_be_studio = is_automatic || scene.environment.kind == EnvironmentKind::studio;
  if (has_camera && !may_be_studio) return scene;
  const IVec2 size = image_size(scene);
  const CompiledScene compiled(scene, {.width = size.x, .height = size.y});
  const CameraPose pose = compiled.camera();
  if (!has_camera) {
    output.note("the scene has no camera; one that frames it is written");
    Node node;
    node.camera = static_cast<Index>(scene.cameras.size());
    node.matrix = pose.to_world;
    scene.cameras.push_back(pose.camera);
    scene.add_node(std::move(node));
  }
  Environment& environment = scene.environment;
  if (is_automatic) environment.kind = compiled.in_studio() ? EnvironmentKind::studio : EnvironmentKind::none;
  if (compiled.in_studio()) environment.rotation_rad += studio_rotation_rad(-Vec3(pose.to_world[2]));
  return scene;
}

}  // namespace relume::pbrt
