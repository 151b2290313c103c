// One valid, feature-rich file per format: the seeds of the malformed-input suite and the fuzzers.
#pragma once

#include <string>
#include <vector>

#include "scene_io/testing/scene_files.h"

namespace relume::testing {

struct ExampleFile {
  std::string name;  ///< file name with extension
  Bytes bytes;
};

/// glTF (plain, GLB, meshopt, Draco, with an animated figure), OBJ, PLY (ASCII, binary), STL, 3DS, OFF, DAE, FBX,
/// relume JSON and Mitsuba. The JSON references "rich.gltf" in the same folder, Mitsuba's file "a.obj" and "ascii.ply".
std::vector<ExampleFile> example_files();

/// Triangle (0, 0, 100) (100, 0, 100) (0, 100, 100) in centimetres as ASCII FBX with this up axis (1: Y, 2: Z).
std::string fbx_text(int up_axis);
/// The same triangle as Collada in centimetres with Z up, a camera and a light.
std::string dae_text();

}  // namespace relume::testing
