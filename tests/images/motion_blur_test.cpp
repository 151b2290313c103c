// Tests that an open shutter shows the mean of many sharp images at times within it, with every estimator and both
// acceleration structures, and that a closed one changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "core/hash.h"
#include "relume/error.h"
#include "render/session.h"
#include "scene/testing/figure.h"
#include "support/image_test.h"
#include "support/scenes.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr int kSeeds = 16;
constexpr float kTime = 0.5f;
constexpr float kShutter = 0.8f;

AnimationChannel turn(Index node, float angle_rad, const Vec3& axis) {
  AnimationChannel channel;
  channel.node = node;
  channel.property = AnimatedProperty::rotation;
  channel.times = {0, 1};
  channel.values = {Vec4(0, 0, 0, 1), Vec4(std::sin(angle_rad / 2) * axis, std::cos(angle_rad / 2))};
  return channel;
}

AnimationChannel shift(Index node, const Vec3& from, const Vec3& to) {
  AnimationChannel channel;
  channel.node = node;
  channel.property = AnimatedProperty::translation;
  channel.times = {0, 1};
  channel.values = {Vec4(from, 0), Vec4(to, 0)};
  return channel;
}

/// A plate that turns by 90° per second before a wall, with a lamp at its end and a shiny hub, seen by a camera that
/// moves along.
Scene turning_plate() {
  SceneBuilder builder("turning plate");
  const Index grey = builder.add_material(matte("grey", Rgb(0.5f)));
  const Index red = builder.add_material(matte("red", Rgb(0.8f, 0.2f, 0.1f)));
  const Index steel = builder.add_material(metal("steel", Rgb(0.9f), 0.3f));
  builder.add("wall", quad({-4, -4, -1}, {8, 0, 0}, {0, 8, 0}), grey);
  builder.add("lamp", quad({-2, 3, 2}, {4, 0, 0}, {0, 0, -2}), builder.add_material(emitter("light", Rgb(6))));
  const Index arm = builder.add_group("arm");
  builder.add("plate", quad({-1.5f, -0.25f, 0}, {3, 0, 0}, {0, 0.5f, 0}), red, {}, arm);
  builder.add("hub", box({-0.3f, -0.3f, 0.05f}, {0.3f, 0.3f, 0.4f}), steel, {}, arm);
  builder.add("end", quad({1.2f, -0.2f, 0.1f}, {0.3f, 0, 0}, {0, 0.4f, 0}),
              builder.add_material(emitter("end light", Rgb(3, 5, 8))), {}, arm);
  builder.add_channel(turn(arm, kPi / 2, Vec3(0, 0, 1)));
  const Index camera = builder.add_camera({0, 0.3f, 5}, {0, 0, 0}, 40);
  builder.add_channel(shift(camera, {-0.3f, 0.3f, 5}, {0.3f, 0.3f, 4.6f}));
  Environment none;
  none.kind = EnvironmentKind::none;
  builder.set_environment(none);
  return builder.take();
}

/// A figure that bends by its joints and thickens by a morph target.
Scene walking_figure() { return in_a_room(testing::figure({.joints = 3, .morphs = true, .swing_rad = 0.8f})); }

struct Case {
  const char* name;
  Scene (*scene)();
  EstimatorChoice estimator;
  AccelChoice accel;
  int width;
  int height;
  int spp;
  double blocks;  ///< as ImageTestOptions::detectable
  double mean;
  float lens = 0;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
std::string case_name(const ::testing::TestParamInfo<Case>& info) { return test_name(info.param.name); }

constexpr auto kPath = EstimatorChoice::path;
constexpr auto kBdpt = EstimatorChoice::bdpt;
constexpr auto kLight = EstimatorChoice::light;
constexpr auto kVcm = EstimatorChoice::vcm;
constexpr auto kEmbree = AccelChoice::embree;
constexpr auto kBvh = AccelChoice::bvh;

// Every estimator, and both scenes with either acceleration structure.
const Case kQuick[] = {
    {"plate path", turning_plate, kPath, kEmbree, 32, 24, 64, 0.15, 0.06},
    {"plate path lens", turning_plate, kPath, kEmbree, 32, 24, 64, 0.15, 0.06, 0.1f},
    {"plate light", turning_plate, kLight, kBvh, 32, 24, 64, 0.3, 0.1},
    {"plate vcm", turning_plate, kVcm, kEmbree, 32, 24, 64, 0.2, 0.1},
    {"figure path embree", walking_figure, kPath, kEmbree, 32, 24, 64, 0.15, 0.06},
    {"figure bdpt", walking_figure, kBdpt, kBvh, 32, 24, 64, 0.15, 0.06},
};

const Case kSharp[] = {
    {"plate path", turning_plate, kPath, kEmbree, 64, 48, 256, 0.05, 0.02},
    {"plate bdpt lens", turning_plate, kBdpt, kBvh, 64, 48, 256, 0.05, 0.02, 0.1f},
    {"figure path", walking_figure, kPath, kBvh, 64, 48, 256, 0.05, 0.02},
    {"figure bdpt", walking_figure, kBdpt, kEmbree, 64, 48, 256, 0.05, 0.02},
    // Other pairs of estimator and acceleration structure, less precisely.
    {"plate path bvh", turning_plate, kPath, kBvh, 32, 24, 64, 0.15, 0.06},
    {"plate bdpt", turning_plate, kBdpt, kEmbree, 32, 24, 64, 0.15, 0.06},
    {"figure vcm", walking_figure, kVcm, kBvh, 32, 24, 64, 0.2, 0.1},
};

Scene scene_of(const Case& c) {
  Scene scene = c.scene();
  scene.cameras[0].lens_radius = c.lens;
  scene.cameras[0].focus_distance = 4;
  return scene;
}

RenderSettings settings_of(const Case& c) {
  RenderSettings s = small_settings(c.width, c.height);
  s.path.max_bounces = 3;
  s.accel = c.accel;
  s.time_s = kTime;
  s.vcm.radius = 0.001f;
  return s;
}

/// The mean of sharp images at stratified times, by path tracing.
Image brute_force(const Scene& scene, RenderSettings settings, int times, int seed) {
  settings.seed = seed;
  settings.estimator = EstimatorChoice::path;
  Session session(scene, settings);
  Image sum(settings.width, settings.height);
  for (int i = 0; i < times; ++i) {
    const float u = to_unit_float(hash(static_cast<uint32_t>(seed), static_cast<uint32_t>(i)));
    session.set_time(kTime + kShutter * ((static_cast<float>(i) + u) / static_cast<float>(times) - 0.5f));
    session.render_frame();
    const Image sharp = session.image();
    for (size_t p = 0; p < sum.pixels.size(); ++p) sum.pixels[p] += sharp.pixels[p] / static_cast<float>(times);
  }
  return sum;
}

/// Images of brute force, rendered once per process: cases that differ by the estimator or the acceleration structure
/// share them.
const Moments& sharp_images(const Case& c) {
  static std::map<std::tuple<bool, float, int, int>, Moments> known;
  const auto [found, is_new] = known.try_emplace({c.scene == turning_plate, c.lens, c.width, c.spp});
  if (is_new) {
    const Scene scene = scene_of(c);
    RenderSettings closed = settings_of(c);
    closed.accel = kEmbree;
    std::vector<Image> images;
    for (int seed = 1; seed <= kSeeds; ++seed) images.push_back(brute_force(scene, closed, c.spp, 1000 + seed));
    found->second = moments_of(std::move(images));
  }
  return found->second;
}

class MotionBlur : public ::testing::TestWithParam<Case> {};

TEST_P(MotionBlur, IsTheMeanOfSharpImages) {
  const Case& c = GetParam();
  RenderSettings open = settings_of(c);
  open.estimator = c.estimator;
  open.shutter_s = kShutter;
  open.shutter_keys = 17;
  ImageTestOptions options{.detectable = c.blocks, .detectable_mean = c.mean};
  options.pixels = c.estimator != EstimatorChoice::light;
  if (c.estimator == EstimatorChoice::vcm) options.tolerance = 0.03;  // merging blurs
  expect_same_image("motion-blur-" + test_name(c.name), measure(scene_of(c), open, c.spp, kSeeds, 1), sharp_images(c),
                    options);
}

INSTANTIATE_TEST_SUITE_P(All, MotionBlur, ::testing::ValuesIn(kQuick), case_name);
INSTANTIATE_TEST_SUITE_P(SlowAll, MotionBlur, ::testing::ValuesIn(kSharp), case_name);

/// The comparison must be able to fail: a sharp image differs from a blurred one.
TEST(MotionBlurTest, ASharpImageDiffers) {
  const Scene scene = turning_plate();
  RenderSettings settings = settings_of(kQuick[0]);
  const Moments sharp = measure(scene, settings, 64, kSeeds, 1);
  settings.shutter_s = kShutter;
  EXPECT_FALSE(compare(sharp, measure(scene, settings, 64, kSeeds, 1001)).agree());
}

TEST(MotionBlurTest, AClosedShutterEqualsNone) {
  for (const auto build : {turning_plate, walking_figure}) {
    for (const AccelChoice accel : {kEmbree, kBvh}) {
      for (const EstimatorChoice estimator : {kPath, kBdpt, kVcm}) {
        Case c = kQuick[0];
        c.accel = accel;
        RenderSettings settings = settings_of(c);
        settings.estimator = estimator;
        const Image none = render(build(), settings, 2);
        settings.shutter_keys = 33;
        EXPECT_EQ(render(build(), settings, 2).pixels, none.pixels);
        RenderSettings open = settings;
        open.shutter_s = kShutter;
        Session session(build(), open);
        session.render_frame();
        ASSERT_TRUE(session.set_settings(settings));
        session.restart(settings.seed);
        session.render_frame();
        session.render_frame();
        if (accel == kBvh) {
          EXPECT_EQ(session.image().pixels, none.pixels);
        }
      }
    }
  }
}

TEST(MotionBlurTest, FramesAreTheSameAgain) {
  RenderSettings settings = settings_of(kQuick[0]);
  settings.shutter_s = kShutter;
  for (const EstimatorChoice estimator : {kPath, kBdpt, kVcm}) {
    settings.estimator = estimator;
    settings.threads = 1;
    const Image one = render(walking_figure(), settings, 3);
    settings.threads = 3;
    EXPECT_EQ(render(walking_figure(), settings, 3).pixels, one.pixels);
  }
}

TEST(MotionBlurTest, BothFormsOfKernelsGiveTheSameBits) {
  RenderSettings settings = settings_of(kQuick[0]);
  settings.accel = kBvh;
  settings.shutter_s = kShutter;
  for (const EstimatorChoice estimator : {kPath, kBdpt, kVcm}) {
    settings.estimator = estimator;
    for (const auto build : {turning_plate, walking_figure}) {
      settings.scalar_kernels = false;
      const Image packets = render(build(), settings, 3);
      settings.scalar_kernels = true;
      EXPECT_EQ(render(build(), settings, 3).pixels, packets.pixels);
    }
  }
}

TEST(MotionBlurTest, TechniquesOfOneTimeAreRefused) {
  RenderSettings settings = settings_of(kQuick[0]);
  settings.shutter_s = kShutter;
  const auto expect_refused = [&](const auto& set) {
    RenderSettings refused = settings;
    set(refused);
    EXPECT_THROW(Session(turning_plate(), refused), Error);
    refused.shutter_s = 0;
    EXPECT_NO_THROW(Session(turning_plate(), refused));
  };
  expect_refused([](RenderSettings& s) { s.reuse = ReuseChoice::ris; });
  expect_refused([](RenderSettings& s) { s.denoise = DenoiseChoice::asvgf; });
  expect_refused([](RenderSettings& s) { s.history = HistoryChoice::reproject; });
}

/// Light of caches and histories averages over the shutter, and keeps the mean of the image.
TEST(MotionBlurTest, CachesAndHistoriesKeepTheMean) {
  const Scene scene = turning_plate();
  RenderSettings settings = settings_of(kQuick[0]);
  settings.shutter_s = kShutter;
  const double expected = mean_luminance(render(scene, settings, 256));
  const auto expect_mean = [&](const char* name, double tolerance, const auto& set) {
    RenderSettings s = settings;
    s.seed = 5;
    set(s);
    EXPECT_NEAR(mean_luminance(render(scene, s, 64)) / expected, 1, tolerance) << name;
  };
  expect_mean("light-tree", 0.02, [](RenderSettings& s) { s.lights = LightSelectionChoice::light_tree; });
  expect_mean("static-lists", 0.02, [](RenderSettings& s) { s.lights = LightSelectionChoice::static_lists; });
  expect_mean("vlc", 0.02, [](RenderSettings& s) { s.lights = LightSelectionChoice::vlc; });
  expect_mean("cdq", 0.02, [](RenderSettings& s) { s.guide = GuideChoice::cdq; });
  expect_mean("psf", 0.06, [](RenderSettings& s) { s.cache = CacheChoice::psf; });
  expect_mean("apsf", 0.06, [](RenderSettings& s) { s.cache = CacheChoice::apsf; });
  expect_mean("apg", 0.06, [](RenderSettings& s) { s.cache = CacheChoice::apg; });
  expect_mean("sharc", 0.08, [](RenderSettings& s) { s.cache = CacheChoice::sharc; });
  expect_mean("adaptive", 0.03, [](RenderSettings& s) { s.allocation = AllocationChoice::adaptive; });
  expect_mean("reproject", 0.03, [](RenderSettings& s) {
    s.history = HistoryChoice::reproject;
    s.reproject.method = ReprojectionMethod::backward;
  });
  expect_mean("svgf", 0.05, [](RenderSettings& s) { s.denoise = DenoiseChoice::svgf; });
}

/// Median time of a frame, from alternating frames.
double cost_of_open_shutter(const Scene& scene, AccelChoice accel) {
  constexpr int kFrames = 15;
  RenderSettings settings = small_settings(320, 180);
  settings.path.max_bounces = 4;
  settings.accel = accel;
  settings.time_s = kTime;
  Session closed(scene, settings);
  settings.shutter_s = 1.0f / 48;
  Session open(scene, settings);
  std::vector<double> ratios;
  const auto time_of = [](Session& session) {
    const double start_s = now_s();
    session.render_frame();
    return now_s() - start_s;
  };
  time_of(closed);
  time_of(open);
  for (int i = 0; i < kFrames; ++i) {
    const double without_s = time_of(closed);
    ratios.push_back(time_of(open) / without_s);
  }
  std::nth_element(ratios.begin(), ratios.begin() + kFrames / 2, ratios.end());
  return ratios[kFrames / 2];
}

TEST(SlowMotionBlur, CostsAtMostFifteenPercent) {
  for (const auto build : {turning_plate, walking_figure}) {
    for (const AccelChoice accel : {kEmbree, kBvh}) {
      const double ratio = cost_of_open_shutter(build(), accel);
      std::cerr << "a frame with an open shutter takes " << ratio << " times as long\n";
      EXPECT_LT(ratio, 1.15);
    }
  }
}

}  // namespace
}  // namespace relume::support
