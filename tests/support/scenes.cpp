#include "support/scenes.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"

namespace relume::support {

void add_camera(Scene& scene, const Camera& camera, const Vec3& eye, const Vec3& direction) {
  scene.cameras.push_back(camera);
  Node node;
  node.name = "camera";
  node.camera = static_cast<Index>(scene.cameras.size()) - 1;
  node.transform = look_at(eye, eye + direction);
  scene.add_node(std::move(node));
}

void add(Scene& scene, Mesh mesh, Material material) {
  scene.materials.push_back(std::move(material));
  mesh.material = static_cast<Index>(scene.materials.size()) - 1;
  scene.meshes.push_back(std::move(mesh));
  Node node;
  node.meshes = {static_cast<Index>(scene.meshes.size()) - 1};
  scene.add_node(std::move(node));
}

void add_light(Scene& scene, const PunctualLight& light, const Transform& placed) {
  scene.lights.push_back(light);
  Node node;
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  node.transform = placed;
  scene.add_node(std::move(node));
}

void set_constant_environment(Scene& scene, const Rgb& radiance) {
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = radiance;
}

Index add_texture(Scene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return static_cast<Index>(scene.textures.size()) - 1;
}

void add_spot_meter(Scene& scene, const Vec3& target, const Vec3& direction, float distance) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = 5e-4f;
  add_camera(scene, camera, target - distance * glm::normalize(direction), direction);
}

Scene irradiance_meter() {
  Scene scene;
  scene.name = "irradiance meter";
  add(scene, quad({-0.01f, -0.01f, 0}, {0.02f, 0, 0}, {0, 0.02f, 0}), matte("white", Rgb(1)));
  add_spot_meter(scene, Vec3(0), {0, 0, -1}, 0.5f);
  return scene;
}

Scene open_box() {
  Scene scene = find_builtin_scene("cornell")->build();
  set_constant_environment(scene, {0.3f, 0.4f, 0.5f});
  for (const float x : {-0.6f, 0.6f}) {
    PunctualLight lamp;
    lamp.intensity = Rgb(0.3f, 0.25f, 0.2f);
    add_light(scene, lamp, {.translation = {x, 1.5f, 0.3f}});
  }
  return scene;
}

Scene in_a_room(Scene figure) {
  SceneBuilder builder("room");
  Scene room = [&] {
    const Index grey = builder.add_material(matte("grey", Rgb(0.6f)));
    const Index light = builder.add_material(emitter("light", Rgb(12)));
    builder.add("floor", quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), grey);
    builder.add("wall", quad({-4, 0, -1.5f}, {8, 0, 0}, {0, 5, 0}), grey);
    builder.add("lamp", quad({-2, 4, 0}, {1.5f, 0, 0}, {0, 0, 1.5f}), light);
    builder.add_camera({0.5f, 1.5f, 5}, {0.3f, 1.1f, 0}, 40);
    return builder.take();
  }();
  const auto nodes = static_cast<Index>(figure.nodes.size());
  const auto meshes = static_cast<Index>(figure.meshes.size());
  const auto materials = static_cast<Index>(figure.materials.size());
  for (Mesh& mesh : room.meshes) {
    mesh.material += materials;
    figure.meshes.push_back(std::move(mesh));
  }
  for (Node& node : room.nodes) {
    if (node.parent != kNone) node.parent += nodes;
    for (Index& mesh : node.meshes) mesh += meshes;
    figure.nodes.push_back(std::move(node));
  }
  figure.materials.insert(figure.materials.end(), room.materials.begin(), room.materials.end());
  figure.cameras = room.cameras;
  figure.materials[0] = matte("orange", Rgb(0.7f, 0.4f, 0.1f));
  return figure;
}

Texture make_texture(int width, int height, PixelFormat format, std::array<int, 4> (*value)(int x, int y)) {
  Texture texture;
  texture.width = width;
  texture.height = height;
  texture.format = format;
  texture.filter = FilterMode::nearest;
  for (int i = 0; i < width * height; ++i) {
    for (const int channel : value(i % width, i / width)) texture.texels.push_back(static_cast<std::byte>(channel));
  }
  return texture;
}

Index node_named(const Scene& scene, std::string_view name) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].name == name) return static_cast<Index>(i);
  }
  ADD_FAILURE() << name;
  return kNone;
}

Material unlit(const Rgb& color) {
  Material material = matte("unlit", color);
  material.unlit = true;
  material.double_sided = true;
  return material;
}

double polygon_irradiance(const std::vector<Vec3>& polygon, const Vec3& p, const Vec3& n) {
  double sum = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = glm::normalize(glm::dvec3(polygon[i] - p));
    const glm::dvec3 b = glm::normalize(glm::dvec3(polygon[(i + 1) % polygon.size()] - p));
    const glm::dvec3 cross = glm::cross(a, b);
    const double sine = glm::length(cross);
    if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(cross / sine, glm::dvec3(n));
  }
  return 0.5 * std::fabs(sum);
}

double mesh_irradiance(const Mesh& mesh, const Vec3& p, const Vec3& n) {
  double sum = 0;
  for (const UVec3& t : mesh.triangles) {
    const std::vector<Vec3> triangle = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
    const Vec3 front = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    if (glm::dot(front, p - triangle[0]) > 0) sum += polygon_irradiance(triangle, p, n);
  }
  return sum;
}

}  // namespace relume::support
