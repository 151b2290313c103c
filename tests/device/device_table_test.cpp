// Writes the table of the docs: in which scenes device code gives the bits of the host.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "device/host_and_device.h"

namespace relume::support {
namespace {

constexpr const char* kTable = RELUME_SOURCE_DIR "/docs/device-bits.md";

/// The page up to the rows.
constexpr const char* kPageHead =
    "# Bits of device code\n\nA device is emulated: the device code of all kernels (PTX) runs on the processor. Each "
    "technique\nrenders each built-in scene at 64×36 pixels: four frames with a moving camera. A scene counts if\nall "
    "bits of the images and auxiliary buffers equal those of `--accel bvh` on the host. The test\n"
    "`SlowDeviceBitsOfMotion` requires the same for a skinned mesh with morph targets that moves. This\npage is "
    "generated (`RELUME_WRITE=1` adds missing rows, `all` measures every row):\n\n"
    "    RELUME_WRITE=all build/release/tests/device/device_tests --gtest_filter='DeviceBitsTable.*'\n\n"
    "Techniques without a row have been compared in `cornell-glass` alone, by the test `DeviceBits`.\n\n"
    "| technique | scenes with equal bits |\n|---|---|\n";

std::string row(const DeterminismCheck& technique, const std::vector<std::string_view>& scenes) {
  const bool all = scenes.size() == builtin_scenes().size();
  return fmt::format("| `{}` | {} |\n", technique.name,
                     all ? fmt::format("all {}", scenes.size()) : fmt::format("{}", fmt::join(scenes, ", ")));
}

std::string stored_page() {
  std::ostringstream text;
  text << std::ifstream(kTable).rdbuf();
  return text.str();
}

/// The page with rows measured for the techniques that `stored` lacks. Its other rows stay.
std::string completed_page(const std::string& stored) {
  std::vector<DeterminismCheck> missing;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    if (stored.find(fmt::format("\n| `{}` |", technique.name)) == std::string::npos) missing.push_back(technique);
  }
  std::map<std::string, std::vector<std::string_view>> equal;
  for (const BuiltinScene& scene : builtin_scenes()) {
    HostAndDevice sessions(scene.build());
    for (const DeterminismCheck& technique : missing) {
      if (sessions.agrees(technique)) equal[technique.name].push_back(scene.name);
    }
  }
  std::string text = kPageHead;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    const size_t begin = stored.find(fmt::format("\n| `{}` |", technique.name));
    if (begin == std::string::npos) {
      text += row(technique, equal[technique.name]);
    } else {
      text += stored.substr(begin + 1, stored.find('\n', begin + 1) - begin);
    }
  }
  return text;
}

std::vector<std::string_view> all_scene_names(const DeterminismCheck&) {
  std::vector<std::string_view> names;
  for (const BuiltinScene& scene : builtin_scenes()) names.push_back(scene.name);
  return names;
}

/// RELUME_WRITE=all measures and writes the page, RELUME_WRITE=1 only the rows that it lacks. Its rows must have equal
/// bits in all scenes. DeviceBits compares every technique in one scene.
TEST(DeviceBitsTable, ListsAllTechniques) {
  if (const char* write = std::getenv("RELUME_WRITE")) {
    const std::string completed = completed_page(write == std::string_view("all") ? "" : stored_page());
    std::ofstream(kTable) << completed;
  }
  const std::string stored = stored_page();
  ASSERT_FALSE(stored.empty()) << "docs/device-bits.md cannot be read; run this test with RELUME_WRITE=all";
  std::string expected = kPageHead;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    const std::string text = row(technique, all_scene_names(technique));
    if (stored.find(text) != std::string::npos) expected += text;
  }
  EXPECT_EQ(stored, expected) << "run it with RELUME_WRITE=1";
}

}  // namespace
}  // namespace relume::support
