// Soak test: one session renders thousands of frames while techniques, settings and the scene change randomly. Fails on
// crashes, leaks, leftover state and NaN.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "builtin_scenes/builtin.h"
#include "combinations/cells.h"
#include "core/hash.h"
#include "metrics/statistics.h"
#include "relume/error.h"
#include "render/session.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 18;
constexpr int kFramesBetweenChecks = 150;  // checks for drift
constexpr int kSettling = 32;              // in frames
#if defined(__SANITIZE_ADDRESS__)          // keeps 256 MiB of freed memory, and detects leaks
constexpr size_t kMostGrowth = 300 << 20;
#else
constexpr size_t kMostGrowth = 8 << 20;  // in bytes, over half of the frames
#endif

/// Random numbers by index, the same in every run.
class Dice {
 public:
  uint32_t below(size_t n) { return static_cast<uint32_t>(unit() * static_cast<float>(n)); }
  float unit() { return to_unit_float(hash(count_++, 77u)); }
  float between(float low, float high) { return low + (high - low) * unit(); }
  bool once_in(size_t n) { return below(n) == 0; }

 private:
  uint32_t count_ = 0;
};

/// The box with a point light and a movable camera.
struct Stage {
  Scene scene;
  Index mover = kNone;
  CameraPose camera;

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
  settings.threads = 4;
  settings.static_lists.rays = 64;  // their preparation would dominate the test's time
  return settings;
}

/// Settings below the slots, with values to set during rendering.
struct Detail {
  const char* name;
  std::array<const char*, 3> values;
};
constexpr std::array kDetails = {
    Detail{"octree.vertices", {"1", "2", "4"}},
    Detail{"octree.jitter", {"0", "1", "2"}},
    Detail{"octree.split", {"8", "64", "4096"}},
    Detail{"octree.max-depth", {"1", "4", "16"}},
    Detail{"vlc.bucket-size", {"1", "4", "32"}},
    Detail{"vlc.memory", {"0", "4", "30"}},
    Detail{"vlc.exploration-cells", {"1", "2", "32"}},
    Detail{"vlc.hysteresis", {"0", "0.75", "1"}},
    Detail{"vlc.max-samples", {"1", "64", "4096"}},
    Detail{"vlc.energy-weight", {"0.01", "1", "1000"}},
    Detail{"vlc.change-weight", {"0", "1", "1000"}},
    Detail{"vlc.distance-weight", {"0", "1", "1000"}},
    Detail{"bdpt.caustic-layer", {"off", "on", "on"}},
    Detail{"cdq.bits", {"32", "64", "128"}},
    Detail{"cdq.memory", {"0", "8", "100"}},
    Detail{"cdq.sampling", {"bottom-up", "stratified", "bottom-up"}},
    Detail{"cdq.spread", {"0", "1", "8"}},
    Detail{"cdq.stability", {"0.001", "0.1", "1"}},
    Detail{"psf.cell-size", {"2", "8", "64"}},
    Detail{"psf.undersampled-cells", {"keep", "coarser", "neighbours+coarser"}},
    Detail{"psf.max-cells", {"0", "64", "4096"}},
    Detail{"psf.edge-rays", {"0", "1", "16"}},
    Detail{"psf.min-roughness", {"0", "0.2", "1"}},
    Detail{"psf.split", {"off", "on", "on"}},
    Detail{"psf.refine", {"0", "1", "2"}},
    Detail{"apg.feed", {"0", "0.25", "1"}},
    Detail{"apg.guards", {"off", "on", "on"}},
    Detail{"apg.variance-constant", {"0", "0.1", "10"}},
    Detail{"sharc.update", {"sparse", "all", "all"}},
    Detail{"sharc.end", {"footprint", "variance", "variance"}},
    Detail{"sharc.feedback", {"off", "on", "on"}},
    Detail{"sharc.propagation-depth", {"2", "4", "8"}},
    Detail{"sharc.max-cells", {"0", "64", "4096"}},
    Detail{"sharc.frames", {"1", "32", "1024"}},
    Detail{"apsf.survival-measure", {"variance", "standard-error", "standard-error"}},
    Detail{"apsf.survival-floor", {"0.01", "0.1", "1"}},
    Detail{"apsf.blend", {"automatic", "step", "one-over-square"}},
    Detail{"adaptive.min", {"2", "4", "16"}},
    Detail{"reproject.stored", {"1", "4", "4"}},
    Detail{"reproject.exposure", {"-3", "0", "3"}},
    Detail{"features.edge-rays", {"0", "1", "16"}},
    Detail{"bmfr.alpha", {"0", "0.2", "1"}},
    Detail{"bmfr.detail", {"0", "1.5", "10"}},
    Detail{"bmfr.max-history", {"1", "32", "1024"}},
    Detail{"bmfr.newest", {"0.01", "0.2", "1"}},
    Detail{"svgf.levels", {"0", "3", "5"}},
    Detail{"svgf.light-tolerance", {"0.01", "2", "1000"}},
    Detail{"svgf.plane-tolerance", {"0.001", "1", "1000"}},
    Detail{"svgf.max-history-changed", {"1", "8", "1024"}},
    Detail{"svgf.newest", {"0.01", "0.2", "1"}},
    Detail{"asvgf.alpha", {"0.01", "0.1", "1"}},
    Detail{"asvgf.antilag", {"0", "1", "100"}},
    Detail{"asvgf.gradient-levels", {"0", "3", "5"}},
};

/// Changes a slot's choice, a setting, and sometimes the image size. Throws Error if the slots do not combine.
void change_settings(Session& session, Dice& dice) {
  const std::vector<Choice>& choices = all_choices();
  RenderSettings settings =
      combine(render_settings(session), choices[dice.below(choices.size())], choices[dice.below(choices.size())]);
  if (dice.once_in(4)) settings.width = kWidth + static_cast<int>(dice.below(9));
  if (dice.once_in(4)) settings.path.max_bounces = static_cast<int>(dice.below(9));
  const Detail& detail = kDetails[dice.below(kDetails.size())];
  assign(require_setting(describe(settings), detail.name, ""), detail.values[dice.below(3)], "");
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
      const EnvironmentKind kinds[] = {EnvironmentKind::none, EnvironmentKind::constant, EnvironmentKind::sun_sky};
      environment.kind = kinds[dice.below(3)];
      environment.sun_sky.sun_elevation_rad = dice.between(0.1f, 1.4f);
      environment.sun_sky.sky_scale = environment.sun_sky.sun_scale = 1e-4f;
      environment.color = Rgb(dice.unit());
      session.set_environment(environment);
      break;
    }
    default: {
      CameraPose camera = stage.camera;
      camera.to_world[3] += Vec4(dice.between(-0.4f, 0.4f), dice.between(-0.4f, 0.4f), dice.between(-0.4f, 0.4f), 0);
      if (dice.once_in(4)) camera.camera.lens_radius = dice.between(0, 0.1f);
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
  // The lamp's radiance is 18; energy counted again in each frame would soon exceed it.
  ASSERT_LT(luminance(estimate_of(image).mean), 20) << when;
}

std::string described(const RenderSettings& settings, int frame) {
  RenderSettings copy = settings;
  std::string text = "frame " + std::to_string(frame) + ":";
  for (const Setting& slot : describe_slots(copy)) text += " " + slot.name + "=" + to_string(slot);
  return text;
}

/// Mean brightness in a static scene (or with a camera that oscillates by `step_m`), after `settling` frames. Pixels
/// count as L / (1 + L), so that single bright paths do not hide drift.
double brightness_shown(Session& session, int settling = kSettling, float step_m = 0) {
  constexpr int kFrames = 32;
  CameraPose camera = session.camera();
  double sum = 0;
  for (int i = 0; i < settling + kFrames; ++i) {
    if (step_m > 0) {
      camera.to_world[3].x += i % 2 == 0 ? step_m : -step_m;
      session.set_camera(camera);
    }
    session.render_frame();
    if (i < settling) continue;
    const Image image = session.image();
    double of_frame = 0;
    for (const Rgb& pixel : image.pixels) of_frame += static_cast<double>(1.0f - 1.0f / (1.0f + luminance(pixel)));
    sum += of_frame / static_cast<double>(image.pixels.size());
  }
  return sum / kFrames;
}

/// Expects the brightness after all frames so far to equal that of a fresh start.
void expect_no_drift(Session& session, const std::string& when) {
  constexpr float kStep_m = 1e-3f;
  // Moves the camera if histories are reprojected, since only these can drift. Up to 16 samples remain from before a
  // change (reproject.max-samples-changed), which 256 frames outweigh.
  const bool hands_on = render_settings(session).history == HistoryChoice::reproject;
  const float step_m = hands_on ? kStep_m : 0;
  brightness_shown(session, hands_on ? 256 : kSettling, step_m);  // cells detect changes within 32 frames
  if (!hands_on) {
    CameraPose camera = session.camera();
    camera.to_world[3].x += kStep_m;
    session.set_camera(camera);  // resets the mean, which includes earlier frames
  }
  const double before = brightness_shown(session, kSettling, step_m);
  std::vector<double> restarted;
  for (int seed = 0; seed < 4; ++seed) {
    session.restart(seed);
    restarted.push_back(brightness_shown(session, kSettling, step_m));
  }
  const double noise = standard_deviation(restarted);
  EXPECT_NEAR(before, mean(restarted), 0.2 * std::max(before, mean(restarted)) + 3 * noise + 0.01) << when;
}

/// Combinations with the most state between frames.
constexpr const char* kWhatRemembers[] = {
    R"({"lights": "vlc", "guide": "cdq", "denoise": "svgf"})",
    R"({"cache": "apsf+apg", "denoise": "bmfr"})",
    R"({"cache": "psf", "history": "reproject", "reproject.method": "backward"})",
    R"({"lights": "static-lists", "allocation": "adaptive", "history": "reproject"})",
    R"({"lights": "light-tree", "reuse": "restir-di", "denoise": "svgf"})",
    R"({"lights": "vlc", "guide": "cdq", "cache": "apsf+apg", "octree.vertices": 4})",
    R"({"reuse": "restir-gi", "restir-gi.correction": "lagging", "denoise": "svgf"})",
    R"({"cache": "sharc", "reuse": "restir-gi", "restir-gi.correction": "lagging"})",
    R"({"reuse": "restir-di+gi", "restir.correction": "lagging", "restir-gi.correction": "lagging"})",
    R"({"reuse": "restir-pt", "restir-pt.correction": "lagging", "denoise": "svgf"})",
    R"({"cache": "sharc", "reuse": "restir-pt", "restir-pt.correction": "lagging"})",
    R"({"estimator": "bdpt", "reuse": "restir-gi", "restir-gi.correction": "lagging"})",
    R"({"lights": "mcls", "guide": "mcpg", "denoise": "svgf"})",
    R"({"lights": "mcls", "guide": "mcpg", "cache": "apsf+apg"})"};

/// Restores the scene and resets all state.
void put_back(Session& session, const Stage& stage, const RenderSettings& settings) {
  session.set_transform(stage.mover, stage.scene.nodes[static_cast<size_t>(stage.mover)].transform);
  session.set_light(0, stage.scene.lights.front());
  for (size_t i = 0; i < stage.scene.materials.size(); ++i)
    session.set_material(static_cast<Index>(i), stage.scene.materials[i]);
  session.set_environment(stage.scene.environment);
  session.set_camera(std::nullopt);
  ASSERT_TRUE(session.set_settings(settings));
  session.restart(settings.seed);
}

/// Expects no state to remain: bits equal those of a new session, even one with a single thread.
void expect_nothing_stays(Session& session, const Stage& stage, const RenderSettings& settings) {
  ASSERT_NO_FATAL_FAILURE(put_back(session, stage, settings));
  RenderSettings of_one_thread = settings;
  of_one_thread.threads = 1;
  Session fresh(Scene(stage.scene), of_one_thread, {stage.mover});
  for (int i = 0; i < 4; ++i) {
    session.render_frame();
    fresh.render_frame();
  }
  EXPECT_EQ(session.image().pixels, fresh.image().pixels) << described(settings, 0);
}

void soak(int frames) {
  Stage stage;
  Session session(Scene(stage.scene), first_settings(), {stage.mover});
  stage.camera = session.camera();
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
    ASSERT_NO_FATAL_FAILURE(expect_sane(session, described(render_settings(session), frame)));
    if (frame % kFramesBetweenChecks == kFramesBetweenChecks - 1)
      expect_no_drift(session, described(render_settings(session), frame));
    if (frame == frames / 2) settled_bytes = resident_bytes();
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, frames / 16);
  EXPECT_LT(resident_bytes(), settled_bytes + kMostGrowth);

  ASSERT_NO_FATAL_FAILURE(expect_nothing_stays(session, stage, render_settings(session)));
  for (const char* json : kWhatRemembers) {
    RenderSettings settings = first_settings();
    settings_from_json(describe(settings), json, "soak");
    ASSERT_TRUE(session.set_settings(settings));
    for (int i = 0; i < 16; ++i) {
      change_scene(session, stage, dice);
      session.render_frame();
    }
    ASSERT_NO_FATAL_FAILURE(expect_nothing_stays(session, stage, settings));
  }
}

TEST(Soak, ThreeHundredFrames) { soak(300); }
TEST(SoakSlow, TenThousandFrames) { soak(10000); }

}  // namespace
}  // namespace relume::support
