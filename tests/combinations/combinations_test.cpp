// Each cell of the combination table: it renders the right mean, within its stated bias, or is refused with a sentence.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "combinations/cells.h"
#include "core/vec.h"
#include "scene/builtin.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kSize = 20;    // pixels
constexpr int kFrames = 24;  // enough for what learns to have learnt
constexpr int kSeeds = 10;
constexpr double kStandardErrors = 4.5;  // 300 cells: false alarms in 1 of 500 runs, were seeds not fixed

/// Mean luminance over pictures of several seeds, and its standard error.
struct Mean {
  double value = 0;
  double error = 0;
};

Mean mean_over_seeds(const RenderSettings& settings, int frames, int seeds) {
  static const Scene scene = find_builtin_scene("cornell")->build();
  double sum = 0;
  double squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    RenderSettings s = settings;
    s.seed = static_cast<uint32_t>(1 + seed);
    const double mean = static_cast<double>(luminance(estimate_of(render(scene, s, frames)).mean));
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

void check_cell(const Choice& a, const Choice& b) {
  SCOPED_TRACE(a.slot + "=" + a.value + " with " + b.slot + "=" + b.value);
  RenderSettings settings = combine(small_settings(kSize, kSize), a, b);
  settings.static_lists.rays = 64;  // what they are prepared with would take longer than all else together
  if (const std::string reason = refusal(settings); !reason.empty()) {
    EXPECT_NE(reason.find("use "), std::string::npos) << "does not say what would work: " << reason;
    return;
  }
  const Mean mean = mean_over_seeds(settings, kFrames, kSeeds);
  const double allowed =
      (a.bias + b.bias) * reference().value + kStandardErrors * std::hypot(mean.error, reference().error);
  EXPECT_NEAR(mean.value, reference().value, allowed)
      << 100 * (mean.value / reference().value - 1) << " %, standard error " << 100 * mean.error / reference().value;
}

/// A choice against all choices of the slots after its own.
class Combinations : public ::testing::TestWithParam<Choice> {};

TEST_P(Combinations, RightInTheMeanOrRefused) {
  bool after = false;
  for (const Choice& other : all_choices()) {
    after = after || other == GetParam();
    if (after && other.slot != GetParam().slot) check_cell(GetParam(), other);
  }
}

std::string choice_name(const ::testing::TestParamInfo<Choice>& info) {
  std::string name = info.param.slot + "_" + info.param.value;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, Combinations, ::testing::ValuesIn(all_choices()), choice_name);

TEST(CombinationTable, IsTheOneInTheDocumentation) {
  const char* file = RELUME_SOURCE_DIR "/docs/combinations.md";
  if (std::getenv("RELUME_WRITE")) std::ofstream(file) << combination_table();
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_EQ(text.str(), combination_table()) << "run it with RELUME_WRITE=1";
}

}  // namespace
}  // namespace relume::support
