#include "scene_io/mitsuba/mitsuba_emitters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/placement.h"
#include "scene_io/look_rotation.h"
#include "scene_io/mitsuba/mitsuba_sensors.h"

namespace relume::mitsuba {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
constexpr float kSharpEdge_rad = 1e-3f;  // of spot lamps, whose falloff does not matter

/// Adds a lamp that stands at the origin of `to_world` and shines along its +Z.
void add_lamp(PunctualLight lamp, const glm::dmat4& to_world, Index parent, Import& import) {
  const Vec3 position(to_world[3]);
  const Vec3 direction(to_world[2]);
  if (!is_finite(position) || !is_finite(direction) || max_component(abs(position)) > kMaxCoordinate) {
    import.warnings.add(fmt::format("a lamp is beyond {:g} m and is left out", kMaxCoordinate));
    return;
  }
  Node node;
  node.name = lamp.name;
  node.parent = parent;
  node.transform.translation = position;
  node.transform.rotation = look_rotation(direction, Vec3(to_world[1]));
  node.light = static_cast<Index>(import.scene.lights.size());
  import.scene.lights.push_back(std::move(lamp));
  import.scene.add_node(std::move(node));
}

PunctualLight lamp_of(const Parameters& p, PunctualType type, const char* intensity, const Import& import) {
  PunctualLight lamp;
  lamp.name = p.object().id.empty() ? p.object().type : p.object().id;
  lamp.type = type;
  lamp.intensity = color_parameter(import, p, intensity, Rgb(1), SpectrumUse::light);
  return lamp;
}

glm::dmat4 transform_of(const Parameters& p) { return p.transform("to_world").value_or(glm::dmat4(1)); }

void import_point(const Parameters& p, Index parent, Import& import) {
  glm::dmat4 to_world = transform_of(p);
  if (const std::optional<glm::dvec3> position = p.vector("position")) to_world[3] = glm::dvec4(*position, 1);
  add_lamp(lamp_of(p, PunctualType::point, "intensity", import), to_world, parent, import);
}

/// Inner cone of glTF's lamp, whose intensity falls with the square of a linear function of the cosine, with the power
/// of Mitsuba's, whose intensity falls linearly in the angle from `beam` b to `cutoff` c:
///   2 cos i + cos c = 3 (sin c − sin b) / (c − b)
float inner_cone_of_same_power(float beam, float cutoff) {
  if (cutoff - beam < kSharpEdge_rad) return beam;
  const double c = cutoff;
  const double b = beam;
  const double cosine = (3 * (std::sin(c) - std::sin(b)) / (c - b) - std::cos(c)) / 2;
  return static_cast<float>(std::acos(std::clamp(cosine, std::cos(c), 1.0)));
}

void import_spot(const Parameters& p, Index parent, Import& import) {
  PunctualLight lamp = lamp_of(p, PunctualType::spot, "intensity", import);
  const double cutoff = p.number("cutoff_angle", 20);
  const double beam = p.number("beam_width", cutoff * 3 / 4);
  lamp.outer_cone_rad = clamp(static_cast<float>(cutoff * kRadiansPerDegree), 1e-3f, kPi / 2);
  lamp.inner_cone_rad = inner_cone_of_same_power(
      clamp(static_cast<float>(beam * kRadiansPerDegree), 0, lamp.outer_cone_rad), lamp.outer_cone_rad);
  if (p.child("texture")) import.warnings.add("the texture of a spot lamp is not supported; its light is even");
  if (cutoff - beam > kSharpEdge_rad / kRadiansPerDegree)
    import.warnings.add(
        "between beam_width and cutoff_angle, spot lamps fade as in glTF, with the same power, not linearly in the "
        "angle");
  add_lamp(std::move(lamp), transform_of(p), parent, import);
}

void import_directional(const Parameters& p, Index parent, Import& import) {
  glm::dmat4 to_world = transform_of(p);
  if (const std::optional<glm::dvec3> direction = p.vector("direction")) to_world[2] = glm::dvec4(*direction, 0);
  to_world[3] = glm::dvec4(0, 0, 0, 1);
  add_lamp(lamp_of(p, PunctualType::directional, "irradiance", import), to_world, parent, import);
}

/// The daylight among the scene's emitters; nullptr without one.
const Object* daylight_of(const Document& document) {
  for (const Child& child : document.root->children) {
    if (child.object->tag == "emitter" && is_daylight(*child.object)) return child.object;
  }
  return nullptr;
}

}  // namespace

bool is_daylight(const Object& emitter) {
  return emitter.type == "sunsky" || emitter.type == "sky" || emitter.type == "sun";
}

glm::dmat4 turn_of_scene(const Import& import) {
  const glm::dmat4 mirror = glm::scale(glm::dmat4(1), glm::dvec3(is_mirrored(import) ? -1 : 1, 1, 1));
  const Object* daylight = daylight_of(import.document);
  if (!daylight) return mirror;
  const glm::dvec3 zenith = glm::dmat3(mirror) * daylight_frame(Parameters(import, *daylight))[2];
  if (!(glm::length(zenith) > 0)) return mirror;
  const glm::dvec3 unit = glm::normalize(zenith);
  const glm::dvec3 axis = glm::cross(unit, glm::dvec3(0, 1, 0));
  const double sine = glm::length(axis);
  const bool is_vertical = sine < 1e-6;
  if (is_vertical && unit.y > 0) return mirror;
  return glm::rotate(glm::dmat4(1), std::atan2(sine, unit.y), is_vertical ? glm::dvec3(1, 0, 0) : axis / sine) * mirror;
}

void import_emitter(const Object& emitter, Index parent, Import& import) {
  if (emitter.type == "area") return;  // shines on the shapes that refer to it
  Environment& environment = import.scene.environment;
  const bool is_environment = emitter.type == "constant" || emitter.type == "envmap" || is_daylight(emitter);
  if (is_environment && environment.kind != EnvironmentKind::automatic) {
    import.warnings.add(fmt::format("a second environment, {}, is ignored", name_of(emitter)));
    return;
  }
  const Parameters p(import, emitter);
  p.ignore({"sampling_weight"});
  if (emitter.type == "point") {
    import_point(p, parent, import);
  } else if (emitter.type == "spot") {
    import_spot(p, parent, import);
  } else if (emitter.type == "directional") {
    import_directional(p, parent, import);
  } else if (emitter.type == "constant") {
    environment.kind = EnvironmentKind::constant;
    environment.color = color_parameter(import, p, "radiance", Rgb(1), SpectrumUse::light);
  } else if (emitter.type == "envmap") {
    import_environment_map(p, import);
  } else if (is_daylight(emitter)) {
    import_daylight(p, import);
  } else {
    emitter.read = false;
    import.warnings.add(fmt::format("{} is not supported and is left out", name_of(emitter)));
  }
}

}  // namespace relume::mitsuba
