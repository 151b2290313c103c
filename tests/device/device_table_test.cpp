// Writes the table of the docs: in which scenes device code gives the bits of the host.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "device/host_and_device.h"
#include "files/atomic_file.h"

namespace relume::support {
namespace {

constexpr const char* kTable = RELUME_SOURCE_DIR "/docs/device-bits.md";

/// The page up to the rows.
constexpr const char* kPageHead = R"(# Bits of device code

The device code of all kernels (PTX) runs on an emulated device, on the processor. A technique
renders a built-in scene at 64×36 pixels: four frames with a moving camera. Its row names the scene
if all bits of the images and auxiliary buffers equal those of the host, with `--accel bvh` and
`--scalar-kernels`. The test `SlowDeviceBitsOfMotion` requires equal bits for a moving skinned mesh
with morph targets.

Scenes that a row does not name have not been compared yet. A quick test fails if a technique has no
row. This command measures the missing scenes. It writes the page after each measurement, so it may
be interrupted:

    RELUME_WRITE=1 build/release/tests/device/device_tests --gtest_filter='DeviceBitsTable.*'

`RELUME_WRITE=cornell,door` measures in these scenes only. `RELUME_WRITE=all` discards all rows and
measures them again.

| technique | scenes with equal bits |
|---|---|
)";

using Scenes = std::set<std::string_view>;
/// The scenes with equal bits, by technique.
using Table = std::map<std::string, Scenes>;

Scenes all_scenes() {
  Scenes names;
  for (const BuiltinScene& scene : builtin_scenes()) names.insert(scene.name);
  return names;
}

/// Names that are separated by commas, with or without spaces.
std::set<std::string, std::less<>> split(const std::string& list) {
  std::set<std::string, std::less<>> names;
  std::istringstream text(list);
  for (std::string name; std::getline(text >> std::ws, name, ',');) names.insert(name);
  return names;
}

std::string row(const std::string& technique, const Scenes& scenes) {
  std::vector<std::string_view> in_order;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (scenes.contains(scene.name)) in_order.push_back(scene.name);
  }
  const bool all = in_order.size() == builtin_scenes().size();
  return fmt::format("| `{}` | {} |\n", technique,
                     all ? fmt::format("all {}", in_order.size()) : fmt::format("{}", fmt::join(in_order, ", ")));
}

/// The page with the rows of a table, in the order of the techniques. Techniques without a scene have no row.
std::string page_of(const Table& table) {
  std::string text = kPageHead;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    const auto found = table.find(technique.name);
    if (found != table.end() && !found->second.empty()) text += row(technique.name, found->second);
  }
  return text;
}

std::string stored_page() {
  std::ostringstream text;
  text << std::ifstream(kTable).rdbuf();
  return text.str();
}

/// The table of a page. A row for all scenes counts as none if their number has changed.
Table table_of(const std::string& page) {
  Table table;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    const std::string begin = fmt::format("\n| `{}` | ", technique.name);
    const size_t found = page.find(begin);
    if (found == std::string::npos) continue;
    const size_t first = found + begin.size();
    const std::string cell = page.substr(first, page.find(" |\n", first) - first);
    Scenes& scenes = table[technique.name];
    if (cell == fmt::format("all {}", builtin_scenes().size())) scenes = all_scenes();
    for (const BuiltinScene& scene : builtin_scenes()) {
      if (split(cell).contains(scene.name)) scenes.insert(scene.name);
    }
  }
  return table;
}

/// Measures what the table lacks in `scenes`. Writes the page after each technique with equal bits, so that an
/// interrupted run loses nothing.
void complete(Table table, const Scenes& scenes) {
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (!scenes.contains(scene.name)) continue;
    std::vector<DeterminismCheck> missing;
    for (const DeterminismCheck& technique : technique_checks().determinism) {
      if (!table[technique.name].contains(scene.name)) missing.push_back(technique);
    }
    if (missing.empty()) continue;
    HostAndDevice sessions(scene.build());
    for (const DeterminismCheck& technique : missing) {
      if (!sessions.agrees(technique)) continue;
      table[technique.name].insert(scene.name);
      write_file(kTable, page_of(table));
    }
  }
}

/// Completes the page. `write`: 1, all, or the names of scenes.
void write_page(const std::string& write) {
  Scenes scenes = all_scenes();
  if (write != "1" && write != "all") {
    scenes.clear();
    for (const std::string& name : split(write)) {
      const BuiltinScene* const scene = find_builtin_scene(name);
      ASSERT_TRUE(scene && all_scenes().contains(scene->name))
          << "RELUME_WRITE=" << write << ": '" << name << "' is no built-in scene; use a name of `relume scenes`";
      scenes.insert(scene->name);
    }
  }
  const Table known = write == "all" ? Table() : table_of(stored_page());
  write_file(kTable, page_of(known));
  complete(known, scenes);
}

/// Every technique must have a scene with equal bits, and the page must be what RELUME_WRITE writes.
TEST(DeviceBitsTable, ListsAllTechniques) {
  if (const char* write = std::getenv("RELUME_WRITE")) {
    ASSERT_NO_FATAL_FAILURE(write_page(write));
  }
  const std::string stored = stored_page();
  ASSERT_FALSE(stored.empty()) << "docs/device-bits.md cannot be read; run this test with RELUME_WRITE=all";
  Table table = table_of(stored);
  EXPECT_EQ(stored, page_of(table)) << "run it with RELUME_WRITE=1";
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    EXPECT_FALSE(table[technique.name].empty())
        << technique.name << " has no row; run this test with RELUME_WRITE=1, which adds one where bits are equal";
  }
}

}  // namespace
}  // namespace relume::support
