// Maps JSON pointers of KHR_animation_pointer to relume's animated parameters and back.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume::gltf {

/// A value named by pointers, and the parameter of ParameterChannel that it drives.
struct PointerParameter {
  AnimatedPart part;
  std::string tail;       ///< pointer after the index: "pbrMetallicRoughness/roughnessFactor"
  std::string parameter;  ///< "roughness"
  int components;         ///< components of the file's values
};

/// All supported parameters.
const std::vector<PointerParameter>& pointer_parameters();

/// A parsed pointer: index in the file and entry of pointer_parameters(). Nothing for unsupported pointers.
struct ParameterPointer {
  int index;
  const PointerParameter* parameter;
};
std::optional<ParameterPointer> parse_parameter_pointer(std::string_view pointer);

/// "/materials/3/TAIL".
std::string pointer_to(const PointerParameter& parameter, Index index);

}  // namespace relume::gltf
