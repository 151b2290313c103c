#include "experiments/measure/moving_error.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "experiments/measure/moving_file.h"
#include "files/atomic_file.h"
#include "metrics/statistics.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

/// Clock with one microsecond per ray, which makes times independent of the machine.
double rays_clock(const Session& session) { return 1e-6 * static_cast<double>(session.statistics().rays); }

MovingErrors measure(const MovingOptions& options) {
  ExperimentContext context;
  context.quick = true;
  context.cache_folder = std::filesystem::temp_directory_path() / "relume_moving_error_test";
  ExperimentScene box = closed_box();
  MovingContender few{"one bounce more", box.settings};
  few.settings.path.max_bounces = 2;
  few.settings.path.russian_roulette = false;
  few.settings.history = HistoryChoice::none;
  MovingContender many = few;
  many.name = "many";
  many.settings.path.max_bounces = 6;
  MovingContender clean = few;
  clean.name = "denoised";
  clean.settings.denoise = DenoiseChoice::svgf;
  box.settings.path.max_bounces = 2;
  return measure_moving(context, box, {few, many, clean}, options);
}

TEST(MovingError, SlowContendersHaveFewerFrames) {
  const MovingErrors errors = measure({.frames = 9, .repetitions = 1, .reference_spp = 64, .clock = rays_clock});
  ASSERT_EQ(errors.contenders.size(), 3u);
  const MovingError& few = errors.contenders[0];
  const MovingError& many = errors.contenders[1];
  EXPECT_EQ(few.frames, 9);
  EXPECT_LT(many.frames, 9);
  EXPECT_NEAR(many.time_share, 1, 0.6 / many.frames);  // within half a frame
}

TEST(MovingError, EveryContenderEndsAtTheReferencesView) {
  const MovingErrors errors = measure(
      {.frames = 6, .repetitions = 1, .step_deg = 40, .step_m = 0.05f, .reference_spp = 256, .clock = rays_clock});
  const MovingError& clean = errors.contenders[2];
  // Blurred and noisy, but the same view: another view would have an error comparable to the image itself.
  EXPECT_LT(clean.flip, 0.35);
  EXPECT_LT(clean.mse, 0.5 * errors.contenders[0].mse);
  Image mirrored = errors.reference;
  for (int y = 0; y < mirrored.height; ++y) {
    for (int x = 0; x < mirrored.width; ++x) mirrored.at(x, y) = errors.reference.at(mirrored.width - 1 - x, y);
  }
  EXPECT_GT(compute_metrics(mirrored, errors.reference, {.flip = false}).mse, 2 * clean.mse);
}

TEST(MovingError, KeepsTheReferencesNoiseOut) {
  // With four samples per pixel, the reference's noise is a large part of a denoised image's difference.
  const MovingErrors rough = measure({.frames = 4, .repetitions = 1, .reference_spp = 4, .clock = rays_clock});
  const MovingErrors fine = measure({.frames = 4, .repetitions = 1, .reference_spp = 256, .clock = rays_clock});
  EXPECT_NEAR(rough.contenders[2].mse / fine.contenders[2].mse, 1, 0.3);
}

/// A lamp that fills the view, and emits 1 + t at the time t.
ExperimentScene brightening_lamp() {
  SceneBuilder builder("lamp");
  ParameterChannel channel;
  channel.part = AnimatedPart::material;
  channel.index = builder.add_material(emitter("lamp", Rgb(1)));
  channel.parameter = "emission";
  channel.times = {0, 8};
  channel.values = {Vec4(1, 1, 1, 0), Vec4(9, 9, 9, 0)};
  builder.add("lamp", quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), channel.index);
  builder.add_channel(std::move(channel));
  builder.add_camera({0, 0, 3}, {0, 0, 0}, 40);
  ExperimentScene result;
  result.name = "brightening lamp";
  result.scene = builder.take();
  result.settings.history = HistoryChoice::none;
  return at_rest(std::move(result));
}

TEST(MovingError, AnimatesTheSceneFromItsTimeOn) {
  ExperimentContext context;
  context.quick = true;
  context.cache_folder = std::filesystem::temp_directory_path() / "relume_moving_error_test";
  ExperimentScene lamp = brightening_lamp();
  lamp.settings.time_s = 0.5f;
  const MovingErrors errors = measure_moving(context, lamp, {{"first", lamp.settings}, {"second", lamp.settings}},
                                             {.frames = 3,
                                              .views = 2,
                                              .repetitions = 2,
                                              .step_deg = 0,
                                              .animation_step_s = 2,
                                              .reference_spp = 2,
                                              .clock = rays_clock});
  EXPECT_NEAR(errors.reference.at(16, 9).x, 5.5f, 1e-4f);  // two steps after 0.5 s
  for (const MovingError& e : errors.contenders) {
    EXPECT_NEAR(e.last.at(16, 9).x, 5.5f, 1e-4f) << e.name;
    EXPECT_LT(e.mse, 1e-8) << e.name;
  }
}

TEST(MovingError, ReferencesMayUseAnotherEstimator) {
  const MovingOptions options{.frames = 2, .views = 1, .repetitions = 1, .reference_spp = 256, .clock = rays_clock};
  MovingOptions both_ends = options;
  both_ends.reference = "estimator:bdpt";
  const Image a = measure(options).reference;
  const Image b = measure(both_ends).reference;
  EXPECT_NE(a.pixels, b.pixels);
  const auto mean_green = [](const Image& image) {
    double sum = 0;
    for (const Rgb& pixel : image.pixels) sum += static_cast<double>(pixel.y);
    return sum / static_cast<double>(image.pixels.size());
  };
  EXPECT_NEAR(mean_green(b) / mean_green(a), 1, 0.05);
}

TEST(MovingError, SomeHaveMoreRepetitions) {
  ExperimentContext context;
  context.quick = true;
  context.cache_folder = std::filesystem::temp_directory_path() / "relume_moving_error_test";
  const ExperimentScene box = closed_box();
  const MovingErrors errors = measure_moving(
      context, box, {{.name = "four", .settings = box.settings, .repetitions = 4}, {"two", box.settings}},
      {.frames = 2, .views = 2, .repetitions = 2, .reference_spp = 16, .clock = rays_clock});
  ASSERT_EQ(errors.contenders[0].mses.size(), 4u);
  ASSERT_EQ(errors.contenders[1].mses.size(), 2u);
  for (const MovingError& e : errors.contenders) EXPECT_NEAR(mean(e.mses), e.mse, 1e-12) << e.name;
  EXPECT_EQ(errors.contenders[0].mses[1], errors.contenders[1].mses[1]);
  EXPECT_NE(errors.contenders[0].mses[2], errors.contenders[0].mses[1]);
}

TEST(MovingError, ContinuesFromStoredMeasurements) {
  ExperimentContext context;
  context.quick = true;
  context.cache_folder = std::filesystem::temp_directory_path() / "relume_moving_error_test";
  context.parts_folder = context.cache_folder / "parts";
  std::filesystem::remove_all(context.parts_folder);
  const ExperimentScene box = closed_box();
  int timings = 0;
  MovingOptions options{.frames = 2, .repetitions = 2, .reference_spp = 16};
  options.clock = [&](const Session& session) {
    ++timings;
    return rays_clock(session);
  };
  const std::vector<MovingContender> contenders{{"box", box.settings}, {"again", box.settings}};
  const MovingErrors first = measure_moving(context, box, contenders, options);
  const int timings_of_first = timings;
  const MovingErrors again = measure_moving(context, box, contenders, options);
  EXPECT_EQ(timings, timings_of_first) << "nothing is rendered again";
  EXPECT_EQ(again.scene, first.scene);
  EXPECT_EQ(again.reference.pixels, first.reference.pixels);
  EXPECT_EQ(again.reference_mse, first.reference_mse);
  EXPECT_GT(again.reference_mse, 0);
  ASSERT_EQ(again.contenders.size(), first.contenders.size());
  for (size_t i = 0; i < first.contenders.size(); ++i) {
    const MovingError& a = first.contenders[i];
    const MovingError& b = again.contenders[i];
    EXPECT_EQ(b.name, a.name);
    EXPECT_EQ(b.frames, a.frames);
    EXPECT_EQ(b.time_share, a.time_share);
    EXPECT_EQ(b.mse, a.mse);
    EXPECT_EQ(b.flip, a.flip);
    EXPECT_EQ(b.mses, a.mses);
    EXPECT_EQ(b.flips, a.flips);
    EXPECT_EQ(b.last.pixels, a.last.pixels);
  }
  // Changed conditions require a new measurement.
  options.step_m = 0.1f;
  EXPECT_FALSE(load_moving(moving_file(context, box, contenders, options)));
  options.step_m = 0;
  options.animation_step_s = 0.5f;
  EXPECT_FALSE(load_moving(moving_file(context, box, contenders, options)));
  options.animation_step_s = 0;
  ExperimentScene other = box;
  other.settings.path.max_bounces += 1;
  EXPECT_FALSE(load_moving(moving_file(context, other, contenders, options))) << "references have other bounces";
  other = box;
  other.settings.time_s = 1;
  EXPECT_FALSE(load_moving(moving_file(context, other, contenders, options)));
  options.reference = "lights:light-tree";
  EXPECT_FALSE(load_moving(moving_file(context, box, contenders, options)));
  options.reference.clear();
  write_file(moving_file(context, box, contenders, options), "something else");
  EXPECT_FALSE(load_moving(moving_file(context, box, contenders, options)));
  std::filesystem::remove_all(context.parts_folder);
}

TEST(MovingError, RendersReferencesWithTheirOwnSettings) {
  const MovingOptions options{.frames = 2, .views = 1, .repetitions = 1, .reference_spp = 16, .clock = rays_clock};
  MovingOptions shallow = options;
  shallow.reference = "max-bounces:1";
  const auto brightness = [](const MovingErrors& errors) {
    double sum = 0;
    for (const Rgb& pixel : errors.reference.pixels) sum += luminance(pixel);
    return sum;
  };
  EXPECT_LT(brightness(measure(shallow)), 0.9 * brightness(measure(options)));
}

TEST(MovingError, IsTheSameTwice) {
  const MovingOptions options{.frames = 4, .views = 1, .repetitions = 2, .reference_spp = 16, .clock = rays_clock};
  const MovingErrors a = measure(options);
  const MovingErrors b = measure(options);
  for (size_t i = 0; i < a.contenders.size(); ++i) EXPECT_EQ(a.contenders[i].mse, b.contenders[i].mse) << i;
}

}  // namespace
}  // namespace relume
