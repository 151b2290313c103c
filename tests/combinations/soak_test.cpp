// One session through thousands of frames while techniques, settings and the scene change at random: nothing crashes,
// leaks, stays behind or turns into NaN.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <fstream>

#include "combinations/cells.h"
#include "core/error.h"
#include "core/hash.h"
#include "render/session.h"
#include "scene/builtin.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 18;

/// Random numbers by count; the same in every run.
class Dice {
 public:
  uint32_t below(size_t n) { return static_cast<uint32_t>(unit() * static_cast<float>(n)); }
  float unit() { return to_unit_float(hash(count_++, 77u)); }
  float between(float low, float high) { return low + (high - low) * unit(); }
  bool once_in(size_t n) { return below(n) == 0; }

 private:
  uint32_t count_ = 0;
};

/// The box with a point light, seen by a camera that can be moved.
struct Stage {
  Scene scene;
  Index mover = kNone;
  PlacedCamera camera;

  Stage() : scene(find_builtin_scene("cornell-spheres")->build()) {
    PunctualLight light;
    light.intensity = Rgb(2);
    Transform placed;
    placed.translation = Vec3(0, 2.5f, 1);
    add_light(scene, light, placed);
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
      if (mover == kNone && !scene.nodes[i].meshes.empty() && scene.nodes[i].name.find("sphere") != std::string::npos)
        mover = static_cast<Index>(i);
    }
  }
};

size_t resident_bytes() {
  size_t total = 0;
  size_t resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

RenderSettings first_settings() {
  RenderSettings settings = small_settings(kWidth, kHeight);
  settings.static_lists.rays = 64;  // what they are prepared with would take longer than all else together
  return settings;
}

/// Some slot takes another choice, and sometimes the picture another size. Throws Error if the slots do not combine.
void change_settings(Session& session, Dice& dice) {
  const std::vector<Choice>& choices = all_choices();
  RenderSettings settings =
      combine(session.settings(), choices[dice.below(choices.size())], choices[dice.below(choices.size())]);
  if (dice.once_in(4)) settings.width = kWidth + static_cast<int>(dice.below(9));
  if (dice.once_in(4)) settings.path.max_bounces = static_cast<int>(dice.below(9));
  ASSERT_TRUE(session.set_settings(settings)) << "none of these concerns how the scene is compiled";
}

void change_scene(Session& session, const Stage& stage, Dice& dice) {
  switch (dice.below(5)) {
    case 0: {
      Transform moved = stage.scene.nodes[static_cast<size_t>(stage.mover)].transform;
      moved.translation += Vec3(dice.between(-0.5f, 0.5f), dice.between(0, 0.5f), dice.between(-0.5f, 0.5f));
      session.set_transform(stage.mover, moved);
      break;
    }
    case 1: {
      PunctualLight light = stage.scene.lights.front();
      light.type = static_cast<PunctualType>(dice.below(3));
      light.intensity = Rgb(dice.between(0, 3), dice.between(0, 3), dice.between(0, 3));
      session.set_light(0, light);
      break;
    }
    case 2: {
      const size_t index = dice.below(stage.scene.materials.size());
      Material material = stage.scene.materials[index];
      material.roughness = dice.unit();
      material.metallic = dice.unit();
      material.base_color = Rgb(dice.unit(), dice.unit(), dice.unit());
      session.set_material(static_cast<Index>(index), material);
      break;
    }
    case 3: {
      Environment environment;
      environment.kind = dice.once_in(2) ? EnvironmentKind::none : EnvironmentKind::constant;
      environment.color = Rgb(dice.unit());
      session.set_environment(environment);
      break;
    }
    default: {
      PlacedCamera camera = stage.camera;
      camera.to_world[3] += Vec4(dice.between(-0.4f, 0.4f), dice.between(-0.4f, 0.4f), dice.between(-0.4f, 0.4f), 0);
      session.set_camera(camera);
    }
  }
}

void expect_sane(const Session& session, const std::string& when) {
  const Image image = session.image();
  for (const Rgb& pixel : image.pixels) {
    ASSERT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z)) << when;
    ASSERT_GE(std::min({pixel.x, pixel.y, pixel.z}), 0) << when;
  }
  // The lamp has a radiance of 18; light that is counted again from frame to frame would soon exceed this.
  ASSERT_LT(luminance(estimate_of(image).mean), 20) << when;
}

std::string described(const RenderSettings& settings, int frame) {
  RenderSettings copy = settings;
  std::string text = "frame " + std::to_string(frame) + ":";
  for (const Setting& slot : describe_slots(copy)) text += " " + slot.name + "=" + to_string(slot);
  return text;
}

/// The scene as it was, and everything forgotten.
void put_back(Session& session, const Stage& stage) {
  session.set_transform(stage.mover, stage.scene.nodes[static_cast<size_t>(stage.mover)].transform);
  session.set_light(0, stage.scene.lights.front());
  for (size_t i = 0; i < stage.scene.materials.size(); ++i)
    session.set_material(static_cast<Index>(i), stage.scene.materials[i]);
  session.set_environment(stage.scene.environment);
  session.set_camera(std::nullopt);
  ASSERT_TRUE(session.set_settings(first_settings()));
  session.restart(first_settings().seed);
}

void soak(int frames) {
  Stage stage;
  Session session(Scene(stage.scene), first_settings(), {stage.mover});
  stage.camera = session.scene().camera();
  Dice dice;
  size_t settled_bytes = 0;
  int refused = 0;
  for (int frame = 0; frame < frames; ++frame) {
    if (dice.once_in(8)) {
      try {
        change_settings(session, dice);
      } catch (const Error& error) {
        ++refused;
      }
    }
    if (dice.once_in(3)) change_scene(session, stage, dice);
    if (dice.once_in(200)) session.restart(static_cast<int>(dice.below(1000)));
    session.render_frame();
    ASSERT_NO_FATAL_FAILURE(expect_sane(session, described(session.settings(), frame)));
    if (frame == frames / 2) settled_bytes = resident_bytes();
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, frames / 16);
  EXPECT_LT(static_cast<double>(resident_bytes()), 1.1 * static_cast<double>(settled_bytes) + (16 << 20));

  // Nothing is left of all this: the bits are those of a new session.
  ASSERT_NO_FATAL_FAILURE(put_back(session, stage));
  Session fresh(Scene(stage.scene), first_settings(), {stage.mover});
  for (int i = 0; i < 4; ++i) {
    session.render_frame();
    fresh.render_frame();
  }
  EXPECT_EQ(session.image().pixels, fresh.image().pixels);
}

TEST(Soak, ThreeHundredFrames) { soak(300); }
TEST(SoakSlow, TenThousandFrames) { soak(10000); }

}  // namespace
}  // namespace relume::support
