// Writes scenes of pbrt-v4.
#include "relume/scene_io.h"
#include "scene_io/pbrt/pbrt_write_scene.h"

namespace relume {
namespace {

/// Whether each node and its ancestors are visible.
std::vector<bool> visible_nodes(const Scene& scene) {
  std::vector<bool> visible(scene.nodes.size());
  for (size_t i = 0; i < visible.size(); ++i) {
    bool shown = true;
    for (auto k = static_cast<Index>(i); k != kNone && shown; k = scene.nodes[static_cast<size_t>(k)].parent)
      shown = scene.nodes[static_cast<size_t>(k)].visible;
    visible[i] = shown;
  }
  return visible;
}

}  // namespace

std::vector<std::string> write_pbrt(const std::filesystem::path& file, const Scene& scene) {
  validate(scene, scene.name.empty() ? "scene" : scene.name);
  pbrt::Output output(file, scene.source_files);
  const std::vector<Mat4> world = world_matrices(scene, 0);
  const std::vector<bool> visible = visible_nodes(scene);
  output.line("# Written by relume for pbrt-v4");
  pbrt::write_camera(scene, world, output);
  output.line("WorldBegin");
  pbrt::write_lights(scene, world, visible, output);
  const std::vector<pbrt::WrittenMaterial> materials = pbrt::MaterialWriter(scene, output).write();
  pbrt::write_shapes(scene, world, visible, materials, output);
  if (!scene.animation.empty() || !scene.parameter_animation.empty())
    output.note("the animation is left out; the scene is written at time 0");
  if (!scene.variants.empty()) output.note("variants of materials are left out; the default materials are written");
  return output.finish();
}

}  // namespace relume
