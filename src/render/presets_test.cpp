#include "render/presets.h"

#include <cmath>

#include <gtest/gtest.h>

#include "render/session.h"
#include "render/settings.h"
#include "scene/builtin.h"

namespace relume {
namespace {

class Presets : public ::testing::TestWithParam<Preset> {};

TEST_P(Presets, RenderFramesWhileTheCameraMoves) {
  Settings settings = resolve({.preset = std::string(GetParam().name)});
  settings.render.width = 24;
  settings.render.height = 16;
  settings.render.threads = 1;
  Session session(find_builtin_scene("cornell")->build(), settings.render);
  PlacedCamera camera = session.scene().camera();
  for (int frame = 0; frame < 4; ++frame) {
    camera.to_world[3].x += 0.02f;
    session.set_camera(camera);
    session.render_frame();
  }
  double sum = 0;
  for (const Rgb& pixel : session.image().pixels) sum += static_cast<double>(pixel.x + pixel.y + pixel.z);
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_GT(sum, 0);
}

std::string preset_name(const ::testing::TestParamInfo<Preset>& info) {
  std::string name(info.param.name);
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, Presets, ::testing::ValuesIn(presets()), preset_name);

}  // namespace
}  // namespace relume
