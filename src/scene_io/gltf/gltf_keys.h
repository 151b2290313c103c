// Key frames of a glTF file, and those of its materials, lights and cameras.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene_io/gltf/gltf_document.h"
#include "scene_io/gltf/gltf_pointers.h"

namespace relume::gltf {

Interpolation interpolation_of(const std::string& name);

/// Keeps the keys whose times increase and whose values are finite; a rotation's value must have a length.
void repair_keys(AnimationChannel& channel, const std::string& name, Warnings& warnings);

/// Indices in the scene of the parts of a file; kNone for parts that it does not use.
struct SceneIndices {
  std::vector<Index> nodes;
  std::function<Index(int)> material;
  std::function<Index(int)> light;
  std::function<Index(int)> camera;
};

/// Imports a channel of KHR_animation_pointer that drives a material, light or camera into the clip of that name.
/// Throws Error for a sampler that does not exist or does not fit.
void import_parameter(Document& document, const SceneIndices& indices, const tinygltf::Animation& animation,
                      int sampler, const ParameterPointer& pointer, Index clip, const std::string& name, Scene& scene);

}  // namespace relume::gltf
