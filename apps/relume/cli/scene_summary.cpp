#include "cli/scene_summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "cli/console.h"
#include "core/box.h"
#include "scene/deforming_meshes.h"

namespace relume::cli {
namespace {

template <typename T>
uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

uint64_t geometry_bytes(const Mesh& mesh) {
  uint64_t sum = bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.tangents) + bytes_of(mesh.uv0) +
                 bytes_of(mesh.uv1) + bytes_of(mesh.colors) + bytes_of(mesh.triangles) + bytes_of(mesh.influences);
  for (const MorphTarget& target : mesh.morph_targets)
    sum += bytes_of(target.positions) + bytes_of(target.normals) + bytes_of(target.tangents);
  return sum;
}

/// Adds the placed meshes and their bounds.
void add_placed(const Scene& scene, SceneSummary& summary) {
  const std::vector<Box> boxes = mesh_boxes(scene);
  const std::vector<Mat4> world = world_matrices(scene, 0);
  const JointMatrices joints = joint_matrices(scene, world);
  Box bounds;
  summary.instanced_triangles = placed_triangles(scene);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    for_each_place(node, [&](Index index, const Mat4& to_node) {
      ++summary.mesh_instances;
      const Mesh& mesh = scene.meshes[static_cast<size_t>(index)];
      const Box box = is_deformable(node, mesh) ? deformed_box(scene, static_cast<Index>(i), mesh, joints, 0)
                                                : boxes[static_cast<size_t>(index)];
      bounds.add(is_skinned(node, mesh) ? box : transformed(box, world[i] * to_node));
    });
  }
  summary.bounds_min = bounds.low;
  summary.bounds_max = bounds.high;
}

std::string environment_text(const Environment& environment) {
  switch (environment.kind) {
    case EnvironmentKind::none: break;
    case EnvironmentKind::constant:
      return fmt::format("constant {:g}, {:g}, {:g}", environment.color.r, environment.color.g, environment.color.b);
    case EnvironmentKind::map: return fmt::format("map {} x {}", environment.width, environment.height);
    case EnvironmentKind::sun_sky: return "sun and sky";
    case EnvironmentKind::studio: return "studio";
    case EnvironmentKind::automatic: return "studio if nothing lights the visible surfaces";
  }
  return "none";
}

std::string camera_text(const Camera& camera, size_t index) {
  const char* projection = camera.projection == Projection::orthographic ? "orthographic"
                           : camera.projection == Projection::panoramic  ? "panoramic"
                           : camera.lens_radius > 0                      ? "thin lens"
                                                                         : "perspective";
  return fmt::format("{} {} ({})", index, camera.name.empty() ? "without a name" : camera.name, projection);
}

std::string vector_text(const Vec3& v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z); }

}  // namespace

SceneSummary summarize(const Scene& scene) {
  SceneSummary summary;
  summary.nodes = scene.nodes.size();
  summary.meshes = scene.meshes.size();
  summary.materials = scene.materials.size();
  summary.textures = scene.textures.size();
  summary.lights = scene.lights.size();
  for (const Mesh& mesh : scene.meshes) {
    summary.triangles += mesh.triangles.size();
    summary.geometry_bytes += geometry_bytes(mesh);
  }
  for (const Material& material : scene.materials) {
    if (material.emission != Rgb(0)) ++summary.emissive_materials;
  }
  for (const Texture& texture : scene.textures) summary.texture_bytes += bytes_of(texture.texels);
  summary.texture_bytes += bytes_of(scene.environment.map);
  for (size_t i = 0; i < scene.cameras.size(); ++i) summary.cameras.push_back(camera_text(scene.cameras[i], i));
  summary.variants = scene.variants;
  summary.animation_s = animation_end(scene);
  summary.clips = scene.clips;
  summary.environment = environment_text(scene.environment);
  summary.warnings = scene.warnings;
  summary.files = scene.source_files;
  add_placed(scene, summary);
  return summary;
}

std::string to_text(const SceneSummary& s) {
  std::string text;
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:13} {}\n", name, value);
  };
  line("nodes", format_count(s.nodes));
  line("meshes", fmt::format("{}, with {} instances", format_count(s.meshes), format_count(s.mesh_instances)));
  line("triangles",
       fmt::format("{}, with instances {}", format_count(s.triangles), format_count(s.instanced_triangles)));
  line("materials", fmt::format("{}, of which {} emit", format_count(s.materials), format_count(s.emissive_materials)));
  line("textures", format_count(s.textures));
  line("lights", format_count(s.lights));
  line("environment", s.environment);
  line("cameras", format_count(s.cameras.size()));
  for (const std::string& camera : s.cameras) line("", printable(camera));
  if (!s.variants.empty()) line("variants", format_count(s.variants.size()));
  for (const std::string& variant : s.variants) line("", printable(variant));
  line("animation", s.animation_s > 0 ? fmt::format("{:g} s", s.animation_s) : "none");
  for (size_t i = 0; i < s.clips.size(); ++i) line("", fmt::format("{} {}", i, printable(s.clips[i])));
  if (s.bounds_min.x <= s.bounds_max.x) {
    line("bounds", fmt::format("{} to {} m", vector_text(s.bounds_min), vector_text(s.bounds_max)));
    line("extent", fmt::format("{} m", vector_text(s.bounds_max - s.bounds_min)));
  }
  line("memory",
       fmt::format("{} geometry, {} textures", format_bytes(s.geometry_bytes), format_bytes(s.texture_bytes)));
  line("warnings", format_count(s.warnings.size()));
  for (const std::string& warning : name_files_once(s.warnings, s.files)) line("", printable(warning));
  return text;
}

}  // namespace relume::cli
