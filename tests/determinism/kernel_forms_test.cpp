// Tests that kernels give the same bits in both of their forms (KernelForm), with either acceleration structure: every
// technique in every built-in scene, while the camera moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/fnv1a.h"
#include "determinism/same_bits.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/technique_checks.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr int kFrames = 4;

RenderSettings settings_of(const DeterminismCheck& technique, AccelChoice accel, bool scalar) {
  RenderSettings s = small_settings(64, 36);
  s.auxiliary = true;
  s.static_lists.rays = 64;                                  // their preparation would dominate the test's time
  s.octree = {.collapse = 32, .split = 64, .scale = false};  // many regions for few pixels
  settings_from_json(describe(s), technique.json, technique.name);
  s.accel = accel;
  s.threads = 2;
  s.scalar_kernels = scalar;
  return s;
}

/// Hash of the bits of each frame while the camera moves sideways.
std::vector<uint64_t> moving_frames(Session& session, const RenderSettings& settings) {
  const CameraPose start = session.camera();
  EXPECT_TRUE(session.set_settings(settings));
  session.restart(settings.seed);
  std::vector<uint64_t> frames;
  for (int frame = 0; frame < kFrames; ++frame) {
    CameraPose moved = start;
    moved.to_world[3] += 0.02f * static_cast<float>(frame) * start.to_world[0];
    session.set_camera(moved);
    session.render_frame();
    const std::vector<uint32_t> bits = bits_of(session);
    Fnv1a hash;
    hash.add(bits.data(), bits.size() * sizeof(uint32_t));
    frames.push_back(hash.value());
  }
  session.set_camera(start);
  return frames;
}

class KernelForms : public ::testing::TestWithParam<const BuiltinScene*> {
 protected:
  /// Writes a table of the last frame's hashes: kernel_forms/SCENE_ACCEL.tsv in the current folder.
  static void compare(AccelChoice accel, const char* accel_name) {
    std::filesystem::create_directories("kernel_forms");
    std::ofstream table(fmt::format("kernel_forms/{}_{}.tsv", GetParam()->name, accel_name));
    table << "technique\ttiles\telements\n";
    const std::vector<DeterminismCheck>& techniques = technique_checks().determinism;
    Session session(GetParam()->build(), settings_of(techniques.front(), accel, false));
    for (const DeterminismCheck& technique : techniques) {
      const std::vector<uint64_t> tiles = moving_frames(session, settings_of(technique, accel, false));
      const std::vector<uint64_t> elements = moving_frames(session, settings_of(technique, accel, true));
      EXPECT_EQ(tiles, elements) << technique.name;
      EXPECT_NE(tiles.front(), tiles.back()) << technique.name;
      table << fmt::format("{}\t{:016x}\t{:016x}\n", technique.name, tiles.back(), elements.back());
    }
  }
};

TEST_P(KernelForms, GiveTheSameBitsWithEmbree) { compare(AccelChoice::embree, "embree"); }
TEST_P(KernelForms, GiveTheSameBitsWithBvh) { compare(AccelChoice::bvh, "bvh"); }

/// All built-in scenes, or those in `names`.
std::vector<const BuiltinScene*> scenes(const std::vector<std::string_view>& names = {}) {
  std::vector<const BuiltinScene*> list;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (names.empty() || std::find(names.begin(), names.end(), scene.name) != names.end()) list.push_back(&scene);
  }
  return list;
}
std::string scene_name(const ::testing::TestParamInfo<const BuiltinScene*>& info) {
  return test_name(std::string(info.param->name));
}
INSTANTIATE_TEST_SUITE_P(Some, KernelForms, ::testing::ValuesIn(scenes({"cornell-glass", "turntable"})), scene_name);
INSTANTIATE_TEST_SUITE_P(SlowAll, KernelForms, ::testing::ValuesIn(scenes()), scene_name);

}  // namespace
}  // namespace relume::support
