// Tests that kernels give the same bits in both of their forms (KernelForm), with either acceleration structure: every
// technique in every built-in scene, while the camera moves.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "determinism/moving_frames.h"
#include "support/technique_checks.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

struct FormsCase {
  const BuiltinScene* scene;
  AccelChoice accel;
  ImageSize size = {};

  std::string accel_name() const { return accel == AccelChoice::embree ? "embree" : "bvh"; }
  std::string name() const { return test_name(std::string(scene->name)) + "_" + accel_name(); }
};

/// Settings with one acceleration structure, in one form of kernels.
RenderSettings settings_of(const DeterminismCheck& technique, const FormsCase& tested, bool scalar) {
  RenderSettings s = moving_settings(technique, tested.size);
  s.accel = tested.accel;
  s.scalar_kernels = scalar;
  return s;
}

void PrintTo(const FormsCase& tested, std::ostream* out) { *out << tested.name(); }

/// Writes a table of the last frame's hashes: kernel_forms/SCENE_ACCEL_SIZE.tsv in the current folder.
class KernelForms : public ::testing::TestWithParam<FormsCase> {
 protected:
  void SetUp() override {
    if (is_host_replaced()) GTEST_SKIP() << "devices have one form of kernels, and relume's BVH";
  }
};
TEST_P(KernelForms, GiveTheSameBits) {
  const FormsCase& tested = GetParam();
  std::filesystem::create_directories("kernel_forms");
  std::ofstream table(fmt::format("kernel_forms/{}_{}_{}x{}.tsv", tested.scene->name, tested.accel_name(),
                                  tested.size.width, tested.size.height));
  table << "technique\ttiles\telements\n";
  const std::vector<DeterminismCheck>& techniques = technique_checks().determinism;
  Session session(tested.scene->build(), settings_of(techniques.front(), tested, false));
  for (const DeterminismCheck& technique : techniques) {
    const std::vector<uint64_t> tiles = moving_frames(session, settings_of(technique, tested, false));
    const std::vector<uint64_t> elements = moving_frames(session, settings_of(technique, tested, true));
    EXPECT_EQ(tiles, elements) << technique.name;
    EXPECT_NE(tiles.front(), tiles.back()) << technique.name;
    table << fmt::format("{}\t{:016x}\t{:016x}\n", technique.name, tiles.back(), elements.back());
  }
}

std::vector<FormsCase> all_cases() {
  std::vector<FormsCase> list;
  for (const BuiltinScene& scene : builtin_scenes()) {
    for (const AccelChoice accel : {AccelChoice::embree, AccelChoice::bvh}) list.push_back({&scene, accel, {}});
  }
  return list;
}

std::string case_name(const ::testing::TestParamInfo<FormsCase>& info) { return info.param.name(); }

// Refraction, and animated instances, with one structure each.
INSTANTIATE_TEST_SUITE_P(Some, KernelForms,
                         ::testing::Values(FormsCase{find_builtin_scene("cornell-glass"), AccelChoice::bvh, kQuickSize},
                                           FormsCase{find_builtin_scene("turntable"), AccelChoice::embree, kQuickSize}),
                         case_name);
INSTANTIATE_TEST_SUITE_P(SlowAll, KernelForms, ::testing::ValuesIn(all_cases()), case_name);

}  // namespace
}  // namespace relume::support
