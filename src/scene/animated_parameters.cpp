#include "scene/animated_parameters.h"

#include <algorithm>

#include "scene/animation.h"
#include "scene/light_parameters.h"
#include "scene/material_parameters.h"
#include "scene/placement.h"

namespace relume {
namespace {

constexpr std::string_view kTexture = "_texture.";

/// Finds a member of the transform of the texture with this key: "offset", "scale" or "rotation".
ParameterMember find_transform(Material& material, std::string_view key, std::string_view member) {
  ParameterMember found;
  for_each_parameter(material, [&](const MaterialParameter& p, auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, TextureRef>) {
      if (key != p.key) return;
      if (member == "offset") found = &value.offset;
      if (member == "scale") found = &value.scale;
      if (member == "rotation") found = &value.rotation_rad;
    }
  });
  return found;
}

void set(const ParameterMember& member, const Vec4& value) {
  if (auto* const* number = std::get_if<float*>(&member)) **number = value.x;
  if (auto* const* color = std::get_if<Rgb*>(&member)) **color = Rgb(value);
  if (auto* const* pair = std::get_if<Vec2*>(&member)) **pair = Vec2(value);
}

Vec4 limited(const Vec4& value, float low, float high) { return glm::clamp(value, Vec4(low), Vec4(high)); }

}  // namespace

ParameterMember find_parameter(Material& material, std::string_view name) {
  if (const size_t dot = name.find(kTexture); dot != std::string_view::npos)
    return find_transform(material, name.substr(0, dot), name.substr(dot + kTexture.size()));
  ParameterMember found;
  for_each_parameter(material, [&](const MaterialParameter& p, auto& value) {
    using T = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, Rgb>) {
      if (name == p.key) found = &value;
    }
  });
  return found;
}

ParameterMember find_parameter(PunctualLight& light, std::string_view name) {
  if (name == "intensity") return &light.intensity;
  if (name == "inner_cone") return &light.inner_cone_rad;
  if (name == "outer_cone") return &light.outer_cone_rad;
  if (name == "angular_diameter") return &light.angular_diameter_rad;
  return {};
}

ParameterMember find_parameter(Camera& camera, std::string_view name) {
  if (name == "fov_y") return &camera.fov_y_rad;
  if (name == "half_height") return &camera.half_height;
  if (name == "lens_radius") return &camera.lens_radius;
  if (name == "focus_distance") return &camera.focus_distance;
  return {};
}

bool same_material(const Material& a, const Material& b) {
  const auto same = [](const auto& x, const auto& y) {
    if constexpr (std::is_same_v<std::decay_t<decltype(x)>, TextureRef>) {
      return x.texture == y.texture && x.uv_set == y.uv_set && x.offset == y.offset && x.scale == y.scale &&
             x.rotation_rad == y.rotation_rad;
    } else {
      return x == y;
    }
  };
  return std::all_of(material_parameters().begin(), material_parameters().end(), [&](const MaterialParameter& p) {
    return std::visit([&](auto member) { return same(a.*member, b.*member); }, p.member);
  });
}

bool has_parameter(const Scene& scene, const ParameterChannel& channel) {
  const auto found = [&](const auto& parts) {
    if (channel.index < 0 || static_cast<size_t>(channel.index) >= parts.size()) return false;
    auto part = parts[static_cast<size_t>(channel.index)];
    return !std::holds_alternative<std::monostate>(find_parameter(part, channel.parameter));
  };
  switch (channel.part) {
    case AnimatedPart::material: return found(scene.materials);
    case AnimatedPart::light: return found(scene.lights);
    case AnimatedPart::camera: return found(scene.cameras);
  }
  return false;
}

void apply(const ParameterChannel& channel, float time_s, Material& material) {
  const Vec4 value = evaluate(channel, time_s);
  const ParameterMember member = find_parameter(material, channel.parameter);
  ParameterRange range{-kMaxCoordinate, kMaxCoordinate};  // of texture transforms
  for_each_parameter(material, [&](const MaterialParameter& p, const auto& own) {
    using T = std::decay_t<decltype(own)>;
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, Rgb>) {
      if (channel.parameter == p.key) range = p.range;
    }
  });
  set(member, limited(value, range.low, range.high));
}

void apply(const ParameterChannel& channel, float time_s, PunctualLight& light) {
  const bool is_angle = channel.parameter != "intensity";
  set(find_parameter(light, channel.parameter), limited(evaluate(channel, time_s), 0, is_angle ? kPi : kMaxRadiance));
  for (const LightParameter& p : light_parameters()) light.*p.member = std::min(light.*p.member, upper_limit(p, light));
}

void apply(const ParameterChannel& channel, float time_s, Camera& camera) {
  constexpr float kSmallest = 1e-4f;
  const bool may_vanish = channel.parameter == "lens_radius";
  const float most = channel.parameter == "fov_y" ? kPi - kSmallest : kMaxCoordinate;
  set(find_parameter(camera, channel.parameter), limited(evaluate(channel, time_s), may_vanish ? 0 : kSmallest, most));
}

void apply_parameters(Scene& scene, float time_s) {
  for (const ParameterChannel& c : scene.parameter_animation) {
    const auto i = static_cast<size_t>(c.index);
    switch (c.part) {
      case AnimatedPart::material: apply(c, time_s, scene.materials[i]); break;
      case AnimatedPart::light: apply(c, time_s, scene.lights[i]); break;
      case AnimatedPart::camera: apply(c, time_s, scene.cameras[i]); break;
    }
  }
}

}  // namespace relume
