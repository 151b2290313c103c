#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "render/session.h"
#include "techniques/reuse/restir_di/testing/lamps_over_plate.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

using testing::deviation;
using testing::error_of;
using testing::Measured;
using testing::measured_over;

constexpr int kSize = 24;
constexpr size_t kSide = kSize;
constexpr size_t kPixels = kSide * kSide;

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.restir.radius = 5;
  settings.path.max_bounces = 1;
  return settings;
}

// --- Blocks along edges -------------------------------------------------------------------------------

constexpr int kMoving = 6;
constexpr int kKept = 8;

/// The mean over eight frames at rest after six in motion.
Image after_a_move(Session& session, int seed, int kept) {
  session.set_camera(std::nullopt);
  session.restart(seed);
  CameraPose camera = session.camera();
  for (int i = 0; i < kMoving; ++i) {
    camera.to_world[3] += 0.02f * camera.to_world[0];
    session.set_camera(camera);
    session.render_frame();
  }
  for (int i = 0; i < kept; ++i) session.render_frame();
  return session.image();
}

float value_at(const Image& image, size_t pixel) { return luminance(image.pixels[pixel]); }

/// Whether the pixel's value differs from that of a neighbour by more than 30 %.
bool is_edge(size_t pixel, const std::vector<float>& values) {
  const size_t x = pixel % kSide;
  const size_t y = pixel / kSide;
  const auto differs = [&](size_t other) {
    const float a = values[pixel];
    const float b = values[other];
    return std::max(a, b) > 1.3f * std::min(a, b);
  };
  return (x > 0 && differs(pixel - 1)) || (x + 1 < kSide && differs(pixel + 1)) || (y > 0 && differs(pixel - kSide)) ||
         (y + 1 < kSide && differs(pixel + kSide));
}

using Pixels = std::vector<size_t>;

/// The image without reuse, and its edges by blocks of 6 × 6 pixels.
struct Truth {
  std::vector<Image> images;  ///< by seed
  std::vector<Pixels> depth_blocks;
  std::vector<Pixels> shadow_blocks;
  Pixels depth_edges;
  Pixels shadow_edges;
};

Truth make_truth() {
  constexpr int kBlock = 6;
  constexpr size_t kBlocks = kSide / kBlock;
  Truth truth;
  RenderSettings settings = settings_of(ReuseChoice::none);
  settings.auxiliary = true;
  Session session(testing::cards_under_lamps(), settings);
  std::vector<float> light(kPixels);
  for (int seed = 1; seed <= 12; ++seed) {
    truth.images.push_back(after_a_move(session, seed, 128));
    for (size_t p = 0; p < kPixels; ++p) light[p] += value_at(truth.images.back(), p);
  }
  const std::vector<float> depth = session.aov("depth").front().values;
  truth.depth_blocks.resize(kBlocks * kBlocks);
  truth.shadow_blocks.resize(kBlocks * kBlocks);
  for (size_t p = 0; p < kPixels; ++p) {
    const size_t block = p / kSide / kBlock * kBlocks + p % kSide / kBlock;
    if (is_edge(p, depth)) {
      truth.depth_blocks[block].push_back(p);
      truth.depth_edges.push_back(p);
    } else if (is_edge(p, light)) {
      truth.shadow_blocks[block].push_back(p);
      truth.shadow_edges.push_back(p);
    }
  }
  return truth;
}

const Truth& truth() {
  static const Truth result = make_truth();
  return result;
}

Measured mean_of(const std::vector<Image>& images, const Pixels& pixels) {
  std::vector<double> means;
  for (const Image& image : images) {
    double sum = 0;
    for (const size_t p : pixels) sum += static_cast<double>(value_at(image, p));
    means.push_back(sum / static_cast<double>(pixels.size()));
  }
  return measured_over(means);
}

std::vector<Image> images_of(const RestirSettings& restir, int seeds) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  settings.restir = restir;
  settings.restir.radius = 5;
  Session session(testing::cards_under_lamps(), settings);
  std::vector<Image> images;
  for (int seed = 1; seed <= seeds; ++seed) images.push_back(after_a_move(session, seed, kKept));
  return images;
}

class RestirEdges : public ::testing::TestWithParam<RestirSettings> {};

/// Reuse across an edge must not darken or brighten it. Means of whole images hide such a bias. A model of averages
/// predicts an error of about 1 % for all edges in the noisiest mode.
TEST_P(RestirEdges, HaveTheMeanOfPathTracing) {
  const std::vector<Image> images = images_of(GetParam(), 32);
  for (const bool depth : {true, false}) {
    const Pixels& all = depth ? truth().depth_edges : truth().shadow_edges;
    ASSERT_GE(all.size(), 24u);
    const Measured expected = mean_of(truth().images, all);
    const Measured edges = mean_of(images, all);
    EXPECT_LT(error_of(edges, expected), 0.02 * expected.mean) << (depth ? "depth" : "shadow");
    EXPECT_NEAR(deviation(edges, expected), 0, 6 * error_of(edges, expected)) << (depth ? "depth" : "shadow");
    size_t tested = 0;
    for (const Pixels& block : depth ? truth().depth_blocks : truth().shadow_blocks) {
      if (block.size() < 4) continue;
      ++tested;
      const Measured a = mean_of(images, block);
      const Measured b = mean_of(truth().images, block);
      EXPECT_NEAR(deviation(a, b), 0, 7 * error_of(a, b) + 1e-6) << (depth ? "depth" : "shadow") << " block " << tested;
    }
    EXPECT_GE(tested, 3u);
  }
}

std::string mode_name(const ::testing::TestParamInfo<RestirSettings>& info) {
  const RestirSettings& s = info.param;
  return std::string(s.correction == ReuseCorrection::exact ? "exact" : "lagging") + "_cap_" + std::to_string(s.cap) +
         "_neighbours_" + std::to_string(s.neighbours) +
         (s.feedback == ReuseFeedback::spatial ? "_spatial" : "_temporal");
}

INSTANTIATE_TEST_SUITE_P(Unbiased, RestirEdges,
                         ::testing::Values(RestirSettings{.cap = 0, .neighbours = 3},
                                           RestirSettings{.cap = 20, .neighbours = 0},
                                           RestirSettings{.feedback = ReuseFeedback::temporal, .cap = 8},
                                           RestirSettings{.cap = 8},
                                           RestirSettings{.correction = ReuseCorrection::lagging, .cap = 8}),
                         mode_name);

/// The test above detects what the mode "basic" loses: a neighbour beyond the edge of a shadow counts as if it could
/// have found the lamp.
TEST(RestirEdgesBasic, AreDarkerAlongShadows) {
  const RestirSettings basic{.correction = ReuseCorrection::basic, .cap = 8};
  const Measured expected = mean_of(truth().images, truth().shadow_edges);
  const Measured edges = mean_of(images_of(basic, 64), truth().shadow_edges);
  EXPECT_LT(deviation(edges, expected), -4.5 * error_of(edges, expected));
  EXPECT_GT(deviation(edges, expected), -0.5 * expected.mean);
}

// --- Moving geometry ----------------------------------------------------------------------------------

constexpr int kLaggingSeeds = 32;
constexpr int kFrames = 19;

constexpr size_t kRows = 6;

/// A card above the camera, whose shadow covers all rows. The shadow moves to the right by one pixel each 1/24 s. At
/// frame f it covers the columns f − 6 to f + 5: its edges lie between pixels.
Scene passing_card() {
  Scene scene = testing::bare_plate();
  scene.cameras.front().half_height = static_cast<float>(kRows) / kSize;
  for (const float z : {-0.15f, 0.15f}) testing::add_point_light(scene, {0, 2, z});
  const Index card = testing::add_card(scene, {-0.5f, 1, 0}, {0.25f, 3});
  scene.animation.push_back({card,
                             AnimatedProperty::translation,
                             Interpolation::linear,
                             {0, 1},
                             {Vec4(-0.5f, 1, 0, 0), Vec4(0.5f, 1, 0, 0)}});
  return scene;
}

/// A card in view that rises. It covers the columns 6 to 17 of all rows.
Scene rising_card() {
  Scene scene = passing_card();
  const Index card = testing::add_card(scene, {0, 0.1f, 0}, {0.5f, 3}, 0.5f);
  scene.animation = {{card,
                      AnimatedProperty::translation,
                      Interpolation::linear,
                      {0, 1},
                      {Vec4(0, 0.1f, 0, 0), Vec4(0, 0.35f, 0, 0)}}};
  return scene;
}

/// Mean over rows and seeds of each column in the last frame, by runs in which the card moves or rests.
std::vector<Measured> columns_of(const Scene& scene, const RenderSettings& settings, bool moves) {
  RenderSettings single = settings;
  single.history = HistoryChoice::none;
  single.height = kRows;
  Session session(Scene(scene), single);
  std::vector<std::vector<double>> values(kSide);
  for (int seed = 1; seed <= kLaggingSeeds; ++seed) {
    session.set_time(0);
    session.restart(seed);
    for (int frame = 0; frame < kFrames; ++frame) {
      session.set_time(static_cast<float>(moves ? frame : kFrames - 1) / 24);
      session.render_frame();
    }
    const Image image = session.image();
    for (size_t x = 0; x < kSide; ++x) {
      double sum = 0;
      for (size_t y = 0; y < kRows; ++y) sum += static_cast<double>(value_at(image, y * kSide + x)) / kRows;
      values[x].push_back(sum);
    }
  }
  std::vector<Measured> columns;
  for (const std::vector<double>& column : values) columns.push_back(measured_over(column));
  return columns;
}

const std::vector<Measured>& lit_columns() {
  static const std::vector<Measured> columns = columns_of(passing_card(), settings_of(ReuseChoice::none), true);
  return columns;
}

RenderSettings with_correction(ReuseCorrection correction, int cap, int neighbours) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  settings.restir.correction = correction;
  settings.restir.cap = cap;
  settings.restir.neighbours = neighbours;
  return settings;
}

constexpr size_t kShadow = 12;  ///< first column in the shadow of the last frame

void expect_no_bias(const std::vector<Measured>& columns) {
  for (size_t x = 0; x < kSide; ++x) {
    const Measured& lit = lit_columns()[x];
    EXPECT_NEAR(deviation(columns[x], lit), 0, 7 * error_of(columns[x], lit) + 1e-3 * lit_columns()[0].mean) << x;
  }
}

TEST(RestirLagging, ScenesHaveAShadowBetweenPixels) {
  EXPECT_GT(lit_columns()[kShadow - 1].mean, 0.5 * lit_columns()[0].mean);
  EXPECT_LT(lit_columns()[kShadow].mean, 0.05 * lit_columns()[0].mean);
  EXPECT_LT(lit_columns()[kSide - 1].mean, 0.05 * lit_columns()[0].mean);
}

TEST(RestirLagging, IsUnbiasedWhereNothingMoves) {
  expect_no_bias(columns_of(passing_card(), with_correction(ReuseCorrection::lagging, 20, 3), false));
}

TEST(RestirLagging, ExactIsUnbiasedBehindAMovingShadow) {
  expect_no_bias(columns_of(passing_card(), with_correction(ReuseCorrection::exact, 20, 3), true));
}

/// A surface that a shadow left m frames ago was hidden from the lamps in its history of weight `cap`. Rays through
/// today's scene find it lit, so the history counts as a failed search, and only 1 − (cap / (cap + 1))^m of the light
/// has returned.
TEST(RestirLagging, LosesLightBehindAMovingShadow) {
  for (const int cap : {4, 12}) {
    const std::vector<Measured> columns =
        columns_of(passing_card(), with_correction(ReuseCorrection::lagging, cap, 0), true);
    double share = 0;
    double expected = 0;
    double error = 0;
    constexpr int kFirst = 2;
    constexpr int kLast = 5;
    for (int m = kFirst; m <= kLast; ++m) {
      const Measured& lit = lit_columns()[kShadow - static_cast<size_t>(m)];
      const Measured& column = columns[kShadow - static_cast<size_t>(m)];
      constexpr double kWeight = 1.0 / (kLast - kFirst + 1);
      share += column.mean / lit.mean * kWeight;
      error += error_of(column, lit) / lit.mean * kWeight;
      expected += (1 - std::pow(cap / (cap + 1.0), m)) * kWeight;
    }
    EXPECT_LT(error, 0.02) << "cap " << cap;
    EXPECT_NEAR(share, expected, 0.08) << "cap " << cap;
  }
}

/// Right behind the shadow, neighbours that have been lit for longer restore some of the light. In a model of averages,
/// a pixel has 7 % in place of 5 % in the first frame, and 14 % in place of 11 % in the second.
TEST(RestirLagging, LosesLessLightWithNeighbours) {
  const std::vector<Measured> columns =
      columns_of(passing_card(), with_correction(ReuseCorrection::lagging, 20, 3), true);
  const std::vector<Measured> alone =
      columns_of(passing_card(), with_correction(ReuseCorrection::lagging, 20, 0), true);
  for (size_t m = 1; m <= 2; ++m) {
    const Measured& lit = lit_columns()[kShadow - m];
    const Measured& column = columns[kShadow - m];
    EXPECT_LT(deviation(column, lit), -0.05 * lit.mean - 5 * error_of(column, lit)) << m;
    EXPECT_GT(deviation(column, alone[kShadow - m]), 5 * error_of(column, alone[kShadow - m])) << m;
  }
}

/// A face that moves along its normal hides the lamps from its former place. The history then counts in full beside
/// this frame's candidates: light becomes x + cap / (cap + 1) of itself in each frame, and approaches 1 + cap times x.
TEST(RestirLagging, IsTooBrightOnFacesThatAdvance) {
  const std::vector<Measured> lit = columns_of(rising_card(), settings_of(ReuseChoice::none), true);
  const std::vector<Measured> lagging =
      columns_of(rising_card(), with_correction(ReuseCorrection::lagging, 4, 0), true);
  const std::vector<Measured> exact = columns_of(rising_card(), with_correction(ReuseCorrection::exact, 4, 0), true);
  for (size_t x = 9; x < 15; ++x) {
    EXPECT_GT(lit[x].mean, 0) << x;
    EXPECT_GT(lagging[x].mean, 3 * lit[x].mean) << x;
    EXPECT_LT(lagging[x].mean, 5.2 * lit[x].mean) << x;
    EXPECT_NEAR(deviation(exact[x], lit[x]), 0, 7 * error_of(exact[x], lit[x]) + 1e-3 * lit[x].mean) << x;
  }
}

/// The mode differs from "exact" only where geometry moves.
TEST(RestirLagging, HasTheBitsOfExactWhereOnlyTheCameraMoves) {
  const auto image_with = [](ReuseCorrection correction) {
    Session session(testing::cards_under_lamps(), with_correction(correction, 8, 3));
    return after_a_move(session, 1, 4);
  };
  EXPECT_EQ(image_with(ReuseCorrection::lagging).pixels, image_with(ReuseCorrection::exact).pixels);
}

}  // namespace
}  // namespace relume
