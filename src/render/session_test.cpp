#include "render/session.h"

#include <atomic>
#include <functional>
#include <limits>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

/// A white sphere in uniform light: every pixel is 1.
Session furnace(const RenderSettings& settings) { return Session(find_builtin_scene("furnace")->build(), settings); }

RenderSettings small_settings() {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.threads = 1;
  return settings;
}

double mean_luminance(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += static_cast<double>(luminance(pixel));
  return sum / static_cast<double>(image.pixels.size());
}

TEST(Session, RestartsIfAuxiliaryBuffersAreAddedOrRemoved) {
  RenderSettings settings = small_settings();
  settings.denoise = DenoiseChoice::svgf;
  Session session = furnace(settings);
  for (const bool auxiliary : {true, false}) {
    for (int i = 0; i < 8; ++i) session.render_frame();
    settings.auxiliary = auxiliary;
    ASSERT_TRUE(session.set_settings(settings));
    EXPECT_EQ(session.frames_since_change(), 0u);
    session.render_frame();
    EXPECT_EQ(session.frames_since_change(), 1u);
    EXPECT_EQ(session.kept_samples(), 1);
    EXPECT_NEAR(mean_luminance(session.image()), 1, 0.1) << "within the noise of one sample per pixel";
    if (auxiliary) {
      EXPECT_NEAR(session.aov("albedo").front().values[6 * 16 + 8], 1, 0.01) << "of the sphere, in the middle";
    }
  }
}

TEST(Session, KeepsTimesAndHooksWhereTheThreadsChange) {
  RenderSettings settings = small_settings();
  Session session = furnace(settings);
  session.render_frame();
  std::atomic<int> tiles = 0;
  on_tile(session, [&] { ++tiles; });
  const auto names = [&] {
    std::vector<std::string> list;
    for (const PassTime& pass : session.statistics().passes) list.push_back(pass.name);
    return list;
  };
  const std::vector<std::string> before = names();
  for (const bool scalar : {false, true}) {
    settings.scalar_kernels = scalar;
    settings.threads = scalar ? 1 : 2;
    ASSERT_TRUE(session.set_settings(settings));
    EXPECT_EQ(session.statistics().threads, settings.threads);
    EXPECT_EQ(names(), before);
  }
  session.render_frame();
  EXPECT_GT(tiles, 0);
}

TEST(Session, KeepsTheMemoryOfAnotherSizeOnly) {
  RenderSettings settings = small_settings();
  settings.denoise = DenoiseChoice::svgf;
  Session session = furnace(settings);
  const auto image = [&](int width) {
    settings.width = width;
    EXPECT_TRUE(session.set_settings(settings));
    session.restart(3);
    for (int i = 0; i < 3; ++i) session.render_frame();
    return session.image().pixels;
  };
  const std::vector<Rgb> first = image(16);
  const uint64_t bytes = session.statistics().buffer_bytes;
  session.restart(3);
  EXPECT_EQ(session.statistics().buffer_bytes, bytes);
  image(8);
  EXPECT_EQ(image(16), first);
  EXPECT_EQ(session.statistics().buffer_bytes, bytes) << "restart() frees spare memory";
  for (const int width : {8, 16, 8, 16}) {
    settings.width = width;
    EXPECT_TRUE(session.set_settings(settings));
    session.render_frame();
    EXPECT_LE(session.statistics().buffer_bytes, 2 * bytes);
  }
}

// For example when a pass runs out of memory.
TEST(Session, UndoesFramesEndedByExceptions) {
  RenderSettings settings = small_settings();
  settings.denoise = DenoiseChoice::svgf;
  settings.cache = CacheChoice::psf;
  Session session = furnace(settings);
  std::stop_source stop;  // never requested; its presence enables copies of the buffers
  for (const PassDeclaration& pass : pass_declarations(session)) {
    for (int i = 0; i < 3; ++i) session.render_frame(stop.get_token());
    const Image before = session.image();
    session.on_pass([&](const std::string& name) {
      if (name == pass.name) throw std::runtime_error("no memory");
    });
    EXPECT_THROW(session.render_frame(stop.get_token()), std::runtime_error) << pass.name;
    EXPECT_EQ(session.image().pixels, before.pixels) << pass.name;
    EXPECT_THROW(session.render_frame(), std::runtime_error) << pass.name;
    session.on_pass({});
    EXPECT_EQ(session.frames_since_change(), 0u) << pass.name;
    session.render_frame();
    EXPECT_EQ(session.kept_samples(), 1) << pass.name;
    EXPECT_NEAR(mean_luminance(session.image()), 1, 0.1) << pass.name;
  }
}

TEST(Session, AWindowHasTheBitsOfTheWholeImage) {
  RenderSettings settings = small_settings();
  settings.auxiliary = true;
  settings.lights = LightSelectionChoice::light_tree;
  const Scene scene = find_builtin_scene("cornell")->build();
  Session whole(scene, settings);
  settings.crop = {.x = 3, .y = 2, .width = 9, .height = 7};
  Session part(scene, settings);
  for (int i = 0; i < 4; ++i) whole.render_frame();
  for (int i = 0; i < 4; ++i) part.render_frame();
  EXPECT_EQ(part.image_samples(), 4);
  EXPECT_EQ(part.kept_samples(), 4);
  EXPECT_EQ(part.statistics().samples, 4u * 9 * 7);
  EXPECT_TRUE(part.estimated_error() > 0 && part.estimated_error() < 10) << part.estimated_error();
  const Image expected = whole.image();
  const Image image = part.image();
  const std::vector<float> depth = whole.aov("depth").front().values;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 3 && x < 12 && y >= 2 && y < 9;
      EXPECT_EQ(image.at(x, y), inside ? expected.at(x, y) : Rgb(0)) << x << ' ' << y;
      const auto i = static_cast<size_t>(y) * 16 + static_cast<size_t>(x);
      if (!inside) continue;
      EXPECT_EQ(part.aov("depth").front().values[i], depth[i]) << x << ' ' << y;
    }
  }
}

TEST(Session, RejectsInvalidWindows) {
  RenderSettings settings = small_settings();
  for (const PixelWindow& crop : {PixelWindow{8, 0, 9, 1}, PixelWindow{0, 12, 1, 1}, PixelWindow{-1, 0, 2, 2}}) {
    settings.crop = crop;
    EXPECT_THROW(furnace(settings), Error) << crop.x << ' ' << crop.y;
  }
}

TEST(Session, WindowsNeedPixelsThatDoNotDependOnEachOther) {
  RenderSettings settings = small_settings();
  settings.crop = {0, 0, 4, 4};
  EXPECT_NO_THROW(furnace(settings));
  const std::pair<const char*, std::function<void(RenderSettings&)>> conflicts[] = {
      {"light paths", [](RenderSettings& s) { s.estimator = EstimatorChoice::bdpt; }},
      {"light paths", [](RenderSettings& s) { s.estimator = EstimatorChoice::light; }},
      {"the visibility light cache", [](RenderSettings& s) { s.lights = LightSelectionChoice::vlc; }},
      {"light selection by screen tiles", [](RenderSettings& s) { s.lights = LightSelectionChoice::neeat; }},
      {"Markov chains of lights", [](RenderSettings& s) { s.lights = LightSelectionChoice::mcls; }},
      {"path guiding", [](RenderSettings& s) { s.guide = GuideChoice::cdq; }},
      {"path guiding", [](RenderSettings& s) { s.guide = GuideChoice::mcpg; }},
      {"a radiance cache", [](RenderSettings& s) { s.cache = CacheChoice::psf; }},
      {"adaptive sampling", [](RenderSettings& s) { s.allocation = AllocationChoice::adaptive; }},
      {"reprojection", [](RenderSettings& s) { s.history = HistoryChoice::reproject; }},
      {"a denoiser", [](RenderSettings& s) { s.denoise = DenoiseChoice::svgf; }},
      {"the firefly clamp", [](RenderSettings& s) { s.firefly.limit = 1; }},
  };
  for (const auto& [name, choose] : conflicts) {
    RenderSettings chosen = settings;
    choose(chosen);
    try {
      furnace(chosen);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find(fmt::format("--crop does not combine with {}", name)), 0u)
          << error.what();
    }
  }
}

TEST(Session, RejectedTimesHaveNoEffect) {
  Scene scene = testing::plate();
  testing::animate_scale(scene, 1, Vec3(1), Vec3(0));  // scale of the camera, which is degenerate at second 1
  RenderSettings settings = small_settings();
  Session session(std::move(scene), settings);
  for (int i = 0; i < 4; ++i) session.render_frame();
  EXPECT_THROW(session.set_time(1), Error);
  settings.time_s = 1;
  settings.denoise = DenoiseChoice::svgf;
  EXPECT_THROW(session.set_settings(settings), Error);
  EXPECT_EQ(render_settings(session).time_s, 0);
  EXPECT_EQ(render_settings(session).denoise, DenoiseChoice::none);
  EXPECT_EQ(session.frames_since_change(), 4u);
  session.render_frame();
  EXPECT_EQ(session.kept_samples(), 5);
}

TEST(Session, RejectsIndicesOutOfRange) {
  constexpr Index kLargest = std::numeric_limits<Index>::max();
  Session session(testing::plate(), small_settings());  // two nodes, a material, no light
  for (const Index index : {2, kNone, kLargest, -kLargest}) {
    EXPECT_EQ(testing::problem_of([&] { session.set_transform(index, {}); }),
              "plate: node " + std::to_string(index) + " does not exist; give an index from 0 to 1");
    EXPECT_EQ(testing::problem_of([&] {
                Session(testing::plate(), small_settings(), {0, index});
              }),
              "plate: node " + std::to_string(index) + " does not exist; give an index from 0 to 1");
  }
  EXPECT_EQ(testing::problem_of([&] { session.set_material(1, {}); }),
            "plate: material 1 does not exist; give an index from 0 to 0");
  EXPECT_NE(testing::problem_of([&] { session.set_material(kNone, {}); }), "");
  EXPECT_EQ(testing::problem_of([&] { session.set_light(0, {}); }),
            "plate: light 0 does not exist; the scene has no lights");
  session.render_frame();
  EXPECT_EQ(session.frames_since_change(), 1u);
}

TEST(Session, ContinuesItsSequenceIfOnlyTheTimeChanges) {
  Session moving_clock = furnace(small_settings());
  Session still = furnace(small_settings());
  for (int i = 0; i < 8; ++i) {
    moving_clock.set_time(static_cast<float>(i));
    moving_clock.render_frame();
    still.render_frame();
  }
  EXPECT_EQ(moving_clock.image().pixels, still.image().pixels);
}

TEST(Session, LayersStayUntilTheNextFrame) {
  RenderSettings settings = small_settings();
  settings.auxiliary = true;
  Session session = furnace(settings);
  for (int i = 0; i < 8; ++i) session.render_frame();
  const float before = session.aov("albedo").front().values[6 * 16 + 8];
  CameraPose camera = session.camera();
  camera.to_world[3].x += 1;
  session.set_camera(camera);
  EXPECT_EQ(session.aov("albedo").front().values[6 * 16 + 8], before);
}

TEST(Session, ImagesCountTheirOwnSamplesAndSeconds) {
  Session session = furnace(small_settings());
  for (int i = 0; i < 3; ++i) session.render_frame();
  const double before_s = session.statistics().render_s;
  EXPECT_EQ(session.image_samples(), 3);
  EXPECT_EQ(session.image_render_s(), before_s);
  session.begin_image();
  EXPECT_EQ(session.image_render_s(), 0);
  session.render_frame();
  EXPECT_EQ(session.image_samples(), 1);
  EXPECT_GT(session.image_render_s(), 0);
  EXPECT_EQ(session.image_render_s(), session.statistics().render_s - before_s);
  session.restart(1);
  EXPECT_EQ(session.image_render_s(), 0);
}

/// Each animation time has separate random numbers, unless an edit occurred.
TEST(Session, EditsThatChangeNothingChangeNoRandomNumbers) {
  const auto image_after = [](auto&& touch) {
    Session session(find_builtin_scene("turntable")->build(), small_settings());
    session.render_frame();
    touch(session);
    session.set_time(1);
    session.render_frame();
    return session.image().pixels;
  };
  const auto untouched = image_after([](Session&) {});
  EXPECT_EQ(image_after([](Session& s) { s.set_camera(s.camera()); }), untouched);
  const auto moved = [](Session& s) {
    CameraPose camera = s.camera();
    camera.to_world[3].x += 0.1f;
    s.set_camera(camera);
  };
  EXPECT_NE(image_after(moved), untouched);
  EXPECT_EQ(image_after([&](Session& s) {
              const CameraPose camera = s.camera();
              moved(s);
              s.set_camera(camera);
              s.restart(render_settings(s).seed);
            }),
            untouched);
}

TEST(PassTimes, AreDifferences) {
  const std::vector<PassTime> before{{"trace", 1, 0.5}, {"build", 3}};
  const std::vector<PassTime> now{{"build", 3}, {"trace", 1.5, 0.75}, {"bmfr-fit", 0.25, 0.125}};
  const std::vector<PassTime> since = pass_times_since(now, before);
  ASSERT_EQ(since.size(), 3u);
  EXPECT_EQ(since[0].name, "build");
  EXPECT_EQ(since[0].seconds, 0);
  EXPECT_EQ(since[1].name, "trace");
  EXPECT_EQ(since[1].seconds, 0.5);
  EXPECT_EQ(since[1].idle_s, 0.25);
  EXPECT_EQ(since[2].name, "bmfr-fit");  // had not run before
  EXPECT_EQ(since[2].seconds, 0.25);
}

/// A still view keeps its sample sequence, even if a history could follow motion. Its error is therefore that of
/// accumulation in every frame. `cornell-glass`: reflections and refractions, whose histories are kept apart.
TEST(Session, AStillViewIsReprojectedToTheBitsOfItsMean) {
  for (const char* const scene : {"cornell", "cornell-glass"}) {
    RenderSettings settings = small_settings();
    Session accumulated(find_builtin_scene(scene)->build(), settings);
    settings.history = HistoryChoice::reproject;
    for (const ReprojectionMethod method : {ReprojectionMethod::forward, ReprojectionMethod::backward}) {
      settings.reproject.method = method;
      Session reprojected(find_builtin_scene(scene)->build(), settings);
      accumulated.restart(0);
      for (int frame = 1; frame <= 32; ++frame) {
        accumulated.render_frame();
        reprojected.render_frame();
        EXPECT_EQ(accumulated.image().pixels, reprojected.image().pixels) << scene << ", frame " << frame;
      }
    }
  }
}

}  // namespace
}  // namespace relume
