// Writes the table of the docs: in which scenes device code gives the bits of the host.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
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
    "generated:\n\n"
    "    RELUME_WRITE=1 build/release/tests/device/device_tests --gtest_filter='DeviceBitsTable.*'\n\n"
    "| technique | scenes with equal bits |\n|---|---|\n";

/// A row for each technique. `equal(technique)`: names of the scenes with equal bits.
std::string page(const std::function<std::vector<std::string_view>(const DeterminismCheck&)>& equal) {
  std::string text = kPageHead;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    const std::vector<std::string_view> scenes = equal(technique);
    const bool all = scenes.size() == builtin_scenes().size();
    text += fmt::format("| `{}` | {} |\n", technique.name,
                        all ? fmt::format("all {}", scenes.size()) : fmt::format("{}", fmt::join(scenes, ", ")));
  }
  return text;
}

std::string measured_page() {
  std::map<std::string, std::vector<std::string_view>> equal;
  for (const BuiltinScene& scene : builtin_scenes()) {
    HostAndDevice sessions(scene.build());
    for (const DeterminismCheck& technique : technique_checks().determinism) {
      if (sessions.agrees(technique)) equal[technique.name].push_back(scene.name);
    }
  }
  return page([&](const DeterminismCheck& technique) { return equal[technique.name]; });
}

std::vector<std::string_view> all_scene_names(const DeterminismCheck&) {
  std::vector<std::string_view> names;
  for (const BuiltinScene& scene : builtin_scenes()) names.push_back(scene.name);
  return names;
}

/// RELUME_WRITE=1 measures and writes the page. It is up to date if it lists all techniques with equal bits, which
/// DeviceBits checks.
TEST(DeviceBitsTable, ListsAllTechniques) {
  if (std::getenv("RELUME_WRITE")) {
    const std::string measured = measured_page();
    std::ofstream(kTable) << measured;
  }
  const std::ifstream file(kTable);
  ASSERT_TRUE(file) << "docs/device-bits.md cannot be read; run this test with RELUME_WRITE=1";
  std::ostringstream stored;
  stored << file.rdbuf();
  EXPECT_EQ(stored.str(), page(all_scene_names)) << "run it with RELUME_WRITE=1";
}

}  // namespace
}  // namespace relume::support
