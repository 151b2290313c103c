// Tests each cell of the combination table: it renders the expected mean within its stated bias, or is rejected with an
// explanation.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "combinations/cells.h"
#include "core/array.h"
#include "core/vec.h"
#include "render/build_pipeline.h"
#include "render/presets.h"
#include "render/session.h"
#include "render/settings.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/scenes.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr int kSize = 20;         // in pixels
constexpr int kFramesBefore = 8;  // before the camera moves
constexpr int kFrames = 24;       // after the camera moved
constexpr int kSeeds = 10;
constexpr int kMostSeeds = 2000;
constexpr double kStandardErrors = 4.5;  // 151 cells: with random seeds, one false alarm in 240 runs

/// Largest standard errors of a cell's mean: higher ones would hide errors of several percent.
constexpr double kMostError = 0.005;
constexpr double kMostSlowError = 0.0025;

/// Luminance, red, green and blue.
constexpr int kMeans = 4;
using Means = std::array<double, kMeans>;

/// Means over images of several seeds, and their standard errors.
struct Mean {
  Means value = {};
  Means error = {};
};

/// Means over the second half of `frames` images after a sideways move of the camera from `start`, so that histories
/// are reprojected.
Means means_after_a_move(Session& session, const CameraPose& start, int frames) {
  for (int i = 0; i < kFramesBefore; ++i) session.render_frame();
  CameraPose camera = start;
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

/// Images of seeds 1, 2, …, rendered on demand by one session.
class Measurement {
 public:
  Measurement(Session session, int frames) : session_(std::move(session)), start_(session_.camera()), frames_(frames) {}

  /// Mean over `seeds` images, or all rendered ones if there are more.
  Mean over(int seeds) {
    while (seeds_ < seeds) {
      session_.set_camera(start_);
      session_.restart(++seeds_);
      const Means means = means_after_a_move(session_, start_, frames_);
      for (int m = 0; m < kMeans; ++m) {
        sums_[m] += means[m];
        squares_[m] += means[m] * means[m];
      }
    }
    const double n = seeds_;
    Mean mean;
    for (int m = 0; m < kMeans; ++m) {
      mean.value[m] = sums_[m] / n;
      mean.error[m] = std::sqrt(std::max(0.0, squares_[m] / n - mean.value[m] * mean.value[m]) / (n - 1));
    }
    return mean;
  }

 private:
  Session session_;
  CameraPose start_;
  int frames_;
  int seeds_ = 0;
  Means sums_ = {};
  Means squares_ = {};
};

/// Reference by number of bounces, measured once per process. Many cells have the default number, and single presets
/// others: theirs have fewer seeds, since a reference takes longer than a preset. On the host, also if cells are
/// rendered on a device.
const Mean& reference(int max_bounces) {
  static std::map<int, Mean> known;
  const auto [found, is_new] = known.try_emplace(max_bounces);
  if (is_new) {
    RenderSettings settings = small_settings(kSize, kSize);
    settings.path.max_bounces = max_bounces;
    const int seeds = max_bounces == RenderSettings{}.path.max_bounces ? 32 : 12;
    found->second = Measurement(make_session(open_box(), settings, host_memory()), 256).over(seeds);
  }
  return found->second;
}

/// Scales settings to the small images.
RenderSettings scaled(RenderSettings settings) {
  settings.static_lists.rays = 64;  // their preparation would dominate the test's time
  settings.static_lists.cell_size = 0.5f;
  settings.octree.collapse = 32;  // many regions for few pixels
  settings.octree.split = 64;
  settings.octree.scale = false;
  return settings;
}

const std::vector<Cell>& cells() {
  static const std::vector<Cell> list = distinct_cells(scaled(small_settings(kSize, kSize)));
  return list;
}

using Deviations = std::array<Deviation, kMeans>;

/// Renders seeds until the standard error of luminance is at most `most_error`.
Deviations deviations_of(const RenderSettings& settings, double most_error = kMostError) {
  const Mean& truth = reference(settings.path.max_bounces);
  Measurement measurement(Session(open_box(), settings), kFrames);
  Deviations deviations;
  for (int seeds = kSeeds; seeds <= kMostSeeds; seeds += seeds / 4) {
    const Mean mean = measurement.over(seeds);
    for (int m = 0; m < kMeans; ++m) {
      deviations[m] = {mean.value[m] / truth.value[m] - 1, std::hypot(mean.error[m], truth.error[m]) / truth.value[m]};
    }
    if (deviations[0].error <= most_error) break;
  }
  return deviations;
}

/// Description of wrong means; empty if they are correct within `bias`.
std::string problem_of(const Deviations& deviations, double bias, double most_error = kMostError) {
  if (deviations[0].error > most_error)
    return fmt::format("a standard error of {:.2f} % says too little", 100 * deviations[0].error);
  for (const Deviation& d : deviations) {
    if (std::fabs(d.value) <= bias + kStandardErrors * d.error) continue;
    return fmt::format("{:+.2f} % with a standard error of {:.2f} %", 100 * d.value, 100 * d.error);
  }
  return {};
}

std::string names_of(const Cell& cell) {
  std::string names;
  for (const auto& pair : cell.pairs) names += (names.empty() ? "" : ", ") + name_of(pair);
  return names;
}

/// Supported cells, combined where settings are equal.
class Combinations : public ::testing::TestWithParam<size_t> {
 protected:
  static void check(double most_error) {
    const Cell& cell = cells()[GetParam()];
    EXPECT_EQ(problem_of(deviations_of(cell.settings, most_error), cell.bias, most_error), "") << names_of(cell);
  }
};
TEST_P(Combinations, HaveTheCorrectMean) { check(kMostError); }

/// Same with higher precision, which detects errors slightly above one percent.
class SlowCombinations : public Combinations {};
TEST_P(SlowCombinations, HaveTheCorrectMean) { check(kMostSlowError); }

std::string cell_name(const ::testing::TestParamInfo<size_t>& info) {
  const auto& [a, b] = cells()[info.param].pairs.front();
  return test_name(a.slot + "_" + a.value + "_" + b.slot + "_" + b.value);
}
// CMakeLists.txt runs these in few processes, since each process renders a reference first.
const auto kCells = ::testing::Range(size_t{0}, cells().size());
INSTANTIATE_TEST_SUITE_P(Shared, Combinations, kCells, cell_name);
INSTANTIATE_TEST_SUITE_P(Shared, SlowCombinations, kCells, cell_name);

/// A choice with a setting under which not every pixel has a whole path in each frame.
struct FewerPaths {
  std::string name;
  Choice choice;
  RenderSettings settings;
};

struct FewerPathsCells {
  std::vector<FewerPaths> supported;  ///< with distinct settings
  std::set<std::string> refused;
};

const FewerPathsCells& fewer_paths() {
  static const FewerPathsCells cells = [] {
    RenderSettings half_rate = scaled(small_settings(kSize, kSize));
    half_rate.path.indirect_rate = 0.5f;
    RenderSettings upscaled = scaled(small_settings(kSize, kSize));
    upscaled.upscaling.factor = 2;
    FewerPathsCells all;
    std::set<std::string> known;
    for (const Choice& choice : all_choices()) {
      for (const auto& [name, base] : {std::pair("half_rate", half_rate), std::pair("upscaled", upscaled)}) {
        FewerPaths fewer{choice.slot + "_" + choice.value + "_" + name, choice, combine(base, choice, choice)};
        if (!refusal(fewer.settings).empty()) {
          all.refused.insert(fewer.name);
        } else if (known.insert(settings_to_json(describe(fewer.settings))).second) {
          all.supported.push_back(fewer);
        }
      }
    }
    return all;
  }();
  return cells;
}

class WithFewerPaths : public ::testing::TestWithParam<size_t> {};
TEST_P(WithFewerPaths, HaveTheCorrectMean) {
  const FewerPaths& fewer = fewer_paths().supported[GetParam()];
  EXPECT_EQ(problem_of(deviations_of(fewer.settings), fewer.choice.bias), "");
}

std::string fewer_paths_name(const ::testing::TestParamInfo<size_t>& info) {
  return test_name(fewer_paths().supported[info.param].name);
}
INSTANTIATE_TEST_SUITE_P(Shared, WithFewerPaths, ::testing::Range(size_t{0}, fewer_paths().supported.size()),
                         fewer_paths_name);

TEST(FewerPaths, OnlyChoicesOfPixelsAreRefused) {
  std::set<std::string> refused{"allocation_adaptive_upscaled", "history_none_upscaled", "reuse_restir-di_upscaled"};
  if (!refusal(combine({}, {"denoise", "oidn"}, {"denoise", "oidn"})).empty())  // a build without the library
    refused.merge(std::set<std::string>{"denoise_oidn_half_rate", "denoise_oidn_upscaled"});
  EXPECT_EQ(fewer_paths().refused, refused);
}

TEST(CombinationTable, ErrorsNameWorkingAlternatives) {
  int refused = 0;
  for (const Choice& a : all_choices()) {
    for (const Choice& b : all_choices()) {
      const std::string reason = a.slot == b.slot ? "" : refusal(combine({}, a, b));
      EXPECT_TRUE(reason.empty() || reason.find("use ") != std::string::npos) << name_of({a, b}) << ": " << reason;
      refused += reason.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(CombinationTable, EveryCellIsComparedOnceOrRefused) {
  std::map<std::string, int> compared;
  for (const Cell& cell : cells()) {
    for (const auto& pair : cell.pairs) ++compared[name_of(pair)];
  }
  const std::vector<Choice>& choices = all_choices();
  for (size_t i = 0; i < choices.size(); ++i) {
    for (size_t k = i + 1; k < choices.size(); ++k) {
      if (choices[i].slot == choices[k].slot) continue;
      const bool runs = refusal(combine({}, choices[i], choices[k])).empty();
      EXPECT_EQ(compared[name_of({choices[i], choices[k]})], runs ? 1 : 0) << name_of({choices[i], choices[k]});
    }
  }
}

std::string text_of(RenderSettings settings) { return settings_to_json(describe(settings)); }

/// Presets that are no cells of the table, which Combinations renders.
TEST(SharedPresets, ShowTheRightMean) {
  std::set<std::string> compared;
  for (const Cell& cell : cells()) compared.insert(text_of(cell.settings));
  for (const Preset& preset : presets()) {
    AllSettings settings = resolve({.preset = std::string(preset.name)});
    settings.render.width = settings.render.height = kSize;
    settings.render.threads = 1;
    settings.render = scaled(settings.render);
    if (!compared.insert(text_of(settings.render)).second) continue;
    EXPECT_EQ(problem_of(deviations_of(settings.render), bias_of(settings.render)), "") << preset.name;
  }
  EXPECT_GT(compared.size(), cells().size()) << "no preset was rendered";
}

TEST(CombinationTable, SlotsWithABiasedChoiceDeclareIt) {
  RenderSettings settings;
  const SettingList slots = describe_slots(settings);
  for (const Choice& choice : all_choices()) {
    EXPECT_TRUE(choice.bias == 0 || require_setting(slots, choice.slot, "").traits.biases) << choice.slot;
  }
}

/// The page from a rendering of every cell.
std::string measured_page() {
  std::map<std::string, std::pair<Deviations, double>> measured;  // with the stated bias
  for (const Cell& cell : cells()) {
    const std::pair result(deviations_of(cell.settings), cell.bias);
    for (const auto& pair : cell.pairs) measured[name_of(pair)] = result;
  }
  const auto holds = [&](const Choice& a, const Choice& b) {
    const auto& [deviations, bias] = measured.at(name_of({a, b}));
    return problem_of(deviations, bias).empty();
  };
  return combination_table(holds) + deviation_table([&](const Choice& a, const Choice& b) {
           return measured.at(name_of({a, b})).first[0];
         });
}

/// Compares the page without its measurements, since each cell has a separate test.
TEST(CombinationTable, MatchesTheDocumentation) {
  const char* file = RELUME_SOURCE_DIR "/docs/combinations.md";
  if (std::getenv("RELUME_WRITE")) {
    const std::string page = measured_page();
    std::ofstream(file) << page;
  }
  std::ostringstream stored;
  stored << std::ifstream(file).rdbuf();
  const std::string text = stored.str();
  EXPECT_EQ(text.substr(0, text.find(kDeviationsTitle)),
            combination_table([](const Choice&, const Choice&) { return true; }))
      << "run it with RELUME_WRITE=1";
}

}  // namespace
}  // namespace relume::support
