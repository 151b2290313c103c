#include "scene/light_parameters.h"

#include <algorithm>

namespace relume {
namespace {

using L = PunctualLight;

constexpr LightType kTypes[] = {
    {PunctualType::point, "point", "W/sr", false, false},
    {PunctualType::spot, "spot", "W/sr", false, true},
    {PunctualType::directional, "directional", "W/m\xc2\xb2", true, true},
};

constexpr LightParameter kParameters[] = {
    {"inner_cone_deg", "inner cone", &L::inner_cone_rad, PunctualType::spot, kPi / 2, &L::outer_cone_rad, 0, 90,
     "innerConeAngle", "inner cone", 0, 90},
    {"outer_cone_deg", "outer cone", &L::outer_cone_rad, PunctualType::spot, kPi / 2, nullptr, 0.1f, 90,
     "outerConeAngle", "outer cone", 1, 90},
    {"angular_diameter_deg", "angular diameter", &L::angular_diameter_rad, PunctualType::directional, kPi, nullptr, 0,
     90, nullptr, "diameter", 0, 10},
};

}  // namespace

std::span<const LightType> light_types() { return kTypes; }

std::span<const LightParameter> light_parameters() { return kParameters; }

const LightType& type_of(const PunctualLight& light) { return kTypes[static_cast<size_t>(light.type)]; }

std::vector<std::string_view> light_type_names() {
  std::vector<std::string_view> names;
  for (const LightType& type : kTypes) names.push_back(type.name);
  return names;
}

float upper_limit(const LightParameter& parameter, const PunctualLight& light) {
  return parameter.at_most ? std::min(parameter.most_rad, light.*parameter.at_most) : parameter.most_rad;
}

}  // namespace relume
