// A built-in scene and its glTF file show the same picture.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cctype>
#include <filesystem>
#include <string>
#include <tuple>

#include "io/scene_io.h"
#include "scene/builtin.h"
#include "support/image_test.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

/// Scenes of millions of triangles, checked under the label "slow".
bool is_large(std::string_view name) { return name == "city" || name == "cover"; }

using ExportCase = std::tuple<std::string_view, const char*>;  // scene, extension

class Export : public ::testing::TestWithParam<ExportCase> {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("relume_export_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string_view scene_name() const { return std::get<0>(GetParam()); }

  Scene original() const { return find_builtin_scene(scene_name())->build(); }
  Scene reread() const {
    const std::filesystem::path file = folder_ / (std::string("scene") + std::get<1>(GetParam()));
    for (const std::string& loss : write_gltf(file, original())) RecordProperty("loss", loss);
    return load_scene(file);
  }

 private:
  std::filesystem::path folder_;
};

std::string export_name(const ::testing::TestParamInfo<ExportCase>& info) {
  std::string name(std::get<0>(info.param));
  name += std::get<1>(info.param);
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

TEST_P(Export, RereadShowsTheSamePicture) {
  const bool large = is_large(scene_name());
  RenderSettings settings = large ? small_settings(16, 9) : small_settings(32, 24);
  settings.time_s = 0.4f;  // within every animation
  const Scene before = original();
  const Scene after = reread();
  const bool same_bits = render(before, settings, 4).pixels == render(after, settings, 4).pixels;
  RecordProperty("same_bits", same_bits);
  if (same_bits) return;
  // Numbers that glTF stores another way (matrices, quaternions, colours of 8 bit) move single samples.
  const int spp = large ? 4 : 32;
  expect_same_picture("export-" + export_name({GetParam(), 0}), measure(after, settings, spp, 16, 1),
                      measure(before, settings, spp, 16, 1001));
}

std::vector<ExportCase> export_cases(bool large) {
  std::vector<ExportCase> cases;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (is_large(scene.name) != large) continue;
    cases.emplace_back(scene.name, ".glb");
    cases.emplace_back(scene.name, ".gltf");
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Builtin, Export, ::testing::ValuesIn(export_cases(false)), export_name);
INSTANTIATE_TEST_SUITE_P(SlowBuiltin, Export, ::testing::ValuesIn(export_cases(true)), export_name);

}  // namespace
}  // namespace relume::support
