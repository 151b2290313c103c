// Sessions for checkpoint fuzzing, small enough to read thousands of checkpoints per second.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "core/fnv1a.h"
#include "render/session.h"

namespace relume::fuzz {

inline Mesh triangle(std::string name) {
  return {.name = std::move(name),
          .positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
          .normals = {},
          .tangents = {},
          .uv0 = {},
          .uv1 = {},
          .colors = {},
          .triangles = {{0, 1, 2}}};
}

/// A rotating triangle, an emissive one, a camera and uniform light.
inline Scene turning_triangle() {
  Scene scene;
  scene.meshes.push_back(triangle("triangle"));
  Node first;
  first.meshes = {0};
  const Index node = scene.add_node(std::move(first));
  Material shining;
  shining.emission = Rgb(3);
  shining.double_sided = true;
  scene.materials.push_back(shining);
  scene.meshes.push_back(triangle("lamp"));
  scene.meshes.back().material = 0;
  Node lamp;
  lamp.meshes = {1};
  lamp.transform.translation = {0.5f, 0.5f, 2};
  scene.add_node(std::move(lamp));
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

/// Techniques with their own state: histories, octree with light cache and quadtrees, lists, grids of cells, denoisers,
/// reservoirs, lists of tiles, Markov chains.
inline constexpr int kCheckpointCases = 19;
/// Added to the case if the fuzzed bytes include the header.
inline constexpr int kWithHeader = 128;

inline RenderSettings checkpoint_settings(int which) {
  RenderSettings s;
  s.width = 4;
  s.height = 3;
  s.threads = 1;
  s.path.max_bounces = 2;
  switch (which) {
    case 1: s.history = HistoryChoice::reproject; break;
    case 2:
      s.lights = LightSelectionChoice::vlc;
      s.vlc.memory = 3;
      s.guide = GuideChoice::cdq;
      s.cdq.memory = 3;
      s.cdq.spread = 1;
      s.octree.scale = false;
      s.octree.split = 8;
      s.octree.collapse = 4;
      break;
    case 3:
      s.lights = LightSelectionChoice::static_lists;
      s.static_lists.rays = 64;
      s.static_lists.cell_size = 1;
      break;
    case 4: s.cache = CacheChoice::psf; break;
    case 5: s.cache = CacheChoice::apsf_apg; break;
    case 6: s.denoise = DenoiseChoice::bmfr; break;
    case 7: s.denoise = DenoiseChoice::svgf; break;
    case 8: s.allocation = AllocationChoice::adaptive; break;
    case 9: s.denoise = DenoiseChoice::asvgf; break;
    case 10: s.cache = CacheChoice::sharc; break;
    case 11:
    case 15:
    case 18:
      if (which == 15) s.cache = CacheChoice::apsf_apg;
      if (which == 18) s.estimator = EstimatorChoice::bdpt;
      s.reuse = ReuseChoice::restir_gi;
      s.restir_gi.correction = ReuseCorrection::lagging;
      break;
    case 12: s.lights = LightSelectionChoice::neeat; break;
    case 13:
      s.lights = LightSelectionChoice::mcls;
      s.guide = GuideChoice::mcpg;
      s.mcls.grid.static_slots = s.mcpg.grid.static_slots = 64;
      break;
    case 14:
    case 16:
    case 17:
      if (which > 14) s.cache = which == 16 ? CacheChoice::apg : CacheChoice::sharc;
      s.reuse = ReuseChoice::restir_pt;
      s.restir_pt.correction = PathCorrection::lagging;
      break;
    default: break;  // accumulates
  }
  return s;
}

inline Session checkpoint_session(int which) {
  return Session(turning_triangle(), checkpoint_settings(which % kCheckpointCases));
}

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Length of the checkpoint's header, which identifies scene and settings: magic, hash of the scene, length of the
/// settings, settings.
inline size_t header_size(const std::string& checkpoint) {
  uint64_t settings = 0;
  std::memcpy(&settings, checkpoint.data() + 2 * sizeof(uint64_t), sizeof settings);
  return 3 * sizeof(uint64_t) + settings;
}

/// End of a checkpoint: FNV-1a of all preceding bytes.
inline std::string checksum(const std::string& bytes) {
  Fnv1a hash;
  hash.add(bytes.data(), bytes.size());
  const uint64_t sum = hash.value();
  std::string text(sizeof sum, 0);
  std::memcpy(text.data(), &sum, sizeof sum);
  return text;
}

}  // namespace relume::fuzz
