#include "scene_io/relume_json/overrides.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "relume/scene_io.h"
#include "scene/light_parameters.h"
#include "scene/material_parameters.h"
#include "scene_io/decompose.h"
#include "scene_io/image_search.h"
#include "scene_io/look_rotation.h"

namespace relume {
namespace {

constexpr float kLargest = 1e30f;
constexpr std::string_view kProjections[] = {"perspective", "orthographic", "panoramic"};

float degrees(const JsonObject& object, const char* key, float fallback_rad, float low, float high) {
  return object.has(key) ? glm::radians(object.number(key, 0, low, high)) : fallback_rad;
}

Vec3 look_direction(const JsonObject& object) {
  object.require("eye");
  object.require("target");
  const Vec3 direction = object.vec3("target", Vec3(0)) - object.vec3("eye", Vec3(0));
  if (!(glm::length(direction) > 0))
    object.fail(fmt::format("{} equals the position of the camera; move one of the two", object.path_of("target")));
  return direction;
}

Vec4 as_value(const glm::quat& q) { return {q.x, q.y, q.z, q.w}; }

/// Times of the keys in seconds. Throws Error unless they increase.
std::vector<float> key_times(const std::vector<JsonObject>& keys) {
  std::vector<float> times;
  for (const JsonObject& key : keys) {
    key.require("time");
    const float time = key.number("time", 0, -kLargest, kLargest);
    if (!times.empty() && time <= times.back())
      key.fail(fmt::format("{} is {:g}, but must be later than {:g}, the time of the key before it",
                           key.path_of("time"), time, times.back()));
    times.push_back(time);
  }
  return times;
}

Camera read_camera(const JsonObject& object) {
  Camera camera;
  camera.name = object.string("name", "camera");
  camera.projection = static_cast<Projection>(object.choice("projection", 0, kProjections));
  camera.fov_y_rad = degrees(object, "fov_y_deg", camera.fov_y_rad, 0.01f, 179.0f);
  camera.half_height = object.number("half_height", camera.half_height, 1e-6f, kLargest);
  if (object.has("aspect_ratio")) camera.aspect_ratio = object.number("aspect_ratio", 0, 0.01f, 100);
  camera.lens_radius = object.number("lens_radius", camera.lens_radius, 0, kLargest);
  camera.focus_distance = object.number("focus_distance", camera.focus_distance, 1e-6f, kLargest);
  return camera;
}

void add_camera_keys(const std::vector<JsonObject>& keys, Index node, Scene& scene) {
  AnimationChannel move{node, AnimatedProperty::translation, Interpolation::linear, key_times(keys), {}};
  AnimationChannel turn{node, AnimatedProperty::rotation, Interpolation::linear, move.times, {}};
  for (const JsonObject& key : keys) {
    const glm::quat rotation = look_rotation(look_direction(key));
    move.values.emplace_back(key.vec3("eye", Vec3(0)), 0.0f);
    turn.values.push_back(as_value(rotation));
  }
  scene.nodes[static_cast<size_t>(node)].transform.translation = Vec3(move.values.front());
  const Vec4 first = turn.values.front();
  scene.nodes[static_cast<size_t>(node)].transform.rotation = glm::quat(first.w, first.x, first.y, first.z);
  scene.animation.push_back(std::move(move));
  scene.animation.push_back(std::move(turn));
}

PunctualLight read_light(const JsonObject& object) {
  PunctualLight light;
  light.name = object.string("name", "light");
  object.require("type");
  light.type = static_cast<PunctualType>(object.choice("type", 0, light_type_names()));
  light.intensity = object.rgb("intensity", light.intensity);
  for (const LightParameter& p : light_parameters())
    light.*p.member = degrees(object, p.key, light.*p.member, p.low_deg, p.high_deg);
  for (const LightParameter& p : light_parameters()) {
    if (light.*p.member > upper_limit(p, light))
      object.fail(fmt::format("{} is {:g}, but must be at most {:g}", object.path_of(p.key),
                              glm::degrees(light.*p.member), glm::degrees(upper_limit(p, light))));
  }
  return light;
}

SunSky read_sun_sky(const JsonObject& object) {
  SunSky sky;
  sky.sun_elevation_rad = degrees(object, "elevation_deg", sky.sun_elevation_rad, -90, 90);
  sky.sun_azimuth_rad = degrees(object, "azimuth_deg", sky.sun_azimuth_rad, -360, 360);
  sky.turbidity = object.number("turbidity", sky.turbidity, 1.7f, 10);
  sky.sky_scale = object.number("sky_scale", sky.sky_scale, 0, kLargest);
  sky.sun_scale = object.number("sun_scale", sky.sun_scale, 0, kLargest);
  sky.sun_angular_diameter_rad = degrees(object, "sun_angular_diameter_deg", sky.sun_angular_diameter_rad, 0.01f, 90);
  sky.ground_albedo = object.rgb("ground_albedo", sky.ground_albedo);
  if (max_component(sky.ground_albedo) > 1)
    object.fail(fmt::format("{} is {:g}, but must be at most 1", object.path_of("ground_albedo"),
                            max_component(sky.ground_albedo)));
  return sky;
}

/// Up to twelve names for a message.
template <typename Items>
std::string some_names(const Items& items) {
  constexpr size_t kMost = 12;
  std::string names;
  for (size_t i = 0; i < items.size() && i < kMost; ++i) names += (i == 0 ? "" : ", ") + items[i].name;
  if (items.size() > kMost) names += fmt::format(" and {} more", items.size() - kMost);
  return names.empty() ? "(the scene has none)" : names;
}

/// Member with the parameter's name, or `value` if absent.
float read(const JsonObject& object, const MaterialParameter& p, float value) {
  return object.number(p.key, value, p.range.low, p.range.high);
}
bool read(const JsonObject& object, const MaterialParameter& p, bool value) { return object.boolean(p.key, value); }
Rgb read(const JsonObject& object, const MaterialParameter& p, const Rgb& value) {
  const Rgb color = object.rgb(p.key, value);
  if (object.has(p.key) && max_component(color) > p.range.high)
    object.fail(
        fmt::format("{} is {:g}, but must be at most {:g}", object.path_of(p.key), max_component(color), p.range.high));
  return color;
}
template <typename T>
requires std::is_enum_v<T> T read(const JsonObject& object, const MaterialParameter& p, T value) {
  return static_cast<T>(object.choice(p.key, static_cast<int>(value), p.choices));
}
/// This format cannot change textures.
TextureRef read(const JsonObject&, const MaterialParameter&, const TextureRef& value) { return value; }

void override_material(const JsonObject& object, Material& m) {
  for_each_parameter(m, [&](const MaterialParameter& p, auto& value) { value = read(object, p, value); });
}

std::vector<std::string_view> material_keys() {
  std::vector<std::string_view> keys;
  for (const MaterialParameter& p : material_parameters()) {
    if (!std::holds_alternative<TextureRef Material::*>(p.member)) keys.push_back(p.key);
  }
  return keys;
}

/// Rotation about X, then Y, then Z, in degrees.
glm::quat euler_rotation(const Vec3& deg) {
  const Vec3 half = glm::radians(deg) * 0.5f;
  const glm::quat x(std::cos(half.x), std::sin(half.x), 0, 0);
  const glm::quat y(std::cos(half.y), 0, std::sin(half.y), 0);
  const glm::quat z(std::cos(half.z), 0, 0, std::sin(half.z));
  return glm::normalize(z * y * x);
}

/// Appends keys of a turn that ends at `time`. Quaternions interpolate along the shorter arc, so wide turns need
/// intermediate keys.
void add_turn(const Vec3& from_deg, const Vec3& to_deg, float time, AnimationChannel& channel) {
  constexpr float kStepDeg = 45;
  constexpr float kMostSteps = 4096;
  const float start = channel.times.back();
  const int steps = static_cast<int>(clamp(std::ceil(max_component(abs(to_deg - from_deg)) / kStepDeg), 1, kMostSteps));
  for (int i = 1; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    const float key_time = i == steps ? time : lerp(start, time, t);
    if (key_time <= channel.times.back()) continue;  // finer than float resolution
    channel.times.push_back(key_time);
    channel.values.push_back(as_value(euler_rotation(from_deg + (to_deg - from_deg) * t)));
  }
}

void override_transform(const JsonObject& object, Node& node) {
  Transform& t = node.transform;
  t.translation = object.vec3("translation", t.translation);
  if (object.has("rotation_deg")) t.rotation = euler_rotation(object.vec3("rotation_deg", Vec3(0)));
  t.scale = object.vec3("scale", t.scale);
}

void add_channel(const std::vector<JsonObject>& keys, const char* name, AnimatedProperty property, Index node,
                 Scene& scene) {
  AnimationChannel channel{node, property, Interpolation::linear, {}, {}};
  const std::vector<float> times = key_times(keys);
  Vec3 previous(0);
  for (size_t i = 0; i < keys.size(); ++i) {
    if (!keys[i].has(name)) continue;
    const Vec3 value = keys[i].vec3(name, Vec3(0));
    if (property != AnimatedProperty::rotation) {
      channel.times.push_back(times[i]);
      channel.values.emplace_back(value, 0.0f);
    } else if (channel.times.empty()) {
      channel.times.push_back(times[i]);
      channel.values.push_back(as_value(euler_rotation(value)));
    } else {
      add_turn(previous, value, times[i], channel);
    }
    previous = value;
  }
  if (channel.times.empty()) return;
  std::erase_if(scene.animation, [&](const AnimationChannel& c) { return c.node == node && c.property == property; });
  scene.animation.push_back(std::move(channel));
}

void override_node(const JsonObject& object, Index index, Scene& scene) {
  Node& node = scene.nodes[static_cast<size_t>(index)];
  if (node.matrix) {
    node.transform = decompose(*node.matrix);
    node.matrix.reset();
  }
  override_transform(object, node);
  // Properties without keys become static.
  const std::pair<const char*, AnimatedProperty> properties[] = {{"translation", AnimatedProperty::translation},
                                                                 {"rotation_deg", AnimatedProperty::rotation},
                                                                 {"scale", AnimatedProperty::scale}};
  for (const auto& [name, property] : properties) {
    if (!object.has(name)) continue;
    std::erase_if(scene.animation,
                  [&, named = property](const AnimationChannel& c) { return c.node == index && c.property == named; });
  }
  const auto keys = object.objects("keys", {"time", "translation", "rotation_deg", "scale"});
  add_channel(keys, "translation", AnimatedProperty::translation, index, scene);
  add_channel(keys, "rotation_deg", AnimatedProperty::rotation, index, scene);
  add_channel(keys, "scale", AnimatedProperty::scale, index, scene);
}

}  // namespace

void apply_camera(const JsonObject& root, Scene& scene) {
  if (!root.has("camera") && !root.has("camera_keys")) return;
  const auto keys = root.objects("camera_keys", {"time", "eye", "target"});
  if (root.has("camera_keys") && keys.empty()) root.fail("camera_keys is empty; give at least one key or remove it");
  Camera camera;
  Node node;
  if (root.has("camera")) {
    const JsonObject object = root.object("camera", {"name", "eye", "target", "up", "fov_y_deg", "half_height",
                                                     "aspect_ratio", "lens_radius", "focus_distance", "projection"});
    camera = read_camera(object);
    if (keys.empty() || object.has("eye")) {
      node.transform.rotation = look_rotation(look_direction(object), object.vec3("up", Vec3(0, 1, 0)));
      node.transform.translation = object.vec3("eye", Vec3(0));
    }
  }
  node.name = camera.name;
  node.camera = 0;
  for (Node& other : scene.nodes) {
    if (other.camera != kNone) ++other.camera;
  }
  scene.cameras.insert(scene.cameras.begin(), std::move(camera));
  const Index index = scene.add_node(std::move(node));
  if (!keys.empty()) add_camera_keys(keys, index, scene);
}

void apply_lights(const JsonObject& root, Scene& scene) {
  std::vector<std::string_view> keys = {"name", "type", "position", "direction", "intensity"};
  for (const LightParameter& p : light_parameters()) keys.emplace_back(p.key);
  const auto lights = root.objects("lights", keys);
  for (const JsonObject& object : lights) {
    PunctualLight light = read_light(object);
    Node node;
    node.name = light.name;
    node.light = static_cast<Index>(scene.lights.size());
    node.transform.translation = object.vec3("position", Vec3(0));
    const Vec3 direction = object.vec3("direction", Vec3(0, -1, 0));
    if (!(glm::length(direction) > 0))
      object.fail(fmt::format("{} has length 0; give it another value", object.path_of("direction")));
    node.transform.rotation = look_rotation(direction);
    scene.lights.push_back(std::move(light));
    scene.add_node(std::move(node));
  }
}

void apply_environment(const JsonObject& root, const std::filesystem::path& base_dir, Scene& scene) {
  if (!root.has("environment")) return;
  const JsonObject object = root.object("environment", {"constant", "map", "sun_sky", "kind", "rotation_deg", "scale"});
  const int kinds = object.has("constant") + object.has("map") + object.has("sun_sky") + object.has("kind");
  if (kinds != 1) object.fail("environment must have exactly one of constant, map, sun_sky, kind");
  Environment environment;
  if (object.has("map")) {
    const std::string name = object.string("map", "");
    load_environment_map(find_image(base_dir, name, object.path_of("map")), environment);
  } else if (object.has("sun_sky")) {
    environment.kind = EnvironmentKind::sun_sky;
    environment.sun_sky =
        read_sun_sky(object.object("sun_sky", {"elevation_deg", "azimuth_deg", "turbidity", "sky_scale", "sun_scale",
                                               "sun_angular_diameter_deg", "ground_albedo"}));
  } else if (object.has("kind")) {
    constexpr EnvironmentKind kKinds[] = {EnvironmentKind::automatic, EnvironmentKind::none, EnvironmentKind::studio};
    constexpr std::string_view kNames[] = {"automatic", "none", "studio"};
    environment.kind = kKinds[object.choice("kind", 0, kNames)];
  } else {
    environment.kind = EnvironmentKind::constant;
    environment.color = object.rgb("constant", Rgb(1));
  }
  environment.rotation_rad = degrees(object, "rotation_deg", 0, -360, 360);
  environment.color = glm::min(environment.color * object.rgb("scale", Rgb(1)), Rgb(kLargest));
  scene.environment = std::move(environment);
}

void apply_materials(const JsonObject& root, Scene& scene) {
  if (!root.has("materials")) return;
  const JsonObject materials = root.object("materials", {});
  for (const std::string& name : materials.keys()) {
    const JsonObject object = materials.object(name.c_str(), material_keys());
    bool found = false;
    for (Material& material : scene.materials) {
      if (material.name != name) continue;
      override_material(object, material);
      found = true;
    }
    if (!found) root.fail(fmt::format("the scene has no material '{}'; it has {}", name, some_names(scene.materials)));
  }
}

void apply_nodes(const JsonObject& root, Scene& scene) {
  if (!root.has("nodes")) return;
  const JsonObject nodes = root.object("nodes", {});
  for (const std::string& name : nodes.keys()) {
    const JsonObject object = nodes.object(name.c_str(), {"translation", "rotation_deg", "scale", "keys"});
    const auto node =
        std::find_if(scene.nodes.begin(), scene.nodes.end(), [&](const Node& n) { return n.name == name; });
    if (node == scene.nodes.end())
      root.fail(fmt::format("the scene has no node '{}'; it has {}", name, some_names(scene.nodes)));
    override_node(object, static_cast<Index>(node - scene.nodes.begin()), scene);
  }
}

}  // namespace relume
