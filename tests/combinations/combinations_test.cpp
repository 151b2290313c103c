// Each cell of the combination table: it renders the right mean, within its stated bias, or is refused with a sentence.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "combinations/cells.h"
#include "core/vec.h"
#include "render/build_pipeline.h"
#include "render/presets.h"
#include "render/session.h"
#include "render/settings.h"
#include "scene/builtin.h"
#include "support/measure.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr int kSize = 20;         // pixels
constexpr int kFramesBefore = 8;  // before the camera moves
constexpr int kFrames = 24;       // after it has
constexpr int kSeeds = 10;
constexpr int kMostSeeds = 320;
constexpr double kStandardErrors = 4.5;  // 300 cells: false alarms in 1 of 500 runs, were seeds not fixed

/// Of a cell's mean; larger ones would hide errors of several percent.
constexpr double kMostError = 0.01;

/// Luminance, red, green and blue.
constexpr int kMeans = 4;
using Means = std::array<double, kMeans>;

/// Means over pictures of several seeds, and their standard errors.
struct Mean {
  Means value = {};
  Means error = {};
};

/// The Cornell box, open at the front to a sky, with two lamps besides its own: some light of every kind to choose
/// from.
const Scene& test_scene() {
  static const Scene scene = [] {
    Scene s = find_builtin_scene("cornell")->build();
    s.environment.kind = EnvironmentKind::constant;
    s.environment.color = Rgb(0.3f, 0.4f, 0.5f);
    for (const float x : {-0.6f, 0.6f}) {
      Node lamp;
      lamp.transform.translation = Vec3(x, 1.5f, 0.3f);
      lamp.light = static_cast<Index>(s.lights.size());
      PunctualLight light;
      light.intensity = Rgb(0.3f, 0.25f, 0.2f);
      s.lights.push_back(light);
      s.nodes.push_back(lamp);
    }
    return s;
  }();
  return scene;
}

/// Means of the pictures of the last half of `frames` that follow a move of the camera sideways, so that
/// histories have something to carry over.
Means means_after_a_move(const RenderSettings& settings, int frames) {
  Session session(test_scene(), settings);
  for (int i = 0; i < kFramesBefore; ++i) session.render_frame();
  PlacedCamera camera = session.scene().camera();
  camera.to_world[3] += 0.1f * camera.to_world[0];
  session.set_camera(camera);
  const int first = frames / 2;
  Means means = {};
  for (int i = 0; i < frames; ++i) {
    session.render_frame();
    if (i < first) continue;
    const Rgb mean = estimate_of(session.image()).mean;
    const float values[kMeans] = {luminance(mean), mean.r, mean.g, mean.b};
    for (int m = 0; m < kMeans; ++m) means[m] += static_cast<double>(values[m]) / (frames - first);
  }
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  return means;
}

Mean mean_over_seeds(const RenderSettings& settings, int frames, int seeds) {
  Means sums = {};
  Means squares = {};
  for (int seed = 0; seed < seeds; ++seed) {
    RenderSettings s = settings;
    s.seed = static_cast<uint32_t>(1 + seed);
    const Means means = means_after_a_move(s, frames);
    for (int m = 0; m < kMeans; ++m) {
      sums[m] += means[m];
      squares[m] += means[m] * means[m];
    }
  }
  const double n = seeds;
  Mean mean;
  for (int m = 0; m < kMeans; ++m) {
    mean.value[m] = sums[m] / n;
    mean.error[m] = std::sqrt(std::max(0.0, squares[m] / n - mean.value[m] * mean.value[m]) / (n - 1));
  }
  return mean;
}

const Mean& reference(int max_bounces = RenderSettings{}.path.max_bounces) {
  static std::map<int, Mean> known;
  const auto [found, is_new] = known.try_emplace(max_bounces);
  if (is_new) {
    RenderSettings settings = small_settings(kSize, kSize);
    settings.path.max_bounces = max_bounces;
    found->second = mean_over_seeds(settings, 256, 32);
  }
  return found->second;
}

/// For pictures this small.
RenderSettings scaled(RenderSettings settings) {
  settings.static_lists.rays = 64;  // what they are prepared with would take longer than all else together
  settings.octree.collapse = 32;    // many regions for few pixels
  settings.octree.split = 64;
  settings.octree.scale = false;
  return settings;
}

RenderSettings settings_of(const Choice& a, const Choice& b) {
  return scaled(combine(small_settings(kSize, kSize), a, b));
}

using Deviations = std::array<Deviation, kMeans>;

/// Renders with as many seeds as the noise asks for: until the luminance is known to `most_error`.
Deviations deviations_of(const RenderSettings& settings, double most_error = kMostError) {
  const Mean& truth = reference(settings.path.max_bounces);
  Deviations deviations;
  for (int seeds = kSeeds; seeds <= kMostSeeds; seeds *= 2) {
    const Mean mean = mean_over_seeds(settings, kFrames, seeds);
    for (int m = 0; m < kMeans; ++m) {
      deviations[m] = {mean.value[m] / truth.value[m] - 1, std::hypot(mean.error[m], truth.error[m]) / truth.value[m]};
    }
    if (deviations[0].error <= most_error) break;
  }
  return deviations;
}

/// What is wrong with the means, in words; empty if they are right within a bias.
std::string problem_of(const Deviations& deviations, double bias, double most_error = kMostError) {
  if (deviations[0].error > most_error)
    return fmt::format("a standard error of {:.2f} % says too little", 100 * deviations[0].error);
  for (const Deviation& d : deviations) {
    if (std::fabs(d.value) <= bias + kStandardErrors * d.error) continue;
    return fmt::format("{:+.2f} % with a standard error of {:.2f} %", 100 * d.value, 100 * d.error);
  }
  return {};
}

/// The same of a cell, which may also be refused with a remedy.
std::string problem_of(const Choice& a, const Choice& b, double most_error) {
  const std::string reason = refusal(settings_of(a, b));
  if (reason.empty()) return problem_of(deviations_of(settings_of(a, b), most_error), bias_of(a, b), most_error);
  return reason.find("use ") == std::string::npos ? "does not say what would work: " + reason : "";
}

/// A choice against all choices of the slots after its own.
class Combinations : public ::testing::TestWithParam<Choice> {};

void check_row(const Choice& choice, double most_error) {
  bool after = false;
  for (const Choice& other : all_choices()) {
    after = after || other == choice;
    if (!after || other.slot == choice.slot) continue;
    EXPECT_EQ(problem_of(choice, other, most_error), "")
        << choice.slot << "=" << choice.value << " with " << other.slot << "=" << other.value;
  }
}

TEST_P(Combinations, RightInTheMeanOrRefused) { check_row(GetParam(), kMostError); }

/// The same, measured so well that an error of two percent would show.
class SlowCombinations : public Combinations {};
TEST_P(SlowCombinations, RightInTheMeanOrRefused) { check_row(GetParam(), 0.004); }

std::string choice_name(const ::testing::TestParamInfo<Choice>& info) {
  return test_name(info.param.slot + "_" + info.param.value);
}
INSTANTIATE_TEST_SUITE_P(All, Combinations, ::testing::ValuesIn(all_choices()), choice_name);
INSTANTIATE_TEST_SUITE_P(All, SlowCombinations, ::testing::ValuesIn(all_choices()), choice_name);

TEST(Presets, ShowTheRightMean) {
  for (const Preset& preset : presets()) {
    Settings settings = resolve({.preset = std::string(preset.name)});
    settings.render.width = settings.render.height = kSize;
    settings.render.threads = 1;
    EXPECT_EQ(problem_of(deviations_of(scaled(settings.render)), bias_of(settings.render)), "") << preset.name;
  }
}

TEST(CombinationTable, SlotsWithABiasedChoiceDeclareIt) {
  RenderSettings settings;
  const SettingList slots = describe_slots(settings);
  for (const Choice& choice : all_choices()) {
    EXPECT_TRUE(choice.bias == 0 || require_setting(slots, choice.slot, "").traits.biases) << choice.slot;
  }
}

/// The page from what rendering every cell showed.
std::string measured_page() {
  std::map<std::pair<std::string, std::string>, Deviations> cells;
  const auto measured = [&](const Choice& a, const Choice& b) {
    const auto key = std::pair(a.slot + a.value, b.slot + b.value);
    if (!cells.contains(key)) cells[key] = deviations_of(settings_of(a, b));
    return cells[key];
  };
  const auto holds = [&](const Choice& a, const Choice& b) {
    return problem_of(measured(a, b), bias_of(a, b)).empty();
  };
  return combination_table(holds) +
         deviation_table([&](const Choice& a, const Choice& b) { return measured(a, b)[0]; });
}

/// Compared without what was measured, as each cell has a test of its own.
TEST(CombinationTable, IsTheOneInTheDocumentation) {
  const char* file = RELUME_SOURCE_DIR "/docs/combinations.md";
  if (std::getenv("RELUME_WRITE")) std::ofstream(file) << measured_page();
  std::ostringstream stored;
  stored << std::ifstream(file).rdbuf();
  const std::string text = stored.str();
  EXPECT_EQ(text.substr(0, text.find(kDeviationsTitle)),
            combination_table([](const Choice&, const Choice&) { return true; }))
      << "run it with RELUME_WRITE=1";
}

}  // namespace
}  // namespace relume::support
