// Types of punctual lights and their parameters, each described once. Validation, hashes, relume JSON, glTF and the
// viewer use these lists.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume {

/// An angle of PunctualLight, radians, used by some types only.
struct LightParameter {
  const char* key;   ///< in relume JSON and extras.relume, in degrees
  const char* name;  ///< in messages
  float PunctualLight::*member;
  PunctualType type;              ///< type that uses it
  float most_rad;                 ///< largest valid value; the smallest is 0
  float PunctualLight::*at_most;  ///< another angle as upper limit; nullptr: none
  float low_deg;                  ///< range in relume JSON
  float high_deg;
  const char* gltf_key;  ///< in the object of its type in KHR_lights_punctual; nullptr: in extras.relume
  const char* label;     ///< in the viewer
  float low_shown_deg;   ///< ends of the viewer's slider
  float high_shown_deg;
};

struct LightType {
  PunctualType type;
  std::string_view name;  ///< in relume JSON and KHR_lights_punctual
  const char* unit;       ///< of its intensity
  bool at_infinity;       ///< whether only its direction matters, not its position
  bool has_direction;     ///< emits nothing if a scale of 0 leaves no direction
};

/// In the order of PunctualType.
std::span<const LightType> light_types();
/// In the order of PunctualLight.
std::span<const LightParameter> light_parameters();

const LightType& type_of(const PunctualLight& light);
/// The names of all types.
std::vector<std::string_view> light_type_names();
/// Largest valid value of a parameter of `light`, radians.
float upper_limit(const LightParameter& parameter, const PunctualLight& light);

}  // namespace relume
