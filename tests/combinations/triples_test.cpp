// Tests five hundred random combinations of three or more choices: the expected mean within the stated bias, no NaN,
// and the same bits with any number of threads and after a resume.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "combinations/cells.h"
#include "combinations/means.h"
#include "combinations/triples.h"
#include "determinism/same_bits.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "settings/settings_json.h"
#include "support/image_test.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr size_t kTriples = 500;
constexpr size_t kQuickTriples = 6;

/// Probability that any triple of a list fails although its mean is right, with random seeds.
constexpr double kFalseAlarm = 0.01;

/// Largest standard errors of the luminance: higher ones would hide errors of several percent.
constexpr double kMostError = 0.005;
constexpr double kMostQuickError = 0.015;
constexpr int kSeeds = 16;
constexpr int kQuickSeeds = 8;

const std::vector<Triple>& triples() {
  static const std::vector<Triple> list = draw_triples(kTriples);
  return list;
}

const std::vector<Triple>& quick_triples() {
  static const std::vector<Triple> list = covering(triples(), kQuickTriples);
  return list;
}

/// Quantile of Student's distribution for a single comparison by Šidák, over `count` triples and all channels.
template <size_t count>
double sidak_limit(const Deviation& deviation) {
  constexpr double kComparisons = static_cast<double>(count) * kMeans;
  static const double p = -std::expm1(std::log1p(-kFalseAlarm) / kComparisons);
  return student_two_sided_quantile(p, deviation.degrees);
}

void expect_correct_mean(const Triple& triple, const Mean& truth, double most_error, int least_seeds,
                         NoiseLimit limit) {
  const RenderSettings settings = scaled(combine(small_settings(kSize, kSize), triple));
  const Deviations deviations = measure_deviations(settings, truth, most_error, least_seeds);
  EXPECT_EQ(describe_problem(deviations, bias_of(settings), most_error, limit), "") << command_of(triple);
}

constexpr int kHalf = 5;  // frames before the checkpoint, after which the camera moves, and the same number after it

/// Small images of several tiles. Structures fill within a few frames.
RenderSettings bits_settings(const Triple& triple, int threads) {
  RenderSettings settings = scaled(combine(small_settings(37, 21), triple));
  settings.threads = threads;
  settings.auxiliary = true;
  settings.apsf.min_samples = 16;
  settings.vcm.radius = 0.05f;
  return settings;
}

void render_half(Session& session) {
  for (int i = 0; i < kHalf; ++i) session.render_frame();
}

/// Moves the camera, renders the second half, and returns all floats of the image and the buffers.
std::vector<uint32_t> bits_after_the_move(Session& session) {
  CameraPose camera = session.camera();
  camera.to_world[3] += 0.1f * camera.to_world[0];
  session.set_camera(camera);
  render_half(session);
  const Image image = session.image();
  for (const Rgb& pixel : image.pixels) EXPECT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z));
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  return bits_of(session);
}

void expect_same_bits(const Triple& triple) {
  SCOPED_TRACE(command_of(triple));
  const std::filesystem::path file = checkpoint_file(triple_name(triple));
  const Scene scene = open_box();
  Session one(Scene(scene), bits_settings(triple, 1));
  render_half(one);
  const std::vector<uint32_t> bits = bits_after_the_move(one);
  Session five(Scene(scene), bits_settings(triple, 5));
  render_half(five);
  five.save_checkpoint(file);
  EXPECT_TRUE(bits_after_the_move(five) == bits) << "five threads";
  Session resumed(Scene(scene), bits_settings(triple, 5));
  resumed.load_checkpoint(file);
  EXPECT_TRUE(bits_after_the_move(resumed) == bits) << "resumed";
  std::error_code failure;
  std::filesystem::remove(file, failure);
}

/// A few triples with as many different choices as possible, with lower precision.
class Triples : public ::testing::TestWithParam<size_t> {};
TEST_P(Triples, HaveTheCorrectMean) {
  const Mean& truth = reference(RenderSettings{}.path.max_bounces, ReferenceLength::quarter);
  expect_correct_mean(quick_triples()[GetParam()], truth, kMostQuickError, kQuickSeeds, sidak_limit<kQuickTriples>);
}
TEST_P(Triples, HaveTheSameBits) { expect_same_bits(quick_triples()[GetParam()]); }

/// All triples.
class SlowTriples : public ::testing::TestWithParam<size_t> {};
TEST_P(SlowTriples, HaveTheCorrectMean) {
  const Mean& truth = reference(RenderSettings{}.path.max_bounces, ReferenceLength::whole);
  expect_correct_mean(triples()[GetParam()], truth, kMostError, kSeeds, sidak_limit<kTriples>);
}
TEST_P(SlowTriples, HaveTheSameBits) { expect_same_bits(triples()[GetParam()]); }

INSTANTIATE_TEST_SUITE_P(Shared, Triples, ::testing::Range(size_t{0}, quick_triples().size()),
                         [](const auto& instance) { return triple_name(quick_triples()[instance.param]); });
INSTANTIATE_TEST_SUITE_P(Shared, SlowTriples, ::testing::Range(size_t{0}, triples().size()),
                         [](const auto& instance) { return triple_name(triples()[instance.param]); });

TEST(TripleList, HasDistinctPermittedTriples) {
  RenderSettings defaults;
  const SettingList slots = describe_slots(defaults);
  std::set<std::string> names;
  EXPECT_EQ(triples().size(), kTriples);
  EXPECT_EQ(quick_triples().size(), kQuickTriples);
  for (const Triple& triple : triples()) {
    EXPECT_TRUE(names.insert(triple_name(triple)).second) << command_of(triple);
    EXPECT_EQ(refusal(combine(RenderSettings{}, triple)), "") << command_of(triple);
    std::set<std::string> chosen;
    for (const Choice& choice : triple) {
      chosen.insert(choice.slot);
      EXPECT_NE(choice.value, to_string(require_setting(slots, choice.slot, "triple")));
    }
    EXPECT_GE(chosen.size(), 3u) << command_of(triple);
    EXPECT_EQ(chosen.size(), triple.size()) << command_of(triple);
  }
}

TEST(TripleList, HasEveryChoice) {
  RenderSettings defaults;
  const SettingList slots = describe_slots(defaults);
  std::map<std::string, int> uses;
  for (const Triple& triple : triples()) {
    for (const Choice& choice : triple) ++uses[choice.slot + "=" + choice.value];
  }
  for (const Choice& choice : all_choices()) {
    const bool is_default = choice.value == to_string(require_setting(slots, choice.slot, "triple"));
    if (is_default || choice.value == "oidn") continue;
    // Reservoirs, of which there are five, refuse most other choices.
    EXPECT_GE(uses[choice.slot + "=" + choice.value], 5) << choice.slot << " " << choice.value;
  }
}

TEST(TripleList, CommandsSetTheChoices) {
  for (const Triple& triple : triples()) {
    std::istringstream words(command_of(triple));
    std::string word;
    for (int i = 0; i < 3; ++i) words >> word;  // relume render cornell
    RenderSettings parsed;
    std::string value;
    while (words >> word >> value)
      assign(require_setting(describe(parsed), word.substr(2), "command"), value, "command");
    RenderSettings expected = combine(RenderSettings{}, triple);
    EXPECT_EQ(settings_to_json(describe(parsed)), settings_to_json(describe(expected))) << command_of(triple);
  }
}

}  // namespace
}  // namespace relume::support
