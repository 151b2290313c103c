// One valid file of each format, rich in features: the seeds of the malformed-input suite and of the fuzzers.
#pragma once

#include <string>
#include <vector>

#include "scene_io/testing/scene_files.h"

namespace relume::testing {

struct ExampleFile {
  std::string name;  ///< with extension
  Bytes bytes;
};

/// glTF (plain, GLB, meshopt, Draco), OBJ, PLY (ASCII, binary), STL, 3DS, OFF, DAE, FBX, relume JSON, and glTF with a
/// figure that moves. The JSON refers to "rich.gltf" beside it.
std::vector<ExampleFile> example_files();

/// Triangle at (0, 0, 100) (100, 0, 100) (0, 100, 100) in centimetres as ASCII FBX with this up axis (1: Y, 2: Z).
std::string fbx_text(int up_axis);
/// The same triangle as Collada in centimetres with Z up, and a camera and a light.
std::string dae_text();

}  // namespace relume::testing
