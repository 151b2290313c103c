// Tests each cell of the combination table: it renders the expected mean within its stated bias, or is rejected with an
// explanation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "combinations/cells.h"
#include "combinations/means.h"
#include "render/build_pipeline.h"
#include "render/presets.h"
#include "render/settings.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr int kSeeds = 10;
/// Of 340 cells and four means each, with random seeds, normal errors would exceed this in one of 110 runs. Few seeds
/// estimate their error less well, so false alarms are more frequent. Seeds are fixed: an alarm can only follow a
/// change of bits, and the slow tests, with longer references, decide.
constexpr double kStandardErrors = 4.5;

/// Largest standard errors of a cell's mean: higher ones would hide errors of several percent.
constexpr double kMostError = 0.005;
constexpr double kMostSlowError = 0.0025;
/// Largest standard error for cells with fewer paths, which Combinations renders with all paths. If weights did not
/// compensate for missing paths, half of the indirect light, or three of four pixels, would be lost. An error of 7 % is
/// detected with a probability of 99 %. Cells that would end at kSeeds need more seeds for enough degrees of freedom.
constexpr double kMostErrorWithFewerPaths = 0.01;
constexpr int kSeedsWithFewerPaths = 16;
/// Without next event estimation, kMostError would take 16 times the samples. Tests of Markov chain guiding compare its
/// mean more closely.
constexpr double kMostErrorWithoutNextEvents = 0.025;
/// Largest standard errors of a preset in the quick tests. Combinations renders each of its choices alone.
constexpr double kMostErrorOfAPreset = 0.01;
constexpr double kMostErrorOfAPresetWithoutNextEvents = 0.05;
constexpr int kSeedsOfAPreset = 16;

const std::vector<Cell>& cells() {
  static const std::vector<Cell> list = distinct_cells(scaled(small_settings(kSize, kSize)));
  return list;
}

Deviations deviations_of(const RenderSettings& settings, double most_error = kMostError, int least_seeds = kSeeds) {
  const ReferenceLength length = most_error < kMostError ? ReferenceLength::whole : ReferenceLength::quarter;
  return measure_deviations(settings, reference(settings.path.max_bounces, length), most_error, least_seeds);
}

std::string problem_of(const Deviations& deviations, double bias, double most_error = kMostError) {
  return describe_problem(deviations, bias, most_error, [](const Deviation&) { return kStandardErrors; });
}

std::string names_of(const Cell& cell) {
  std::string names;
  for (const auto& pair : cell.pairs) names += (names.empty() ? "" : ", ") + name_of(pair);
  return names;
}

/// Supported cells, combined where settings are equal. The quick ones.
class Combinations : public ::testing::TestWithParam<size_t> {
 protected:
  static void check(double most_error) {
    const Cell& cell = cells()[GetParam()];
    EXPECT_EQ(problem_of(deviations_of(cell.settings, most_error), cell.bias, most_error), "") << names_of(cell);
  }
};
TEST_P(Combinations, HaveTheCorrectMean) { check(kMostError); }

/// The other cells. Only the emulated device renders them, since SlowCombinations does so on the host.
class OtherCombinations : public Combinations {};
TEST_P(OtherCombinations, HaveTheCorrectMean) { check(kMostError); }

/// All cells with higher precision, which detects errors slightly above one percent.
class SlowCombinations : public Combinations {};
TEST_P(SlowCombinations, HaveTheCorrectMean) { check(kMostSlowError); }

/// Whether a cell stands for paths that no single choice has. There are three kinds:
/// - They fill cells, and resample direct light or leave it to reservoirs.
/// - They use cells or light subpaths, and leave indirect light or whole paths to reservoirs.
/// - They record states of chains. They also record samples for regions, end in cells, or are subpaths from both sides.
bool has_paths_of_its_own(const Cell& cell) {
  const RenderSettings& s = cell.settings;
  const bool direct = s.reuse == ReuseChoice::ris || s.reuse == ReuseChoice::restir_di;
  const bool takes_cells = s.cache == CacheChoice::psf || s.cache == CacheChoice::apg || s.cache == CacheChoice::sharc;
  const bool has_light_subpaths = s.estimator == EstimatorChoice::bdpt || s.estimator == EstimatorChoice::vcm;
  const bool whole =
      s.reuse == ReuseChoice::restir_pt && (s.cache == CacheChoice::apg || s.cache == CacheChoice::sharc);
  return (direct && s.cache == CacheChoice::psf) ||
         (s.reuse == ReuseChoice::restir_gi && (takes_cells || has_light_subpaths)) || whole ||
         (s.lights == LightSelectionChoice::mcls && s.guide == GuideChoice::cdq) ||
         (s.guide == GuideChoice::mcpg && (s.cache == CacheChoice::apg || s.estimator == EstimatorChoice::bdpt));
}

std::set<std::string> choices_of(const Cell& cell) {
  std::set<std::string> names;
  for (const auto& [a, b] : cell.pairs) names.insert({a.slot + "=" + a.value, b.slot + "=" + b.value});
  return names;
}

/// Flags the quick cells: those with at most one choice that is not a default, those with paths of their own, an eighth
/// of the rest, and a pair of each choice that these leave out.
const std::vector<bool>& quick_cells() {
  static const std::vector<bool> quick = [] {
    constexpr size_t kStride = 8;
    std::vector<bool> list;
    std::map<std::string, int> uses;
    const auto count = [&](const Cell& cell) {
      for (const std::string& name : choices_of(cell)) ++uses[name];
    };
    for (const Cell& cell : cells()) {
      const bool is_choice_alone = cell.pairs.size() > 1;  // with the default of each other slot
      list.push_back(is_choice_alone || has_paths_of_its_own(cell) || list.size() % kStride == 0);
      if (list.back()) count(cell);
    }
    for (size_t i = 0; i < list.size(); ++i) {
      const std::set<std::string> names = choices_of(cells()[i]);
      const auto is_left_out = [&](const std::string& name) { return uses[name] < 2; };
      if (list[i] || std::none_of(names.begin(), names.end(), is_left_out)) continue;
      list[i] = true;
      count(cells()[i]);
    }
    return list;
  }();
  return quick;
}

/// Indices of the quick cells, or of the others.
std::vector<size_t> indices(bool quick) {
  std::vector<size_t> list;
  for (size_t i = 0; i < cells().size(); ++i) {
    if (quick_cells()[i] == quick) list.push_back(i);
  }
  return list;
}

std::string cell_name(const ::testing::TestParamInfo<size_t>& info) {
  const auto& [a, b] = cells()[info.param].pairs.front();
  return test_name(a.slot + "_" + a.value + "_" + b.slot + "_" + b.value);
}
// CMakeLists.txt runs these in few processes, since each process renders a reference first.
INSTANTIATE_TEST_SUITE_P(Shared, Combinations, ::testing::ValuesIn(indices(true)), cell_name);
INSTANTIATE_TEST_SUITE_P(Shared, OtherCombinations, ::testing::ValuesIn(indices(false)), cell_name);
INSTANTIATE_TEST_SUITE_P(Shared, SlowCombinations, ::testing::Range(size_t{0}, cells().size()), cell_name);

TEST(QuickCombinations, HaveEveryChoiceAloneAndInAPair) {
  std::map<std::string, int> uses;
  for (const size_t i : indices(true)) {
    for (const std::string& name : choices_of(cells()[i])) ++uses[name];
  }
  for (const Choice& choice : all_choices()) {
    const int least = refusal(combine({}, choice, choice)).empty() ? 2 : 0;
    EXPECT_GE(uses[choice.slot + "=" + choice.value], least) << choice.slot << " " << choice.value;
  }
}

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

class WithFewerPaths : public ::testing::TestWithParam<size_t> {
 protected:
  static void check(double most_error, int least_seeds) {
    const FewerPaths& fewer = fewer_paths().supported[GetParam()];
    const Deviations deviations = deviations_of(fewer.settings, most_error, least_seeds);
    EXPECT_EQ(problem_of(deviations, fewer.choice.bias, most_error), "");
  }
};
TEST_P(WithFewerPaths, HaveTheCorrectMean) { check(kMostErrorWithFewerPaths, kSeedsWithFewerPaths); }

/// The others. Only the emulated device renders them with this precision.
class OtherWithFewerPaths : public WithFewerPaths {};
TEST_P(OtherWithFewerPaths, HaveTheCorrectMean) { check(kMostErrorWithFewerPaths, kSeedsWithFewerPaths); }

/// All of them with higher precision.
class SlowWithFewerPaths : public WithFewerPaths {};
TEST_P(SlowWithFewerPaths, HaveTheCorrectMean) { check(kMostError, kSeeds); }

std::string fewer_paths_name(const ::testing::TestParamInfo<size_t>& info) {
  return test_name(fewer_paths().supported[info.param].name);
}

/// Indices of the quick ones, one of each choice, alternately with half of the indirect paths and a quarter of the
/// pixels; or of the others.
std::vector<size_t> fewer_paths_indices(bool quick) {
  const std::vector<FewerPaths>& all = fewer_paths().supported;
  std::vector<size_t> chosen;
  std::vector<size_t> others;
  for (size_t first = 0, end = 0; first < all.size(); first = end) {
    while (end < all.size() && all[end].choice.slot == all[first].choice.slot &&
           all[end].choice.value == all[first].choice.value)
      ++end;
    const size_t taken = first + chosen.size() % (end - first);
    for (size_t i = first; i < end; ++i) {
      if (i != taken) others.push_back(i);
    }
    chosen.push_back(taken);
  }
  return quick ? chosen : others;
}
INSTANTIATE_TEST_SUITE_P(Shared, WithFewerPaths, ::testing::ValuesIn(fewer_paths_indices(true)), fewer_paths_name);
INSTANTIATE_TEST_SUITE_P(Shared, OtherWithFewerPaths, ::testing::ValuesIn(fewer_paths_indices(false)),
                         fewer_paths_name);
INSTANTIATE_TEST_SUITE_P(Shared, SlowWithFewerPaths, ::testing::Range(size_t{0}, fewer_paths().supported.size()),
                         fewer_paths_name);

TEST(FewerPaths, OnlyChoicesOfPixelsAreRefused) {
  std::set<std::string> refused{"allocation_adaptive_upscaled", "history_none_upscaled"};
  if (!refusal(combine({}, {"denoise", "oidn"}, {"denoise", "oidn"})).empty())  // a build without the library
    refused.merge(std::set<std::string>{"denoise_oidn_half_rate", "denoise_oidn_upscaled"});
  EXPECT_EQ(fewer_paths().refused, refused);
}

TEST(QuickCombinations, HaveEachKindOfPathsOfTheirOwn) {
  const std::vector<size_t> quick = indices(true);
  EXPECT_EQ(std::count_if(quick.begin(), quick.end(), [](size_t i) { return has_paths_of_its_own(cells()[i]); }), 12);
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

/// Only these combinations are impossible, by the proofs in their sentences. The others say that work was not done.
TEST(CombinationTable, ErrorsWithoutAProofSayNotImplemented) {
  std::set<std::string> proofs;
  for (const Choice& a : all_choices()) {
    for (const Choice& b : all_choices()) {
      if (a.slot == b.slot || a.value == "oidn" || b.value == "oidn") continue;
      const std::string reason = refusal(combine({}, a, b));
      if (!reason.empty() && reason.find("not implemented; use ") == std::string::npos)
        proofs.insert(reason.substr(0, reason.find(':')));
    }
  }
  EXPECT_EQ(proofs, (std::set<std::string>{
                        "allocation 'adaptive' does not combine with history 'none'",
                        "estimator 'light' does not combine with a radiance cache",
                        "estimators 'bdpt' and 'vcm' do not combine with caches 'apg', 'apsf+apg' and 'sharc'",
                        "lights 'vlc', 'neeat' and 'mcls' and guides 'cdq' and 'mcpg' do not combine with estimator "
                        "'light'",
                        "reuse 'restir-gi', 'restir-di+gi' and 'restir-pt' do not combine with estimator 'light'",
                    }));
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

/// Compares presets outside the table. Combinations renders those that are cells of it. Presets that only change the
/// number of bounces are the path tracing that others are compared with.
void check_presets(double most_error, double most_error_without_next_events, int least_seeds) {
  std::set<std::string> compared;
  for (const Cell& cell : cells()) compared.insert(text_of(cell.settings));
  for (const Preset& preset : presets()) {
    AllSettings settings = resolve({.preset = std::string(preset.name)});
    settings.render.width = settings.render.height = kSize;
    settings.render.threads = 1;
    settings.render = scaled(settings.render);
    RenderSettings with_default_bounces = settings.render;
    with_default_bounces.path.max_bounces = RenderSettings{}.path.max_bounces;
    if (compared.contains(text_of(with_default_bounces))) continue;
    if (!compared.insert(text_of(settings.render)).second) continue;
    const double error = settings.render.mcpg.nee ? most_error : most_error_without_next_events;
    const Deviations deviations = deviations_of(settings.render, error, least_seeds);
    EXPECT_EQ(problem_of(deviations, bias_of(settings.render), error), "") << preset.name;
  }
  EXPECT_GT(compared.size(), cells().size()) << "no preset was rendered";
}
TEST(SharedPresets, ShowTheRightMean) {
  check_presets(kMostErrorOfAPreset, kMostErrorOfAPresetWithoutNextEvents, kSeedsOfAPreset);
}
TEST(SharedSlowPresets, ShowTheRightMean) { check_presets(kMostError, kMostErrorWithoutNextEvents, kSeeds); }

TEST(CombinationTable, SlotsWithABiasedChoiceDeclareIt) {
  RenderSettings settings;
  const SettingList slots = describe_slots(settings);
  for (const Choice& choice : all_choices()) {
    EXPECT_TRUE(choice.bias == 0 || require_setting(slots, choice.slot, "").traits.biases) << choice.slot;
  }
}

/// The page from a rendering of every cell.
std::string measured_page() {
  const Mean& truth = reference(RenderSettings{}.path.max_bounces, ReferenceLength::whole);
  std::map<std::string, std::pair<Deviations, double>> measured;  // with the stated bias
  for (const Cell& cell : cells()) {
    const std::pair result(measure_deviations(cell.settings, truth, kMostError, kSeeds), cell.bias);
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
