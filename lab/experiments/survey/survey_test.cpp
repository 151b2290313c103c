#include "experiments/survey/survey.h"

#include <cmath>
#include <filesystem>
#include <new>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "experiments/survey/survey_file.h"
#include "files/atomic_file.h"
#include "relume/error.h"

namespace relume {
namespace {

/// Clock with one microsecond per ray, which makes times independent of the machine.
double rays_clock(const Session& session) { return 1e-6 * static_cast<double>(session.statistics().rays); }

/// A quick run with a folder of the test's own: tests run at the same time, and references of other builds differ.
struct QuickContext : ExperimentContext {
  QuickContext() {
    quick = true;
    cache_folder = std::filesystem::temp_directory_path() /
                   fmt::format("relume_survey_{}", testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(cache_folder);
  }
  ~QuickContext() {
    std::error_code failure;
    std::filesystem::remove_all(cache_folder, failure);
  }
  QuickContext(const QuickContext&) = delete;
  QuickContext& operator=(const QuickContext&) = delete;
};

const TechniqueValues& of(const SceneValues& scene, std::string_view name) {
  for (const TechniqueValues& values : scene.techniques) {
    if (values.technique.name == name) return values;
  }
  throw Error("no technique " + std::string(name));
}

/// Effort for stable values: the same budget for all, in rays.
SurveyEffort effort() {
  return {.budget_s = 0.04, .repetitions = 3, .runs = 6, .warm_up = 16, .frames = 8, .reference_spp = 128};
}

TEST(Survey, MeasuresAtEqualTime) {
  const QuickContext context;
  const SceneValues scene =
      measure_survey(context, survey_scene(context, "cornell"),
                     {{"path", ""}, {"long", "estimator:bdpt"}, {"clean", "denoise:svgf"}}, effort(), rays_clock);
  const StillValues& path = *of(scene, "path").still;
  const StillValues& bdpt = *of(scene, "long").still;
  const StillValues& clean = *of(scene, "clean").still;
  EXPECT_GT(path.frames, bdpt.frames);  // a frame of bdpt traces more rays
  EXPECT_LT(path.rays, bdpt.rays);
  // Half a frame by rounding, and as much because frames differ in rays.
  for (const StillValues* still : {&path, &bdpt}) EXPECT_NEAR(still->time_s, 0.04, 1e-3 * still->frame_ms);
  EXPECT_LT(clean.variance, path.variance);
  EXPECT_GT(clean.memory_bytes, path.memory_bytes);
  EXPECT_GT(path.variance, 0);
  EXPECT_LT(std::fabs(path.bias2.value), path.variance);
  EXPECT_FALSE(of(scene, "path").change);
  ASSERT_TRUE(of(scene, "clean").change);
}

TEST(Survey, FindsLightThatStays) {
  const QuickContext context;
  // Cells that never discard their history show the lamp's earlier place.
  const SceneValues scene =
      measure_survey(context, survey_scene(context, "turntable"),
                     {{"path", ""}, {"stale", "cache:psf,psf.change-detection:0"}}, effort(), rays_clock);
  const ChangeValues& stale = *of(scene, "stale").change;
  EXPECT_GT(stale.ghost.value, 2 * stale.ghost.error.value());
  EXPECT_FALSE(stale.image.pixels.empty());
}

TEST(Survey, SaysWhyATechniqueCannotRun) {
  const QuickContext context;
  const SceneValues scene =
      measure_survey(context, survey_scene(context, "cornell"), {{"path", ""}, {"both", "estimator:bdpt,cache:sharc"}},
                     SurveyEffort::of(context), rays_clock);
  EXPECT_TRUE(of(scene, "path").refused.empty());
  EXPECT_NE(of(scene, "both").refused.find("sharc"), std::string::npos);
  EXPECT_FALSE(of(scene, "both").still);
}

/// Measures three techniques, of which the second is "clean". `clock` and the context's progress may throw.
SceneValues with_failure(const QuickContext& context, const FrameClock& clock = rays_clock) {
  return measure_survey(context, survey_scene(context, "cornell"),
                        {{"path", ""}, {"clean", "denoise:svgf"}, {"last", "denoise:asvgf"}}, SurveyEffort::of(context),
                        clock);
}

void expect_complete(const SceneValues& scene, std::string_view name) {
  EXPECT_TRUE(of(scene, name).failed.empty()) << name;
  ASSERT_TRUE(of(scene, name).still) << name;
  EXPECT_GT(of(scene, name).still->rays, 0) << name;
}

TEST(Survey, ContinuesAfterALateFailure) {
  const QuickContext context;
  for (const int seed : {0, 2}) {  // of the trial run, and of the second still image
    const SceneValues scene = with_failure(context, [seed](const Session& session) {
      const RenderSettings& settings = render_settings(session);
      const bool begun = seed > 0 || session.statistics().frames > 1;  // an error of the first frame is a refusal
      if (settings.denoise == DenoiseChoice::svgf && settings.seed == seed && begun) throw Error("the device is gone");
      return rays_clock(session);
    });
    expect_complete(scene, "path");
    expect_complete(scene, "last");
    EXPECT_TRUE(of(scene, "last").change);
    EXPECT_TRUE(of(scene, "clean").refused.empty());
    EXPECT_EQ(of(scene, "clean").failed, "the device is gone");
    EXPECT_FALSE(of(scene, "clean").still);
    EXPECT_FALSE(of(scene, "clean").change);
  }
}

TEST(Survey, KeepsValuesFromBeforeAFailure) {
  QuickContext context;
  context.progress = [](const std::string& stage, double) {
    if (stage.ends_with("clean")) throw std::bad_alloc();
  };
  const SceneValues scene = with_failure(context);
  expect_complete(scene, "path");
  expect_complete(scene, "last");
  EXPECT_EQ(of(scene, "clean").failed, "out of memory");
  EXPECT_TRUE(of(scene, "clean").still);
  EXPECT_FALSE(of(scene, "clean").change);
  const std::filesystem::path folder = context.cache_folder / "out";
  SurveyFile(folder, "key").add(scene, 1, context, {}, SurveyEffort::of(context));
  const std::vector<std::byte> bytes = read_file(folder / kSurveyFile);
  const auto json = nlohmann::json::parse(reinterpret_cast<const char*>(bytes.data()),
                                          reinterpret_cast<const char*>(bytes.data()) + bytes.size());
  const auto& clean = json.at("scenes").at(0).at("techniques").at(1);
  EXPECT_EQ(clean.at("failed"), "out of memory");
  EXPECT_TRUE(clean.at("mse").is_number());
  EXPECT_FALSE(clean.contains("image_after"));
}

TEST(Survey, EndsOnAStopRequest) {
  QuickContext context;
  std::stop_source stop;
  context.stop = stop.get_token();
  context.progress = [&stop](const std::string& stage, double) {
    if (stage.ends_with("still images")) stop.request_stop();
  };
  EXPECT_THROW(with_failure(context), ExperimentStopped);
}

TEST(SurveyFile, ContinuesWithTheSameConditionsOnly) {
  const QuickContext context;
  const SurveyEffort quick = SurveyEffort::of(context);
  const std::vector<SurveyTechnique> techniques = {{"path", ""}, {"cache=sharc", "cache:sharc"}};
  const std::filesystem::path folder = context.cache_folder / "out";
  const std::string key = survey_key(context, techniques, quick);
  {
    SurveyFile file(folder, key);
    EXPECT_FALSE(file.has("cornell"));
    file.add(measure_survey(context, survey_scene(context, "cornell"), techniques, quick, rays_clock), 1, context, {},
             quick);
  }
  const std::vector<std::byte> bytes = read_file(folder / kSurveyFile);
  const auto json = nlohmann::json::parse(reinterpret_cast<const char*>(bytes.data()),
                                          reinterpret_cast<const char*>(bytes.data()) + bytes.size());
  const auto& list = json.at("scenes").at(0).at("techniques");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list.at(1).at("slots").at("cache"), "sharc");
  for (const char* image : {"image", "image_after"})
    EXPECT_TRUE(std::filesystem::exists(folder / list.at(1).at(image).get<std::string>())) << image;
  EXPECT_TRUE(SurveyFile(folder, key).has("cornell"));
  EXPECT_NE(survey_key(context, {techniques.front()}, quick), key);
  EXPECT_NE(survey_key(context, techniques, quick, 1), key);  // other times
  const SurveyFile other(folder, "another");
  EXPECT_FALSE(other.has("cornell"));
  EXPECT_EQ(other.dropped(), 1u);
}

TEST(SurveyFile, RefusesOtherFiles) {
  const QuickContext context;
  const std::filesystem::path folder = context.cache_folder / "foreign";
  std::filesystem::create_directories(folder);
  write_file(folder / kSurveyFile, "{}");
  EXPECT_THROW(SurveyFile(folder, "key"), Error);
}

TEST(SurveyFile, NamesImagesForEverySystem) {
  EXPECT_EQ(image_name("restir-di + vlc + svgf"), "restir-di-vlc-svgf");
  EXPECT_EQ(image_name("cache=apsf+apg"), "cache-apsf-apg");
  EXPECT_EQ(image_name("Sponza"), "sponza");
  // Equal names would overwrite each other's images.
  std::set<std::string> names;
  for (const SurveyTechnique& technique : survey_techniques())
    EXPECT_TRUE(names.insert(image_name(technique.name)).second) << technique.name;
}

}  // namespace
}  // namespace relume
