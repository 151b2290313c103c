// JSON pointers of KHR_animation_pointer to what relume animates, both ways.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume::gltf {

/// A number that a pointer names, and the parameter of ParameterChannel that it drives.
struct PointerParameter {
  AnimatedPart part;
  std::string tail;       ///< of the pointer, after the index: "pbrMetallicRoughness/roughnessFactor"
  std::string parameter;  ///< "roughness"
  int components;         ///< of the values in the file
};

/// All of them.
const std::vector<PointerParameter>& pointer_parameters();

/// A pointer without its index: part, index in the file, and entry of pointer_parameters(). Nothing for other pointers.
struct ParameterPointer {
  int index;
  const PointerParameter* parameter;
};
std::optional<ParameterPointer> parse_parameter_pointer(std::string_view pointer);

/// "/materials/3/TAIL".
std::string pointer_to(const PointerParameter& parameter, Index index);

}  // namespace relume::gltf
