// Tests that histories follow a skinned figure with the error of a rigid body of the same speed.
#include <gtest/gtest.h>

#include <array>
#include <ctime>
#include <iostream>

#include "determinism/same_bits.h"
#include "files/testing/temp_folder.h"
#include "metrics/temporal.h"
#include "render/presets.h"
#include "render/session.h"
#include "scene/testing/figure.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

using testing::FigureOptions;

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr int kFrames = 10;
constexpr int kFirstCompared = 6;
constexpr int kSeeds = 4;
constexpr float kFps = 24;

constexpr float kSwing_rad = 0.6f;  // per second

/// Joints at the foot, in the middle and at the top rotate by the same angle. The top moves by (2 m + 1 m) · 0.4 per
/// second.
Scene bending() { return in_a_room(testing::figure({.joints = 3, .swing_rad = kSwing_rad / 1.5f})); }

/// The same tube without bending, rotated about its foot. The top moves by 2 m · 0.6 per second.
Scene stiff() {
  Scene scene = testing::figure({.skinned = false});
  const float half = 0.5f * kSwing_rad;
  scene.animation.push_back({0,
                             AnimatedProperty::rotation,
                             Interpolation::linear,
                             {0, 1},
                             {Vec4(0, 0, 0, 1), Vec4(0, 0, std::sin(half), std::cos(half))},
                             0,
                             0});
  return in_a_room(std::move(scene));
}

/// The rigid tube's motion by a skin of one joint.
Scene stiff_by_skin() { return in_a_room(testing::figure({.joints = 1, .swing_rad = kSwing_rad})); }

float time_of(int frame) { return static_cast<float>(frame) / kFps; }

struct Technique {
  const char* name;
  void (*set)(RenderSettings& settings);
};

void PrintTo(const Technique& technique, std::ostream* out) { *out << technique.name; }

const Technique kTechniques[] = {
    {"reproject", [](RenderSettings& s) { s.history = HistoryChoice::reproject; }},
    {"svgf", [](RenderSettings& s) { s.denoise = DenoiseChoice::svgf; }},
    {"bmfr", [](RenderSettings& s) { s.denoise = DenoiseChoice::bmfr; }},
    {"psf",
     [](RenderSettings& s) {
       s.cache = CacheChoice::psf;
       s.history = HistoryChoice::reproject;
       s.reproject.method = ReprojectionMethod::backward;
     }},
    {"learning",
     [](RenderSettings& s) {
       s.history = HistoryChoice::reproject;
       s.lights = LightSelectionChoice::vlc;
       s.guide = GuideChoice::cdq;
     }},
};

RenderSettings base_settings(int seed) {
  RenderSettings s = small_settings(kWidth, kHeight);
  s.path.max_bounces = 3;
  s.auxiliary = true;
  s.seed = seed;
  return s;
}

struct Frame {
  Image image;
  SurfaceMotion surface;
  std::vector<uint32_t> instance;
};

template <typename T>
std::vector<T> copy_of(const Session& session, const BufferKey<T>& buffer) {
  const View<const T> view = buffer_table(session).read(buffer);
  return {view.begin(), view.end()};
}

std::vector<Frame> play(const Scene& scene, const RenderSettings& settings, int spp = 1) {
  Session session(scene, settings);
  std::vector<Frame> frames;
  for (int frame = 0; frame < kFrames; ++frame) {
    session.set_time(time_of(frame));
    for (int i = 0; i < (frame < kFirstCompared ? 1 : spp); ++i) session.render_frame();
    frames.push_back(
        {session.image(),
         {copy_of(session, kSurface.motion), copy_of(session, kSurface.depth), copy_of(session, kSurface.normal)},
         copy_of(session, kSurface.surface)});
  }
  return frames;
}

/// Errors at the figure's current and recent positions.
struct Errors {
  double mse = 0;
  double temporal = 0;
  double trail = 0;  ///< mean error at recent positions, relative to the mean of the reference
};

Errors errors_of(const Scene& scene, const std::vector<Frame>& reference, void (*set)(RenderSettings&)) {
  Errors errors;
  double difference = 0;
  double behind = 0;
  int pixels = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    RenderSettings settings = base_settings(seed);
    set(settings);
    const std::vector<Frame> frames = play(scene, settings);
    for (size_t f = kFirstCompared; f < kFrames; ++f) {
      const Image& truth = reference[f].image;
      for (size_t i = 0; i < truth.pixels.size(); ++i) {
        bool was = false;
        for (size_t back = 1; back <= 4; ++back) was = was || reference[f - back].instance[i] == 0;
        const bool is = reference[f].instance[i] == 0;
        if (!was && !is) continue;
        const Rgb d = frames[f].image.pixels[i] - truth.pixels[i];
        errors.mse += static_cast<double>(glm::dot(d, d));
        ++pixels;
        if (is) continue;
        difference += static_cast<double>(luminance(d));
        behind += static_cast<double>(luminance(truth.pixels[i]));
      }
      if (f == kFirstCompared) continue;
      errors.temporal += temporal_error(frames[f].image, truth, frames[f].surface, frames[f - 1].image,
                                        reference[f - 1].image, frames[f - 1].surface)
                             .rel_mse;
    }
  }
  errors.mse /= pixels;
  errors.temporal /= kSeeds * (kFrames - kFirstCompared - 1);
  errors.trail = difference / behind;
  return errors;
}

/// A moving figure, its reference, and the errors of plain path tracing.
struct MovingFigure {
  explicit MovingFigure(Scene figure)
      : scene(std::move(figure)),
        reference(play(scene, base_settings(1001), 128)),
        without(errors_of(scene, reference, [](RenderSettings&) {})) {}

  Errors relative_errors(const Technique& technique) const {
    const Errors with = errors_of(scene, reference, technique.set);
    std::cerr << technique.name << ": MSE " << with.mse << " of " << without.mse << ", temporal error " << with.temporal
              << " of " << without.temporal << ", trail " << with.trail << "\n";
    return {with.mse / without.mse, with.temporal / without.temporal, with.trail};
  }

  Scene scene;
  std::vector<Frame> reference;
  Errors without;
};

/// All techniques share the references, which take longer than their frames.
TEST(FigureInMotion, IsFollowedLikeARigidBody) {
  constexpr double kWorse = 1.2;
  const MovingFigure bent(bending());
  const MovingFigure rigid(stiff());
  for (const Technique& technique : kTechniques) {
    SCOPED_TRACE(technique.name);
    const Errors of_bent = bent.relative_errors(technique);
    const Errors of_rigid = rigid.relative_errors(technique);
    EXPECT_LT(of_bent.temporal, kWorse * of_rigid.temporal);
    EXPECT_LT(std::fabs(of_bent.trail), kWorse * std::fabs(of_rigid.trail) + 0.02);
  }
}

class Figure : public ::testing::TestWithParam<Technique> {};

TEST_P(Figure, MovesEquallyBySkinAndByNode) {
  RenderSettings settings = base_settings(1);
  GetParam().set(settings);
  const std::vector<Frame> by_node = play(stiff(), settings);
  const std::vector<Frame> by_skin = play(stiff_by_skin(), settings);
  // Both round differently, and a changed random decision gives another path.
  EXPECT_LT(mse(by_skin.back().image, by_node.back().image), 0.02 * mse(by_node.back().image, by_node[0].image));
  for (size_t i = 0; i < by_node.back().surface.motion.size(); ++i)
    EXPECT_LT(glm::length(by_node.back().surface.motion[i] - by_skin.back().surface.motion[i]), 0.02f) << i;
}

INSTANTIATE_TEST_SUITE_P(Techniques, Figure, ::testing::ValuesIn(kTechniques),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(FigureInMotion, HasTheSameBitsOnAnyNumberOfThreads) {
  const Scene scene = in_a_room(testing::figure({.morphs = true}));
  const auto bits = [&](int threads) {
    RenderSettings settings = base_settings(1);
    settings.threads = threads;
    settings.history = HistoryChoice::reproject;
    settings.lights = LightSelectionChoice::vlc;
    Session session(scene, settings);
    std::vector<uint32_t> all;
    for (int frame = 0; frame < 4; ++frame) {
      session.set_time(time_of(6 * frame));
      session.render_frame();
      const std::vector<uint32_t> more = bits_of(session);
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  };
  const std::vector<uint32_t> one = bits(1);
  for (const int threads : {2, 5}) EXPECT_EQ(bits(threads), one) << threads << " threads";
}

/// Processor time of all threads, in seconds.
double used_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST(FigureInMotion, ResumesFromCheckpoint) {
  const Scene scene = in_a_room(testing::figure({.morphs = true}));
  RenderSettings settings = base_settings(1);
  settings.history = HistoryChoice::reproject;
  const TempFolder folder;
  const auto play_on = [&](Session& session, int from, int to) {
    for (int frame = from; frame < to; ++frame) {
      session.set_time(time_of(4 * frame));
      session.render_frame();
    }
    return bits_of(session);
  };
  Session whole(scene, settings);
  play_on(whole, 0, 3);
  whole.save_checkpoint(folder / "a.ckpt");
  const std::vector<uint32_t> expected = play_on(whole, 3, 5);
  Session resumed(scene, settings);
  resumed.load_checkpoint(folder / "a.ckpt");
  EXPECT_EQ(play_on(resumed, 3, 5), expected);
}

TEST(FigureInMotion, CostsLittleOfAFrame) {
  if (is_host_replaced()) GTEST_SKIP() << "an emulated device has other times";
  // Like BrainStem, a sample model of Khronos: 59 parts, four influences per vertex.
  const Scene scene = in_a_room(
      testing::figure({.joints = 60, .rings = 20, .segments = 26, .swing_rad = 0.1f, .parts = 59, .influences = 4}));
  size_t vertices = 0;
  for (const Index mesh : scene.nodes[0].meshes) vertices += scene.meshes[static_cast<size_t>(mesh)].positions.size();
  ASSERT_GT(vertices, 30000u);
  // A quarter of the pixels of a small window, so that the bound below is four times as sharp: 4 % are measured.
  RenderSettings settings;
  settings.width = 320;
  settings.height = 180;
  settings.threads = 1;
  Session session(scene, settings);
  double moving_s = 0;
  double rendering_s = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const double start_s = used_s();
    session.set_time(time_of(frame));
    const double moved_s = used_s();
    session.render_frame();
    if (frame == 0) continue;  // includes the build
    moving_s += moved_s - start_s;
    rendering_s += used_s() - moved_s;
  }
  std::cerr << "a frame takes " << 200 * rendering_s << " ms, moving the figure " << 200 * moving_s << " ms\n";
  EXPECT_LT(moving_s, 0.15 * (moving_s + rendering_s));
}

}  // namespace
}  // namespace relume::support
