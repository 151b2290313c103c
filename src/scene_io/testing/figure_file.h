// Makes a small animated glTF file for tests and fuzzers.
#pragma once

#include <string>
#include <vector>

#include "scene_io/testing/scene_files.h"

namespace relume::testing {

inline constexpr int kUnsignedByte = 5121;  // component type in glTF

/// A triangle with two joints and two morph targets.
struct Figure {
  GltfBuilder file;
  int mesh = 0;
  int node = 0;
  int skin = 0;

  Figure();

  /// Adds an animation of one node property. Each of `values` has 1 to 4 `components`.
  void animate(int target, const char* path, const std::vector<float>& times, const std::vector<float>& values,
               int components, const char* name, const char* interpolation = "LINEAR");
};

}  // namespace relume::testing
