#include "scene_io/pbrt/pbrt_loader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/vec.h"
#include "files/bytes.h"
#include "relume/error.h"
#include "scene/placement.h"
#include "scene_io/decompose.h"
#include "scene_io/pbrt/gzip.h"
#include "scene_io/pbrt/pbrt_camera.h"
#include "scene_io/pbrt/pbrt_directives.h"
#include "scene_io/pbrt/pbrt_lights.h"
#include "scene_io/pbrt/pbrt_materials.h"

namespace relume {
namespace {

using pbrt::Description;
using pbrt::ObjectEntity;
using pbrt::ShapeEntity;

float area_of(const Mesh& mesh, const Mat4& to_world) {
  double sum = 0;
  const Mat3 linear(to_world);
  for (const UVec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    const Vec3 twice = glm::cross(linear * (mesh.positions[t.y] - a), linear * (mesh.positions[t.z] - a));
    sum += static_cast<double>(glm::length(twice)) / 2;
  }
  return static_cast<float>(sum);
}

/// Places the shapes of a description in a scene.
class Placer {
 public:
  Placer(Scene& scene, pbrt::Materials& materials, const Mat3& orientation, Warnings& warnings)
      : scene_(scene), materials_(materials), warnings_(warnings) {
    if (orientation == Mat3(1)) return;
    Node world;
    world.name = "world";
    world.matrix = Mat4(orientation);
    root_ = scene_.add_node(std::move(world));
  }

  void place(const std::vector<ShapeEntity>& shapes) {
    for (const ShapeEntity& shape : shapes) {
      const Mat4 to_world = pbrt::narrow(shape.to_world.at[0]);
      if (!set_material(shape, to_world)) continue;
      if (shape.to_world.is_animated()) {
        place_moving(shape.to_world, shape.times, {shape.mesh});
      } else if (is_within_reach(to_world)) {
        Node& node = add(mesh(shape).name, {shape.mesh});
        if (to_world != Mat4(1)) node.matrix = to_world;
      }
    }
  }

  void place(const std::string& name, const ObjectEntity& object) {
    std::vector<Index> meshes;
    if (object.instances.empty() && object.moving.empty()) return;
    for (const ShapeEntity& shape : object.shapes) {
      if (set_material(shape, Mat4(1))) meshes.push_back(shape.mesh);
    }
    if (meshes.empty()) return;
    std::vector<Mat4> instances;
    for (const Mat4& instance : object.instances) {
      if (is_within_reach(instance)) instances.push_back(instance);
    }
    if (!instances.empty()) add(name, meshes).instances = std::move(instances);
    for (const auto& [to_world, times] : object.moving) place_moving(to_world, times, meshes);
  }

 private:
  Mesh& mesh(const ShapeEntity& shape) { return scene_.meshes[static_cast<size_t>(shape.mesh)]; }

  /// Returns whether the shape is visible.
  bool set_material(const ShapeEntity& shape, const Mat4& to_world) {
    const float area = shape.look.area_light ? area_of(mesh(shape), to_world) : 0.0f;
    mesh(shape).material = materials_.of(shape.look, area, shape.faces);
    return mesh(shape).material != kNone;
  }

  bool is_within_reach(const Mat4& matrix) {
    if (within_reach(matrix)) return true;
    warnings_.add(fmt::format("shapes beyond {:g} m are left out", kMaxCoordinate));
    return false;
  }

  Node& add(const std::string& name, const std::vector<Index>& meshes) {
    Node node;
    node.name = name;
    node.parent = root_;
    node.meshes = meshes;
    scene_.add_node(std::move(node));
    return scene_.nodes.back();
  }

  void place_moving(const pbrt::TransformSet& to_world, const std::array<double, 2>& times,
                    const std::vector<Index>& meshes) {
    const Mat4 start = pbrt::narrow(to_world.at[0]);
    const Mat4 end = pbrt::narrow(to_world.at[1]);
    if (!is_within_reach(start) || !is_within_reach(end)) return;
    add("moving", meshes).transform = decompose(start);
    pbrt::animate(start, end, times, static_cast<Index>(scene_.nodes.size()) - 1, scene_, warnings_);
  }

  Scene& scene_;
  pbrt::Materials& materials_;
  Warnings& warnings_;
  Index root_ = kNone;
};

void build(const Description& description, const std::filesystem::path& base_dir, Scene& scene, Warnings& warnings) {
  pbrt::Colors colors(base_dir, warnings);
  pbrt::ImageFiles images(base_dir, warnings);
  const Mat3 orientation = pbrt::world_orientation(description);
  pbrt::Materials materials(description, scene, colors, images, warnings);
  Placer placer(scene, materials, orientation, warnings);
  placer.place(description.shapes);
  for (const auto& [name, object] : description.objects) placer.place(name, object);
  pbrt::Lights lights(orientation, scene, colors, images, warnings);
  for (const pbrt::LightEntity& light : description.lights) lights.add(light);
  lights.finish();
  pbrt::add_camera(description, orientation, scene, warnings);
}

/// Sentences that quote the file, fit to be shown.
std::vector<std::string> without_control_characters(std::vector<std::string> sentences) {
  for (std::string& sentence : sentences) {
    for (char& c : sentence) {
      const auto code = static_cast<unsigned char>(c);
      if (code < 32 || code == 127) c = '?';
    }
  }
  return sentences;
}

/// Removes meshes that no node uses, such as invisible boundaries.
void remove_unused_meshes(Scene& scene) {
  std::vector<Index> new_index(scene.meshes.size(), kNone);
  for (const Node& node : scene.nodes) {
    for (const Index mesh : node.meshes) new_index[static_cast<size_t>(mesh)] = 0;
  }
  Index count = 0;
  for (size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] == kNone) continue;
    new_index[i] = count++;
    if (static_cast<size_t>(new_index[i]) != i)
      scene.meshes[static_cast<size_t>(new_index[i])] = std::move(scene.meshes[i]);
  }
  scene.meshes.resize(static_cast<size_t>(count));
  for (Node& node : scene.nodes) {
    for (Index& mesh : node.meshes) mesh = new_index[static_cast<size_t>(mesh)];
  }
}

}  // namespace

Scene load_pbrt_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                            const std::string& place) {
  const Bytes bytes = gunzipped({file.begin(), file.end()}, place);
  Warnings warnings(place);
  Scene scene;
  scene.name = std::filesystem::path(place).stem().string();
  Description description;
  pbrt::Directives directives(base_dir, description, scene, warnings);
  directives.run(place, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  directives.finish(place);
  build(description, base_dir, scene, warnings);
  remove_unused_meshes(scene);
  scene.warnings = without_control_characters(warnings.take());
  scene.notes = without_control_characters(warnings.take_notes());
  validate(scene, place);
  return scene;
}

Scene load_pbrt(const std::filesystem::path& file) {
  return load_pbrt_from_memory(read_file_bytes(file), file.parent_path(), file.string());
}

}  // namespace relume
