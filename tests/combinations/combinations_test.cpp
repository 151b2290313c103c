// Each cell of the combination table: it renders the right mean, within its stated bias, or is refused with a sentence.
#include <gtest/gtest.h>

#include <cctype>
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
#include "render/session.h"
#include "scene/builtin.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kSize = 20;         // pixels
constexpr int kFramesBefore = 8;  // before the camera moves
constexpr int kFrames = 24;       // after it has
constexpr int kSeeds = 10;
constexpr int kMostSeeds = 80;
constexpr double kStandardErrors = 4.5;  // 300 cells: false alarms in 1 of 500 runs, were seeds not fixed

/// Of a cell's mean; larger ones would hide errors of several percent.
constexpr double kMostError = 0.01;

/// Mean luminance over pictures of several seeds, and its standard error.
struct Mean {
  double value = 0;
  double error = 0;
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

/// Mean luminance of the pictures of the last half of `frames` that follow a move of the camera sideways, so that
/// histories have something to carry over.
double mean_after_a_move(const RenderSettings& settings, int frames) {
  Session session(test_scene(), settings);
  for (int i = 0; i < kFramesBefore; ++i) session.render_frame();
  PlacedCamera camera = session.scene().camera();
  camera.to_world[3] += 0.1f * camera.to_world[0];
  session.set_camera(camera);
  const int first = frames / 2;
  double sum = 0;
  for (int i = 0; i < frames; ++i) {
    session.render_frame();
    if (i >= first) sum += static_cast<double>(luminance(estimate_of(session.image()).mean));
  }
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  return sum / (frames - first);
}

Mean mean_over_seeds(const RenderSettings& settings, int frames, int seeds) {
  double sum = 0;
  double squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    RenderSettings s = settings;
    s.seed = static_cast<uint32_t>(1 + seed);
    const double mean = mean_after_a_move(s, frames);
    sum += mean;
    squares += mean * mean;
  }
  const double n = seeds;
  return {sum / n, std::sqrt(std::max(0.0, squares / n - (sum / n) * (sum / n)) / (n - 1))};
}

const Mean& reference() {
  static const Mean mean = mean_over_seeds(small_settings(kSize, kSize), 256, 8);
  return mean;
}

RenderSettings settings_of(const Choice& a, const Choice& b) {
  RenderSettings settings = combine(small_settings(kSize, kSize), a, b);
  settings.static_lists.rays = 64;  // what they are prepared with would take longer than all else together
  settings.octree = {.collapse = 32, .split = 64, .scale = false};  // many regions for few pixels
  return settings;
}

/// Renders a cell with as many seeds as its noise asks for.
Deviation measure_cell(const Choice& a, const Choice& b) {
  Deviation deviation;
  for (int seeds = kSeeds; seeds <= kMostSeeds; seeds *= 2) {
    const Mean mean = mean_over_seeds(settings_of(a, b), kFrames, seeds);
    deviation.value = mean.value / reference().value - 1;
    deviation.error = std::hypot(mean.error, reference().error) / reference().value;
    if (deviation.error <= kMostError) break;
  }
  return deviation;
}

/// What is wrong with a mean, in words; empty if it is right within the biases that were stated.
std::string problem_of(const Choice& a, const Choice& b, const Deviation& deviation) {
  if (deviation.error > kMostError)
    return fmt::format("a standard error of {:.2f} % says too little", 100 * deviation.error);
  if (std::fabs(deviation.value) <= bias_of(a, b) + kStandardErrors * deviation.error) return {};
  return fmt::format("{:+.2f} % with a standard error of {:.2f} %", 100 * deviation.value, 100 * deviation.error);
}

/// The same of a cell, which may also be refused with a remedy.
std::string problem_of(const Choice& a, const Choice& b) {
  const std::string reason = refusal(settings_of(a, b));
  if (reason.empty()) return problem_of(a, b, measure_cell(a, b));
  return reason.find("use ") == std::string::npos ? "does not say what would work: " + reason : "";
}

/// A choice against all choices of the slots after its own.
class Combinations : public ::testing::TestWithParam<Choice> {};

TEST_P(Combinations, RightInTheMeanOrRefused) {
  bool after = false;
  for (const Choice& other : all_choices()) {
    after = after || other == GetParam();
    if (!after || other.slot == GetParam().slot) continue;
    EXPECT_EQ(problem_of(GetParam(), other), "")
        << GetParam().slot << "=" << GetParam().value << " with " << other.slot << "=" << other.value;
  }
}

std::string choice_name(const ::testing::TestParamInfo<Choice>& info) {
  std::string name = info.param.slot + "_" + info.param.value;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, Combinations, ::testing::ValuesIn(all_choices()), choice_name);

TEST(CombinationTable, SlotsWithABiasedChoiceDeclareIt) {
  RenderSettings settings;
  const SettingList slots = describe_slots(settings);
  for (const Choice& choice : all_choices()) {
    EXPECT_TRUE(choice.bias == 0 || require_setting(slots, choice.slot, "").traits.biases) << choice.slot;
  }
}

/// The page from what rendering every cell showed.
std::string measured_page() {
  std::map<std::pair<std::string, std::string>, Deviation> cells;
  const auto measured = [&](const Choice& a, const Choice& b) {
    const auto key = std::pair(a.slot + a.value, b.slot + b.value);
    if (!cells.contains(key)) cells[key] = measure_cell(a, b);
    return cells[key];
  };
  return combination_table([&](const Choice& a, const Choice& b) { return problem_of(a, b, measured(a, b)).empty(); }) +
         deviation_table(measured);
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
