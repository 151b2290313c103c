#include "scene_io/relume_json/write_view.h"

#include <algorithm>

#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "core/euler.h"
#include "scene/material_parameters.h"

namespace relume {
namespace {

using nlohmann::json;

json list_of(const Vec3& v) { return {v.x, v.y, v.z}; }

json sun_sky_to_json(const SunSky& s) {
  return {{"elevation_deg", glm::degrees(s.sun_elevation_rad)},
          {"azimuth_deg", glm::degrees(s.sun_azimuth_rad)},
          {"turbidity", s.turbidity},
          {"sky_scale", s.sky_scale},
          {"sun_scale", s.sun_scale},
          {"sun_angular_diameter_deg", glm::degrees(s.sun_angular_diameter_rad)},
          {"ground_albedo", list_of(s.ground_albedo)}};
}

/// Uses a distance at which rounding of the coordinates does not rotate the view.
Vec3 point_ahead(const Vec3& eye, const Vec3& direction) {
  return eye + direction * std::max(1.0f, max_component(abs(eye)));
}

}  // namespace

json camera_to_json(const Camera& camera, const Mat4& to_world) {
  constexpr const char* kProjections[] = {"perspective", "orthographic", "panoramic"};
  const Vec3 eye(to_world[3]);
  json result{{"name", camera.name},
              {"projection", kProjections[static_cast<int>(camera.projection)]},
              {"eye", list_of(eye)},
              {"target", list_of(point_ahead(eye, -glm::normalize(Vec3(to_world[2]))))},
              {"up", list_of(glm::normalize(Vec3(to_world[1])))},
              {"fov_y_deg", glm::degrees(camera.fov_y_rad)},
              {"half_height", camera.half_height},
              {"lens_radius", camera.lens_radius},
              {"focus_distance", camera.focus_distance}};
  if (camera.aspect_ratio > 0) result["aspect_ratio"] = camera.aspect_ratio;
  return result;
}

json camera_key_to_json(float time_s, const Vec3& eye, const glm::quat& rotation) {
  return {{"time", time_s}, {"eye", list_of(eye)}, {"target", list_of(point_ahead(eye, rotation * Vec3(0, 0, -1)))}};
}

json material_to_json(const Material& material) {
  json result = json::object();
  for_each_parameter(material, [&](const MaterialParameter& p, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    if (p.widget.kind == ParameterWidget::Kind::none) return;
    if constexpr (std::is_same_v<T, float>) result[p.key] = value;
    if constexpr (std::is_same_v<T, Rgb>) result[p.key] = list_of(value);
  });
  return result;
}

json transform_to_json(const Transform& transform) {
  // About X, then Y, then Z, as in the reader.
  return {{"translation", list_of(transform.translation)},
          {"rotation_deg", list_of(euler_degrees(transform.rotation))},
          {"scale", list_of(transform.scale)}};
}

json environment_to_json(const Environment& environment) {
  const json rotation_deg = glm::degrees(environment.rotation_rad);
  switch (environment.kind) {
    case EnvironmentKind::automatic:
      return {{"kind", "automatic"}, {"rotation_deg", rotation_deg}, {"scale", list_of(environment.color)}};
    case EnvironmentKind::none: return {{"kind", "none"}};
    case EnvironmentKind::constant: return {{"constant", list_of(environment.color)}};
    case EnvironmentKind::map: return {{"rotation_deg", rotation_deg}, {"scale", list_of(environment.color)}};
    case EnvironmentKind::sun_sky:
      return {{"sun_sky", sun_sky_to_json(environment.sun_sky)},
              {"rotation_deg", rotation_deg},
              {"scale", list_of(environment.color)}};
    case EnvironmentKind::studio:
      return {{"kind", "studio"}, {"rotation_deg", rotation_deg}, {"scale", list_of(environment.color)}};
  }
  return {};
}

}  // namespace relume
