#include "experiments/setup/scenes.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "experiments/setup/named.h"
#include "files/bytes.h"
#include "relume/error.h"
#include "relume/scene_io.h"

namespace relume {
namespace {

CameraPose camera_at(const Vec3& eye, const Vec3& target, float fov_y_deg) {
  const Transform transform = look_at(eye, target);
  CameraPose camera;
  camera.to_world = glm::translate(Mat4(1), transform.translation) * glm::mat4_cast(transform.rotation);
  camera.camera.fov_y_rad = glm::radians(fov_y_deg);
  return camera;
}

void add_light(Scene& scene, const PunctualLight& light, const Vec3& position, const Vec3& target) {
  scene.lights.push_back(light);
  Node node;
  node.name = "light";
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  node.transform = look_at(position, target);
  scene.add_node(std::move(node));
}

void use_point_light(Scene& scene) {
  named(scene.nodes, "node", "lamp").meshes.clear();
  PunctualLight light;
  light.intensity = {23.2f, 17.1f, 8.2f};  // same irradiance below as the lamp that it replaces
  add_light(scene, light, {0, 5.3f, 0}, {0.001f, 0, 0});
}

void use_directional_light(Scene& scene, const Vec3& from) {
  named(scene.nodes, "node", "lamp").meshes.clear();
  named(scene.nodes, "node", "ceiling").meshes.clear();
  PunctualLight light;
  light.type = PunctualType::directional;
  light.intensity = {3.0f, 2.8f, 2.4f};
  add_light(scene, light, from, {0, 0, 0});
}

/// Replaces the tall box by a sphere of 20 · 4^levels triangles.
void use_dense_mesh(Scene& scene, int levels) {
  Node& node = named(scene.nodes, "node", "tall box");
  Mesh& mesh = scene.meshes[static_cast<size_t>(node.meshes.front())];
  const Index material = mesh.material;
  mesh = icosphere(1.1f, levels);
  mesh.material = material;
  node.transform.translation.y = 1.1f;
}

void use_reflective_materials(Scene& scene) {
  for (const char* name : {"boxes", "white", "blue"}) {
    Material& material = named(scene.materials, "material", name);
    material.metallic = 1;
    material.roughness = name == std::string_view("boxes") ? 0.05f : 0.25f;
  }
}

void use_glass(Scene& scene) {
  Material clear = glass("boxes", 1.5f);
  named(scene.materials, "material", "boxes") = clear;
  // Above the floor, since the surfaces of two volumes must not touch.
  for (const char* name : {"tall box", "short box"}) named(scene.nodes, "node", name).transform.translation.y += 0.05f;
}

/// turned(), and moved by `way_m` along column `axis` of the unturned camera.
std::optional<CameraPose> turned_and_moved(const ExperimentScene& scene, float degrees, int axis, float way_m) {
  std::optional<CameraPose> camera = turned(scene, degrees);
  if (way_m == 0) return camera;
  if (!camera)
    throw Error(scene.name +
                ": the camera cannot be moved, because the experiment does not set ExperimentScene::camera");
  camera->to_world[3] += way_m * scene.camera->to_world[axis];
  return camera;
}

}  // namespace

ExperimentScene closed_box(BoxVariation variation) {
  ExperimentScene result;
  result.name = "closed box";
  result.scene = find_builtin_scene("cornell-closed")->build();
  result.scene.animation.clear();
  for (const char* wall : {"white", "red", "green", "blue"}) {
    Material& material = named(result.scene.materials, "material", wall);
    material.specular = 1;
    material.roughness = 0.5f;
  }
  switch (variation) {
    case BoxVariation::plain: break;
    case BoxVariation::point_light:
      result.property = "light";
      result.name = "point light";
      use_point_light(result.scene);
      break;
    case BoxVariation::directional_light:
      result.property = "light";
      result.name = "directional light";
      use_directional_light(result.scene, {1.2f, 8.0f, 0.6f});
      break;
    case BoxVariation::triangles_80k:
      result.property = "triangles";
      result.name = "82 thousand triangles";
      use_dense_mesh(result.scene, 6);
      break;
    case BoxVariation::triangles_1m:
      result.property = "triangles";
      result.name = "1.3 million triangles";
      use_dense_mesh(result.scene, 8);
      break;
    case BoxVariation::reflective:
      result.property = "material";
      result.name = "highly reflective";
      use_reflective_materials(result.scene);
      break;
    case BoxVariation::glass:
      result.property = "material";
      result.name = "glass";
      use_glass(result.scene);
      break;
  }
  // Looks past both boxes; the turn starts at the wall behind.
  const Vec3 eye(1.9f, 2.9f, 2.2f);
  result.camera = camera_at(eye, eye + Vec3(-0.62f, -0.22f, -0.76f), 60);
  result.settings.path.max_bounces = 6;
  return result;
}

ExperimentScene box_under(std::string_view box, DeltaLight light, int max_bounces) {
  ExperimentScene result = built_in(box, max_bounces);
  switch (light) {
    case DeltaLight::point:
      result.name += ", point light";
      use_point_light(result.scene);
      break;
    case DeltaLight::directional:
      result.name += ", directional light";
      use_directional_light(result.scene, {0.9f, 3.0f, 2.7f});  // reaches the walls through water or a mirror
      break;
  }
  return result;
}

ExperimentScene box_under_large_lamp(std::string_view box, float scale, int max_bounces) {
  ExperimentScene result = built_in(box, max_bounces);
  result.name += ", large lamp";
  named(result.scene.nodes, "node", "lamp").transform.scale *= Vec3(scale, 1, scale);  // its middle is at x = z = 0
  named(result.scene.materials, "material", "lamp").emission /= scale * scale;
  return result;
}

std::optional<ExperimentScene> sponza(const ExperimentContext& context) {
  if (context.scene_folder.empty()) return std::nullopt;
  const std::filesystem::path file = context.scene_folder / "sponza" / "sponza.gltf";
  if (const std::string reason = missing_reason(file); !reason.empty())
    throw Error(fmt::format("{}: the file {}; use --scenes with the folder that contains sponza/sponza.gltf",
                            file.string(), reason));
  ExperimentScene result;
  result.name = "Sponza";
  result.scene = load_scene(file);
  result.scene.environment = {};
  result.scene.environment.kind = EnvironmentKind::constant;
  result.scene.environment.color = Rgb(0.25f, 0.3f, 0.4f);
  result.camera = camera_at({-11.2f, 2.2f, -0.35f}, {8.0f, 3.4f, -0.35f}, 50);
  result.settings.path.max_bounces = 6;
  return result;
}

ExperimentScene city_street() {
  ExperimentScene result;
  result.name = "city";
  result.scene = find_builtin_scene("city")->build();
  result.scene.animation.clear();
  result.camera = camera_at({0, 25, 80}, {0, 22, -80}, 50);
  result.settings.path.max_bounces = 4;
  return result;
}

ExperimentScene built_in(std::string_view name, int max_bounces) {
  const BuiltinScene* scene = find_builtin_scene(name);
  if (!scene) throw Error("there is no built-in scene '" + std::string(name) + "'; `relume scenes` lists them");
  ExperimentScene result{.name = std::string(name), .scene = scene->build()};
  result.settings.path.max_bounces = max_bounces;
  return result;
}

ExperimentScene at_rest(ExperimentScene scene) {
  const std::vector<Node>& nodes = scene.scene.nodes;
  const auto node = std::find_if(nodes.begin(), nodes.end(), [](const Node& n) { return n.camera != kNone; });
  if (node == nodes.end()) throw Error("the scene '" + scene.name + "' has no camera; add one to a node");
  CameraPose camera;  // built-in scenes have it on a root node
  camera.to_world = glm::translate(Mat4(1), node->transform.translation) * glm::mat4_cast(node->transform.rotation);
  camera.camera = scene.scene.cameras[static_cast<size_t>(node->camera)];
  scene.camera = std::move(camera);
  return scene;
}

std::optional<CameraPose> turned(const ExperimentScene& scene, float degrees) {
  std::optional<CameraPose> camera = scene.camera;
  if (degrees == 0) return camera;
  if (!camera)
    throw Error(scene.name +
                ": the camera cannot be turned, because the experiment does not set ExperimentScene::camera");
  const Vec4 eye = camera->to_world[3];
  camera->to_world[3] = Vec4(0, 0, 0, 1);
  camera->to_world = rotation_y(degrees) * camera->to_world;
  camera->to_world[3] = eye;
  return camera;
}

std::optional<CameraPose> turned_aside(const ExperimentScene& scene, float degrees, float aside_m) {
  return turned_and_moved(scene, degrees, 0, aside_m);
}

std::optional<CameraPose> turned_ahead(const ExperimentScene& scene, float degrees, float ahead_m) {
  return turned_and_moved(scene, degrees, 2, -ahead_m);
}

void claim_without_sponza(const ExperimentContext& context, const char* paper, const std::vector<SponzaClaim>& missing,
                          std::vector<Claim>& claims) {
  if (!context.scene_folder.empty()) return;
  for (const SponzaClaim& m : missing) claims.push_back(unmeasured(m.id, paper, m.claim, m.threshold, kNoSponza));
}

}  // namespace relume
