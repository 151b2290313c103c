// Tests that device code gives the bits of the host: every technique in every built-in scene while the camera moves, on
// the emulated device and in the host's scalar forms with relume's BVH.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "device/host_and_device.h"
#include "device/kernels.h"
#include "scene/testing/figure.h"
#include "support/scenes.h"
#include "support/technique_checks.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

/// A scene, and every `stride`-th technique from number `first` on.
struct BitsCase {
  const BuiltinScene* scene;
  ImageSize size;
  size_t first = 0;
  size_t stride = 1;
  int (*frames)(const DeterminismCheck& technique) = [](const DeterminismCheck&) { return kMovingFrames; };

  std::string name() const {
    return test_name(std::string(scene->name)) + (stride > 1 ? "_" + std::to_string(first) : "");
  }
};

void PrintTo(const BitsCase& tested, std::ostream* out) { *out << tested.name(); }

/// The fewest pixels of four tiles: an emulated pixel takes longer than one of the host.
constexpr ImageSize kFourTiles{17, 17};

class DeviceBits : public ::testing::TestWithParam<BitsCase> {};
TEST_P(DeviceBits, EqualThoseOfTheHost) {
  const std::vector<DeterminismCheck>& techniques = technique_checks().determinism;
  HostAndDevice sessions(GetParam().scene->build(), {&ptx::all_kernels}, GetParam().size);
  for (size_t i = GetParam().first; i < techniques.size(); i += GetParam().stride) {
    EXPECT_TRUE(sessions.agrees(techniques[i], 0, GetParam().frames(techniques[i]))) << techniques[i].name;
  }
}

/// Four frames of a single choice, three of a pair and two of larger combinations: by the second frame, there is a
/// history and something learned. Each choice has four frames on its own, or three in a pair.
int frames_by_choices(const DeterminismCheck& technique) {
  return std::clamp(kMovingFrames + 1 - count_choices(technique), 2, kMovingFrames);
}

/// All techniques in four parts.
std::vector<BitsCase> quick_cases() {
  constexpr size_t kParts = 4;
  std::vector<BitsCase> list;
  for (size_t part = 0; part < kParts; ++part)
    list.push_back({find_builtin_scene("cornell-glass"), kFourTiles, part, kParts, frames_by_choices});
  return list;
}

std::vector<BitsCase> all_scenes() {
  std::vector<BitsCase> list;
  for (const BuiltinScene& scene : builtin_scenes()) list.push_back({&scene, {}});
  return list;
}

std::string case_name(const ::testing::TestParamInfo<BitsCase>& info) { return info.param.name(); }

INSTANTIATE_TEST_SUITE_P(Some, DeviceBits, ::testing::ValuesIn(quick_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(SlowAll, DeviceBits, ::testing::ValuesIn(all_scenes()), case_name);

/// Kernels also deform the mesh.
void expect_equal_bits_of_motion(const ImageSize& size) {
  HostAndDevice sessions(testing::figure({.morphs = true}), {&ptx::all_kernels}, size);
  for (const float time_s : {0.0f, 0.3f, 0.6f}) {
    for (Session* session : {&sessions.host(), &sessions.on_device()}) {
      session->set_time(time_s);
      session->render_frame();
    }
    EXPECT_EQ(frame_hash(sessions.host()), frame_hash(sessions.on_device())) << time_s;
  }
}
TEST(DeviceBitsOfMotion, EqualThoseOfTheHost) { expect_equal_bits_of_motion(kFourTiles); }
TEST(SlowDeviceBitsOfMotion, EqualThoseOfTheHost) { expect_equal_bits_of_motion({}); }

/// Kernels also write the vertices at the keys of the shutter.
void expect_equal_bits_with_an_open_shutter(const ImageSize& size) {
  HostAndDevice sessions(in_a_room(testing::figure({.morphs = true})), {&ptx::all_kernels}, size);
  for (const char* estimator : {"path", "bdpt", "light", "vcm"}) {
    const std::string json = R"({"shutter": 0.3, "shutter-keys": 5, "estimator": ")" + std::string(estimator) + "\"}";
    EXPECT_TRUE(sessions.agrees({.name = "motion blur", .json = json}, 0.15f)) << estimator;
  }
}
TEST(DeviceBitsOfMotion, EqualThoseOfTheHostWithAnOpenShutter) { expect_equal_bits_with_an_open_shutter(kFourTiles); }
TEST(SlowDeviceBitsOfMotion, EqualThoseOfTheHostWithAnOpenShutter) { expect_equal_bits_with_an_open_shutter({}); }

/// The same in every technique, while the camera moves, too.
TEST(SlowDeviceBitsOfMotion, EqualThoseOfTheHostInEveryTechnique) {
  HostAndDevice sessions(in_a_room(testing::figure({.morphs = true})));
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    EXPECT_TRUE(sessions.agrees(technique, 0.15f)) << technique.name;
  }
}

/// The comparison notices code whose multiply-adds are fused.
TEST(DeviceBitsOfContractedCode, DifferFromTheHost) {
  const DeterminismCheck technique{.name = "reprojection", .json = R"({"history": "reproject"})"};
  const Scene scene = find_builtin_scene("cornell")->build();
  EXPECT_TRUE(HostAndDevice(scene, {&ptx::all_kernels}, kFourTiles).agrees(technique));
  EXPECT_FALSE(HostAndDevice(scene, {&ptx::contracted, &ptx::all_kernels}, kFourTiles).agrees(technique));
}

}  // namespace
}  // namespace relume::support
