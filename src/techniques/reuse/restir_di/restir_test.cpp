#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "frame/pipeline.h"
#include "framebuffer/pixel_moments.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "scene/testing/media.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_di/spatial_reuse.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "testing/chi2.h"

namespace relume {
namespace {

using testing::deviation;
using testing::error_of;
using testing::FewerPaths;
using testing::mean_over_seeds;
using testing::Measured;
using testing::measured_over;

constexpr int kSize = 24;
constexpr size_t kPixels = size_t{kSize} * kSize;
constexpr size_t kBlocks = 4;  // per edge of the image

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.path.max_bounces = 1;
  return settings;
}

/// Mean luminance of the image and of its blocks.
struct BlockMeans {
  double image = 0;
  std::vector<double> blocks = std::vector<double>(kBlocks * kBlocks);
};

BlockMeans means_of(const Image& image) {
  BlockMeans means;
  for (size_t p = 0; p < kPixels; ++p) {
    const double y = static_cast<double>(luminance(image.pixels[p]));
    const size_t block = p / kSize * kBlocks / kSize * kBlocks + p % kSize * kBlocks / kSize;
    means.image += y / kPixels;
    means.blocks[block] += y * kBlocks * kBlocks / kPixels;
  }
  return means;
}

/// Renders with a camera that moves in each of the first frames, then rests. Returns the mean of the last `kept`.
BlockMeans after_a_move(Session& session, int seed, int moving, int kept) {
  session.set_camera(std::nullopt);
  session.restart(seed);
  CameraPose camera = session.camera();
  for (int i = 0; i < moving; ++i) {
    camera.to_world[3] += 0.05f * camera.to_world[0];
    session.set_camera(camera);
    session.render_frame();
  }
  for (int i = 0; i < kept; ++i) session.render_frame();
  return means_of(session.image());
}

struct Comparison {
  Measured image;
  std::vector<Measured> blocks = std::vector<Measured>(kBlocks * kBlocks);
};

/// Mean over seeds and its standard error. Frames and pixels depend on each other, seeds do not.
Comparison over_seeds(const Scene& scene, const RenderSettings& settings, int seeds, int moving, int kept) {
  Session session(Scene(scene), settings);
  std::vector<BlockMeans> all;
  for (int seed = 1; seed <= seeds; ++seed) all.push_back(after_a_move(session, seed, moving, kept));
  const auto measured = [&](const auto& value) {
    std::vector<double> values;
    for (const BlockMeans& means : all) values.push_back(value(means));
    return measured_over(values);
  };
  Comparison result;
  result.image = measured([](const BlockMeans& means) { return means.image; });
  for (size_t b = 0; b < result.blocks.size(); ++b)
    result.blocks[b] = measured([b](const BlockMeans& means) { return means.blocks[b]; });
  return result;
}

Scene cornell() { return find_builtin_scene("cornell")->build(); }

constexpr int kSeeds = 20;
constexpr int kMoving = 6;
constexpr int kKept = 8;

const Comparison& reference() {
  static const Comparison truth = over_seeds(cornell(), settings_of(ReuseChoice::none), 12, kMoving, 96);
  return truth;
}

/// `bias`: of the image, relative.
void expect_mean_of_paths(const Comparison& measured, double bias = 0) {
  const double image_error = error_of(measured.image, reference().image);
  EXPECT_LT(image_error, 0.02 * reference().image.mean);
  // With few degrees of freedom, standard errors are uncertain.
  EXPECT_NEAR(deviation(measured.image, reference().image), 0, bias * reference().image.mean + 6 * image_error);
  for (size_t b = 0; b < measured.blocks.size() && !(bias > 0); ++b) {
    const double error = error_of(measured.blocks[b], reference().blocks[b]) + 1e-6;
    EXPECT_NEAR(deviation(measured.blocks[b], reference().blocks[b]), 0, 7 * error) << "block " << b;
  }
}

class RestirMode : public ::testing::TestWithParam<RestirSettings> {};

TEST_P(RestirMode, HasTheMeanOfPathTracingInImageAndBlocks) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  settings.restir = GetParam();
  settings.restir.radius = 6;
  expect_mean_of_paths(over_seeds(cornell(), settings, kSeeds, kMoving, kKept));
}

std::string mode_name(const ::testing::TestParamInfo<RestirSettings>& info) {
  const RestirSettings& s = info.param;
  return "cap_" + std::to_string(s.cap) + "_neighbours_" + std::to_string(s.neighbours) +
         (s.feedback == ReuseFeedback::spatial ? "_spatial" : "_temporal");
}

INSTANTIATE_TEST_SUITE_P(Exact, RestirMode,
                         ::testing::Values(RestirSettings{.cap = 0, .neighbours = 0},
                                           RestirSettings{.cap = 0, .neighbours = 3},
                                           RestirSettings{.cap = 20, .neighbours = 0},
                                           RestirSettings{.feedback = ReuseFeedback::temporal, .cap = 8},
                                           RestirSettings{.cap = 8}),
                         mode_name);

/// Pixels without a path pass their reservoirs to neighbours and later frames.
class RestirFewerPaths : public ::testing::TestWithParam<FewerPaths> {};

TEST_P(RestirFewerPaths, HasTheMeanOfPathTracingInImageAndBlocks) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  settings.restir.cap = 8;
  settings.restir.radius = 6;
  testing::apply(GetParam(), settings);
  expect_mean_of_paths(over_seeds(cornell(), settings, 48, kMoving, 24), testing::bias_of(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Exact, RestirFewerPaths,
                         ::testing::Values(FewerPaths::upscaled, FewerPaths::adaptive,
                                           FewerPaths::adaptive_after_pilot),
                         [](const auto& test) { return testing::name_of(test.param); });

/// Mean of the lower half of the image. The error is an upper bound: that of blocks that depend on each other.
Measured lower_half(const Comparison& comparison) {
  Measured half;
  constexpr size_t kBegin = kBlocks * kBlocks / 2;
  for (size_t b = kBegin; b < kBlocks * kBlocks; ++b) {
    half.mean += comparison.blocks[b].mean / kBegin;
    half.error += comparison.blocks[b].error / kBegin;
  }
  return half;
}

/// The mode "basic" gives no weight to hidden candidates, but its weights ignore that these were hidden. Shadows of the
/// boxes lie in the lower half of the image, the lamp and its noise in the upper.
TEST(RestirBasic, LosesLightInShadows) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  settings.restir.correction = ReuseCorrection::basic;
  settings.restir.radius = 6;
  const Measured basic = lower_half(over_seeds(cornell(), settings, 4 * kSeeds, kMoving, kKept));
  const Measured truth = lower_half(reference());
  EXPECT_LT(deviation(basic, truth), -4.5 * error_of(basic, truth));
  EXPECT_GT(deviation(basic, truth), -0.4 * truth.mean);
}

/// Lights that move without geometry keep their reservoirs in the mode "exact": targets of the previous frame use its
/// lights.
TEST(RestirMovingLight, HasTheMeanOfPathTracing) {
  const Scene scene = [] {
    Scene box = cornell();
    PunctualLight lamp;
    lamp.type = PunctualType::point;
    lamp.intensity = Rgb(20);
    box.lights.push_back(lamp);
    Node node;
    node.name = "moving lamp";
    node.light = static_cast<Index>(box.lights.size()) - 1;
    node.transform.translation = Vec3(-1.5f, 3, 1);
    box.add_node(node);
    const auto moved = static_cast<Index>(box.nodes.size()) - 1;
    box.animation.push_back({moved,
                             AnimatedProperty::translation,
                             Interpolation::linear,
                             {0, 1},
                             {Vec4(-1.5f, 3, 1, 0), Vec4(1.5f, 3, 1, 0)}});
    return box;
  }();
  const auto measure = [&](ReuseChoice reuse, int seeds) {
    RenderSettings settings = settings_of(reuse);
    settings.history = HistoryChoice::none;
    settings.restir.radius = 6;
    Session session(Scene(scene), settings);
    return mean_over_seeds(seeds, [&](int seed) {
      session.set_time(0);
      session.restart(seed);
      for (int frame = 0; frame < 10; ++frame) {
        session.set_time(0.08f * static_cast<float>(frame));
        session.render_frame();
      }
      return means_of(session.image()).image;
    });
  };
  const Measured truth = measure(ReuseChoice::none, 80);
  const Measured reused = measure(ReuseChoice::restir_di, 40);
  EXPECT_LT(error_of(reused, truth), 0.02 * truth.mean);
  EXPECT_NEAR(reused.mean, truth.mean, 4.5 * error_of(reused, truth));
}

/// A map that is bright on one half of the horizon, and black on the other.
Environment half_sky(bool left) {
  Environment sky;
  sky.kind = EnvironmentKind::map;
  sky.width = 8;
  sky.height = 4;
  for (int i = 0; i < sky.width * sky.height; ++i)
    sky.map.push_back(Rgb((i % sky.width < sky.width / 2) == left ? 1.0f : 0.0f));
  return sky;
}

/// What the environment was in the previous frame is not known, so a replaced one ends all reservoirs.
TEST(RestirEnvironment, MayBeReplacedAndRemoved) {
  const auto measure = [](ReuseChoice reuse, int seeds) {
    RenderSettings settings = settings_of(reuse);
    settings.history = HistoryChoice::none;
    settings.restir.radius = 6;
    Session session(testing::plate(testing::matte(Rgb(0.5f)), 3, 1), settings);
    return mean_over_seeds(seeds, [&](int seed) {
      session.set_environment(half_sky(true));
      session.restart(seed);
      for (int frame = 0; frame < 5; ++frame) session.render_frame();
      session.set_environment(half_sky(false));
      session.render_frame();
      const double mean = means_of(session.image()).image;
      session.set_environment({});
      session.render_frame();
      EXPECT_EQ(means_of(session.image()).image, 0);
      return mean;
    });
  };
  const Measured truth = measure(ReuseChoice::none, 40);
  const Measured reused = measure(ReuseChoice::restir_di, 40);
  EXPECT_LT(error_of(reused, truth), 0.02 * truth.mean);
  EXPECT_NEAR(reused.mean, truth.mean, 4.5 * error_of(reused, truth));
}

/// Variance between seeds, summed over pixels. Values are clamped, so that single bright samples do not decide.
TEST(RestirNoise, FallsByReuse) {
  constexpr double kBrightest = 5;
  const Scene scene = find_builtin_scene("warehouse")->build();
  const auto noise = [&](ReuseChoice reuse) {
    RenderSettings settings = settings_of(reuse);
    settings.width = 48;
    settings.height = 27;
    settings.history = HistoryChoice::none;
    Session session(Scene(scene), settings);
    std::vector<double> sum(48 * 27);
    std::vector<double> squares(sum.size());
    constexpr int kRuns = 8;
    for (int seed = 1; seed <= kRuns; ++seed) {
      session.restart(seed);
      for (int i = 0; i < 8; ++i) session.render_frame();
      const Image image = session.image();
      for (size_t p = 0; p < sum.size(); ++p) {
        const double y = std::min(static_cast<double>(luminance(image.pixels[p])), kBrightest);
        sum[p] += y / kRuns;
        squares[p] += y * y / kRuns;
      }
    }
    double variance = 0;
    for (size_t p = 0; p < sum.size(); ++p) variance += squares[p] - sum[p] * sum[p];
    return variance;
  };
  EXPECT_LT(noise(ReuseChoice::restir_di), 0.4 * noise(ReuseChoice::ris));
}

TEST(RestirFrames, AreNotIndependent) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 41u);
  EXPECT_FALSE(build_passes(settings, host_memory()).pipeline.keeps_to_pixels());
  settings.restir.cap = 0;
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 1u);
  settings.reuse = ReuseChoice::ris;
  settings.restir.cap = 20;
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 1u);
}

TEST(RestirFrames, RaiseTheEstimatedError) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di);
  settings.restir.cap = 2;  // five frames count as one
  Session session(cornell(), settings);
  for (int i = 0; i < 4; ++i) session.render_frame();
  EXPECT_TRUE(std::isinf(session.estimated_error()));
  for (int i = 0; i < 36; ++i) session.render_frame();
  const double estimated = session.estimated_error();
  const std::vector<float> variance = session.aov("variance").front().values;
  double sum = 0;
  for (const float v : variance) sum += static_cast<double>(v) / kPixels;
  EXPECT_NEAR(std::sqrt(sum) / means_of(session.image()).image, estimated, 1e-3 * estimated);
  const auto m2 = buffer_table(session).read(kMoments.m2);
  double plain = 0;
  for (uint32_t i = 0; i < m2.size; ++i) plain += static_cast<double>(m2[i]) / (40.0 * 39.0) / kPixels;
  EXPECT_NEAR(sum / plain, correlation_factor(40, 5), 1e-3);
}

TEST(NeighbourOffsets, FillTheDisk) {
  constexpr uint32_t kRings = 4;
  constexpr uint32_t kSectors = 8;
  std::vector<uint64_t> counts(size_t{kRings} * kSectors);
  ChoiceNumbers numbers(1, 2, 3, 4);
  constexpr uint32_t kPixelsTested = 4000;
  for (uint32_t pixel = 0; pixel < kPixelsTested; ++pixel) {
    const float x = numbers.next();
    const Vec2 shift(x, numbers.next());
    const Vec2 offset = neighbour_offset(pixel % 8, shift);
    const float square = glm::dot(offset, offset);
    ASSERT_LE(square, 1.00001f);
    const double turn = std::atan2(static_cast<double>(offset.y), static_cast<double>(offset.x)) / (2 * M_PI) + 0.5;
    const auto ring = std::min(static_cast<size_t>(square * kRings), size_t{kRings} - 1);
    const auto sector = std::min(static_cast<size_t>(turn * kSectors), size_t{kSectors} - 1);
    ++counts[ring * kSectors + sector];
  }
  const std::vector<double> expected(counts.size(), static_cast<double>(kPixelsTested) / (kRings * kSectors));
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
}

}  // namespace
}  // namespace relume
