// Imports key frames, including those of materials, lights and cameras.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene_io/gltf/gltf_document.h"
#include "scene_io/gltf/gltf_pointers.h"

namespace relume::gltf {

Interpolation interpolation_of(const std::string& name);

/// Keeps keys with increasing times and finite values; rotations need a nonzero length.
void repair_keys(AnimationChannel& channel, const std::string& name, Warnings& warnings);

/// Scene indices of a file's parts; kNone for unused parts.
struct SceneIndices {
  std::vector<Index> nodes;
  std::function<Index(int)> material;
  std::function<Index(int)> light;
  std::function<Index(int)> camera;
};

/// Imports a KHR_animation_pointer channel for a material, light or camera into clip `clip`. Throws Error if the
/// sampler is missing or does not fit.
void import_parameter(Document& document, const SceneIndices& indices, const tinygltf::Animation& animation,
                      int sampler, const ParameterPointer& pointer, Index clip, const std::string& name, Scene& scene);

}  // namespace relume::gltf
