// Writes scenes of pbrt-v4.
#include "relume/scene_io.h"
#include "scene/scene.h"
#include "scene/still.h"
#include "scene_io/pbrt/pbrt_write_scene.h"

namespace relume {

std::vector<std::string> write_pbrt(const std::filesystem::path& file, const Scene& source) {
  validate(source, error_place(source));
  pbrt::Output output(file, source.source_files);
  const Scene scene = pbrt::with_defaults(still_scene(source, 0), output);
  const std::vector<Mat4> world = world_matrices(scene, 0);
  const std::vector<bool> visible = visible_nodes(scene, 0);
  output.line("# Written by relume for pbrt-v4");
  pbrt::write_camera(scene, world, output);
  output.line("WorldBegin");
  pbrt::write_lights(scene, world, visible, output);
  const std::vector<pbrt::WrittenMaterial> materials = pbrt::MaterialWriter(scene, output).write();
  pbrt::write_shapes(scene, world, visible, materials, output);
  if (!source.animation.empty() || !source.parameter_animation.empty())
    output.note("the animation is left out; the scene is written at time 0");
  if (!scene.visible_sets.empty()) output.note("visible sets, which pbrt cannot represent, are left out");
  if (!scene.variants.empty()) output.note("variants of materials are left out; the default materials are written");
  return output.finish();
}

}  // namespace relume
