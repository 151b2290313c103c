#include "builtin_scenes/builder.h"

#include <algorithm>
#include <cmath>

#include <glm/trigonometric.hpp>

namespace relume {
namespace {

Vec3 catmull_rom(const Vec3& before, const Vec3& a, const Vec3& b, const Vec3& after, float t) {
  const Vec3 in = 0.5f * (b - before);
  const Vec3 out = 0.5f * (after - a);
  const float t2 = t * t;
  const float t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * in + (3 * t2 - 2 * t3) * b + (t3 - t2) * out;
}

CameraKey interpolate(const std::vector<CameraKey>& keys, float time_s) {
  size_t i = 0;
  while (i + 2 < keys.size() && keys[i + 1].time_s <= time_s) ++i;
  const CameraKey& a = keys[i];
  const CameraKey& b = keys[i + 1];
  const CameraKey& before = keys[i == 0 ? 0 : i - 1];
  const CameraKey& after = keys[std::min(i + 2, keys.size() - 1)];
  const float t = saturate((time_s - a.time_s) / (b.time_s - a.time_s));
  return {time_s, catmull_rom(before.eye, a.eye, b.eye, after.eye, t),
          catmull_rom(before.target, a.target, b.target, after.target, t)};
}

}  // namespace

Material matte(std::string name, const Rgb& albedo) {
  Material material;
  material.name = std::move(name);
  material.base_color = albedo;
  material.metallic = 0;
  material.specular = 0;
  return material;
}

Material glossy(std::string name, const Rgb& albedo, float roughness) {
  Material material = matte(std::move(name), albedo);
  material.specular = 1;
  material.roughness = roughness;
  return material;
}

Material metal(std::string name, const Rgb& color, float roughness) {
  Material material;
  material.name = std::move(name);
  material.base_color = color;
  material.roughness = roughness;
  return material;
}

Material glass(std::string name, float ior, const Rgb& attenuation_color, float attenuation_distance) {
  Material material;
  material.name = std::move(name);
  material.metallic = 0;
  material.roughness = 0;
  material.ior = ior;
  material.transmission = 1;
  material.thickness = 1;
  material.attenuation_color = attenuation_color;
  material.attenuation_distance = attenuation_distance;
  return material;
}

Material emitter(std::string name, const Rgb& radiance) {
  Material material = matte(std::move(name), Rgb(0));
  material.emission = radiance;
  return material;
}

Index SceneBuilder::add_material(Material material) {
  scene_.materials.push_back(std::move(material));
  return static_cast<Index>(scene_.materials.size()) - 1;
}

Index SceneBuilder::add_texture(Texture texture) {
  scene_.textures.push_back(std::move(texture));
  return static_cast<Index>(scene_.textures.size()) - 1;
}

Index SceneBuilder::add_mesh(std::string name, Mesh mesh, Index material) {
  mesh.name = std::move(name);
  mesh.material = material;
  scene_.meshes.push_back(std::move(mesh));
  return static_cast<Index>(scene_.meshes.size()) - 1;
}

Index SceneBuilder::add(std::string name, Mesh mesh, Index material, const Transform& transform, Index parent) {
  Node node;
  node.name = name;
  node.parent = parent;
  node.transform = transform;
  node.meshes = {add_mesh(std::move(name), std::move(mesh), material)};
  return scene_.add_node(std::move(node));
}

Index SceneBuilder::add_group(std::string name, const Transform& transform, Index parent) {
  Node node;
  node.name = std::move(name);
  node.parent = parent;
  node.transform = transform;
  return scene_.add_node(std::move(node));
}

Index SceneBuilder::add_instances(std::string name, Index mesh, std::vector<Mat4> instances) {
  Node node;
  node.name = std::move(name);
  node.meshes = {mesh};
  node.instances = std::move(instances);
  return scene_.add_node(std::move(node));
}

Index SceneBuilder::add_camera(const Vec3& eye, const Vec3& target, float fov_y_deg, const std::string& name) {
  Camera camera;
  camera.name = name;
  camera.fov_y_rad = glm::radians(fov_y_deg);
  camera.focus_distance = glm::distance(eye, target);
  scene_.cameras.push_back(camera);
  Node node;
  node.name = name;
  node.transform = look_at(eye, target);
  node.camera = static_cast<Index>(scene_.cameras.size()) - 1;
  return scene_.add_node(std::move(node));
}

void SceneBuilder::add_camera_path(Index node, const std::vector<CameraKey>& keys) {
  AnimationChannel move;
  move.node = node;
  move.property = AnimatedProperty::translation;
  AnimationChannel turn = move;
  turn.property = AnimatedProperty::rotation;
  const float start = keys.front().time_s;
  const int steps = static_cast<int>(std::lround((keys.back().time_s - start) * 10));
  glm::quat previous(1, 0, 0, 0);
  for (int i = 0; i <= steps; ++i) {
    const float time_s = start + 0.1f * static_cast<float>(i);
    const CameraKey key = interpolate(keys, time_s);
    glm::quat q = look_at(key.eye, key.target).rotation;
    if (glm::dot(q, previous) < 0) q = -q;
    previous = q;
    move.times.push_back(time_s);
    move.values.emplace_back(key.eye, 0);
    turn.times.push_back(time_s);
    turn.values.emplace_back(q.x, q.y, q.z, q.w);
  }
  add_channel(std::move(move));
  add_channel(std::move(turn));
}

void SceneBuilder::add_turning(Index node, float seconds, int turns) {
  AnimationChannel turn;
  turn.node = node;
  turn.property = AnimatedProperty::rotation;
  for (int i = 0; i <= 4 * turns; ++i) {  // slerp takes the shorter arc, hence a key per quarter turn
    const float half_angle = static_cast<float>(i) * kPi / 4;
    turn.times.push_back(static_cast<float>(i) * seconds / 4);
    turn.values.emplace_back(0, std::sin(half_angle), 0, std::cos(half_angle));
  }
  add_channel(std::move(turn));
}

}  // namespace relume
