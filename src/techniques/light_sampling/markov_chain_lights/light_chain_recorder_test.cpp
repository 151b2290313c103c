// Records of light chains, and images with them.
#include "techniques/light_sampling/markov_chain_lights/light_chain_recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

struct TestPath {
  Rgb throughput{1};
  uint32_t bounce = 0;
};
struct TestConnection {
  LightId light = 0;
  Rgb contribution{0};
};

class LightChainRecorderTest : public ::testing::Test {
 protected:
  static constexpr uint32_t kPixels = 4000;

  LightChainRecorder recorder(uint32_t pixel = 0) {
    recording_.chains = {table_.grid, table_.view(), 0.2f};
    recording_.tree = data_.view(scene_.lights());
    recording_.out = {mutable_view_of(records_), 2, kPixels};
    LightChainRecorder recorder;
    recorder.recording = &recording_;
    recorder.pixel = pixel;
    return recorder;
  }
  const MarkovRecord<LightState>& record(uint32_t vertex, uint32_t pixel = 0) const {
    return records_[vertex * kPixels + pixel];
  }
  bool has_both_cells(uint32_t pixel = 0) const {
    return record(0, pixel).cells[0].slot != kNoSlot && record(0, pixel).cells[1].slot != kNoSlot;
  }

  testing::LightScene scene_ = testing::make_light_scene({});
  LightTreeData data_ = build_light_tree(scene_.lights());
  testing::FilledTable<LightState> table_;
  std::vector<MarkovRecord<LightState>> records_ = std::vector<MarkovRecord<LightState>>(2 * size_t{kPixels});
  LightChainRecording recording_;
  SurfacePoint floor_ = testing::point_at({1, 0, 2}, Vec3(0, 1, 0));
};

TEST_F(LightChainRecorderTest, AVisibleLightOfTheTreeStartsAChain) {
  LightChainRecorder r = recorder();
  const TestPath path{Rgb(0.5f)};
  r.light_picked(floor_, path, 1);
  r.connected(floor_, path, TestConnection{1, Rgb(2)}, true);
  r.finished(path);
  EXPECT_TRUE(has_both_cells());
  EXPECT_EQ(record(0).state.light, 1u);
  EXPECT_NEAR(record(0).state.weight, 4, 1e-5f);
  EXPECT_EQ(record(0).state.count, 1u);
  EXPECT_EQ(record(1).cells[0].slot, kNoSlot);
}

TEST_F(LightChainRecorderTest, AHiddenOrDarkLightFadesInItsCell) {
  table_.fill(floor_, [](uint32_t) { return LightState{1, 4, 1}; });
  for (const bool connects : {true, false}) {
    LightChainRecorder r = recorder();
    const TestPath path;
    r.light_picked(floor_, path, 1);
    if (connects) r.connected(floor_, path, TestConnection{1, Rgb(2)}, false);
    r.finished(path);
    EXPECT_EQ(record(0).state.light, 1u);
    EXPECT_NEAR(record(0).state.weight, 2, 1e-5f);  // the mean of 4 and 0
    EXPECT_EQ(record(0).state.count, 2u);
    EXPECT_EQ(table_.view().load(record(0).cells[0]).weight, 4.0f) << "the cell of the chain";
    EXPECT_EQ(record(0).cells[1].slot, kNoSlot);
  }
}

TEST_F(LightChainRecorderTest, OtherLightsFadeNowhere) {
  table_.fill(floor_, [](uint32_t) { return LightState{1, 4, 1}; });
  LightChainRecorder r = recorder();
  r.light_picked(floor_, TestPath{}, 2);
  r.finished(TestPath{});
  EXPECT_EQ(record(0).cells[0].slot, kNoSlot);
}

TEST_F(LightChainRecorderTest, AcceptsInProportionToTheScore) {
  table_.fill(floor_, [](uint32_t) { return LightState{1, 4, 1}; });
  int accepted = 0;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    LightChainRecorder r = recorder(pixel);
    const TestPath path;
    r.light_picked(floor_, path, 2);
    r.connected(floor_, path, TestConnection{2, Rgb(1)}, true);
    r.finished(path);
    accepted += has_both_cells(pixel) ? 1 : 0;
  }
  EXPECT_NEAR(accepted, kPixels / 4.0, 5 * std::sqrt(kPixels * 0.25 * 0.75));
}

constexpr int kSize = 32;

/// A floor below a plate. One lamp is under the plate, and 16 brighter ones are above it.
Scene covered_floor() {
  SceneBuilder builder("covered");
  const Index white = builder.add_material(matte("white", Rgb(0.6f)));
  builder.add("floor", quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), white);
  builder.add("plate", quad({-4, 2.2f, -4}, {8, 0, 0}, {0, 0, 8}), white);
  const Index bright = builder.add_material(emitter("bright", Rgb(40)));
  for (int i = 0; i < 16; ++i) {
    const Vec3 corner(static_cast<float>(i % 4) - 2, 2.4f, static_cast<float>(i / 4) - 2);
    builder.add("lamp", quad(corner, {0.2f, 0, 0}, {0, 0, 0.2f}), bright);
  }
  builder.add("low lamp", quad({-0.1f, 2, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}),
              builder.add_material(emitter("low", Rgb(20))));
  builder.add_camera({0, 1.2f, 3.5f}, {0, 0, 0}, 40);
  return builder.take();
}

/// Mean square of the luminance of frames at a seed, after frames to learn.
double mean_square(const Scene& scene, EstimatorChoice estimator, LightSelectionChoice lights, int seed) {
  RenderSettings s;
  s.width = s.height = kSize;
  s.threads = 1;
  s.seed = seed;
  s.path.max_bounces = 1;
  s.history = HistoryChoice::none;
  s.estimator = estimator;
  s.lights = lights;
  Session session(Scene(scene), s);
  double square = 0;
  for (int i = 0; i < 32; ++i) {
    session.render_frame();
    if (i < 24) continue;
    for (const Rgb& p : session.image().pixels) square += static_cast<double>(luminance(p) * luminance(p));
  }
  return square;
}

TEST(LightChainSession, LowersTheNoiseOfHiddenLamps) {
  const Scene scene = covered_floor();
  for (const EstimatorChoice estimator : {EstimatorChoice::path, EstimatorChoice::bdpt}) {
    double chains = 0;
    double tree = 0;
    for (int seed = 1; seed <= 3; ++seed) {
      chains += mean_square(scene, estimator, LightSelectionChoice::mcls, seed);
      tree += mean_square(scene, estimator, LightSelectionChoice::light_tree, seed);
    }
    EXPECT_LT(chains, 0.5 * tree) << static_cast<int>(estimator);
  }
}

}  // namespace
}  // namespace relume
