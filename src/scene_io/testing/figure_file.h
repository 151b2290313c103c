// A small glTF file of something that moves, for tests and fuzzers.
#pragma once

#include <string>
#include <vector>

#include "scene_io/testing/scene_files.h"

namespace relume::testing {

inline constexpr int kUnsignedByte = 5121;  // component type of glTF

/// A triangle that two joints bend, with two morph targets.
struct Figure {
  GltfBuilder file;
  int mesh = 0;
  int node = 0;
  int skin = 0;

  Figure();

  /// An animation of its own that moves one property of a node. `components` of `values`: 1 … 4.
  void animate(int target, const char* path, const std::vector<float>& times, const std::vector<float>& values,
               int components, const char* name, const char* interpolation = "LINEAR");
};

}  // namespace relume::testing
