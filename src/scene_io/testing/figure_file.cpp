#include "scene_io/testing/figure_file.h"

namespace relume::testing {

Figure::Figure() {
  const json joints = file.accessor(std::vector<uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, 4, kUnsignedByte);
  const json weights = file.floats({0.75f, 0.25f, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0}, 4);
  const json targets = {{{"POSITION", file.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, 3)}},
                        {{"POSITION", file.floats({1, 0, 0, 2, 0, 0, 3, 0, 0}, 3)}}};
  mesh = file.add_triangle({{"targets", targets}});
  json& gltf_mesh = file.doc["meshes"][static_cast<size_t>(mesh)];
  gltf_mesh["primitives"][0]["attributes"]["JOINTS_0"] = joints;
  gltf_mesh["primitives"][0]["attributes"]["WEIGHTS_0"] = weights;
  gltf_mesh["weights"] = {0.5, 0};
  gltf_mesh["extras"] = {{"targetNames", {"up", "right"}}};
  const int upper = file.add("nodes", {{"name", "upper"}, {"translation", {0, 1, 0}}});
  const int lower = file.add_root({{"name", "lower"}, {"children", {upper}}});
  std::vector<float> matrices;
  for (int joint = 0; joint < 2; ++joint) {
    for (int i = 0; i < 16; ++i) matrices.push_back(i % 5 == 0 ? 1.0f : 0.0f);
    matrices[static_cast<size_t>(16 * joint + 13)] = static_cast<float>(-joint);
  }
  const int bind = file.accessor(matrices, 16, 5126);
  skin = file.add("skins", {{"name", "bones"}, {"joints", {lower, upper}}, {"inverseBindMatrices", bind}});
  node = file.add_root({{"name", "body"}, {"mesh", mesh}, {"skin", skin}});
}

void Figure::animate(int target, const char* path, const std::vector<float>& times, const std::vector<float>& values,
                     int components, const char* name, const char* interpolation) {
  const json sampler = {
      {"input", file.floats(times, 1)}, {"output", file.floats(values, components)}, {"interpolation", interpolation}};
  file.add("animations", {{"name", name},
                          {"samplers", {sampler}},
                          {"channels", {{{"sampler", 0}, {"target", {{"node", target}, {"path", path}}}}}}});
}

}  // namespace relume::testing
