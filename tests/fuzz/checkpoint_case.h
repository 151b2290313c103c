// Sessions whose checkpoints are fuzzed, so small that thousands are read in a second.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "render/session.h"

namespace relume::fuzz {

/// A triangle that turns, a camera and uniform light.
inline Scene turning_triangle() {
  Scene scene;
  scene.meshes.push_back(Mesh{.name = "triangle",
                              .positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
                              .normals = {},
                              .tangents = {},
                              .uv0 = {},
                              .uv1 = {},
                              .colors = {},
                              .triangles = {{0, 1, 2}}});
  Node triangle;
  triangle.meshes = {0};
  const Index node = scene.add_node(std::move(triangle));
  scene.cameras.emplace_back();
  Node camera;
  camera.camera = 0;
  camera.transform.translation = {0, 0, 4};
  scene.add_node(std::move(camera));
  AnimationChannel turn;
  turn.node = node;
  turn.times = {0, 1};
  turn.values = {{0, 0, 0, 0}, {1, 0, 0, 0}};
  scene.animation.push_back(turn);
  scene.environment.kind = EnvironmentKind::constant;
  return scene;
}

inline Session checkpoint_session(HistoryChoice history) {
  RenderSettings settings;
  settings.width = 4;
  settings.height = 3;
  settings.threads = 1;
  settings.history = history;
  return Session(turning_triangle(), settings);
}

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Length of the part of a checkpoint that says which scene and settings it belongs to: magic, hash of the scene,
/// length of the settings, settings.
inline size_t header_size(const std::string& checkpoint) {
  uint64_t settings = 0;
  std::memcpy(&settings, checkpoint.data() + 2 * sizeof(uint64_t), sizeof settings);
  return 3 * sizeof(uint64_t) + settings;
}

/// What a checkpoint ends in: FNV-1a of all before.
inline std::string checksum(const std::string& bytes) {
  uint64_t sum = 0xcbf29ce484222325u;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::string text(sizeof sum, 0);
  std::memcpy(text.data(), &sum, sizeof sum);
  return text;
}

}  // namespace relume::fuzz
