#include "compare/comparison_page.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr size_t kRelMse = 1;
constexpr size_t kBias = 4;

Image grey(float value) {
  Image image(32, 24);
  for (Rgb& pixel : image.pixels) pixel = Rgb(value);
  return image;
}

ContenderResult contender(std::string name, const std::vector<double>& rel_mse) {
  ContenderResult result{.name = std::move(name), .is_image = false, .settings = "{}"};
  for (const double value : rel_mse)
    result.repetitions.push_back({.frames = 1, .time_s = 1, .mse = value, .rel_mse = value, .mape = value});
  result.image = grey(0.4f);
  return result;
}

Comparison compared(std::vector<ContenderResult> contenders) {
  Comparison c;
  c.options.scene_name = "room";
  c.options.repetitions = static_cast<int>(contenders.front().repetitions.size());
  c.reference.image = grey(0.5f);
  c.reference.spp = 64;
  c.threads = 1;
  c.contenders = std::move(contenders);
  return c;
}

std::string in_short(const Comparison& c) { return std::get<TextBlock>(comparison_page(c, {}).blocks.front()).text; }

TableCell bias_cell(const std::optional<ErrorSplit>& split) {
  Comparison c = compared({contender("a", {1, 2, 3})});
  c.contenders.front().split = split;
  return comparison_table(c).rows.front().cells.at(kBias);
}

TEST(ComparisonPage, BiasIsNearZeroOnlyWithinItsNoise) {
  EXPECT_EQ(bias_cell(ErrorSplit{.bias2 = 0.5, .bias2_error = 0.1}).text, "0.5");
  EXPECT_EQ(bias_cell(ErrorSplit{.bias2 = 0.5, .bias2_error = 0.1}).note, "± 0.2");
  EXPECT_EQ(bias_cell(ErrorSplit{.bias2 = 0.15, .bias2_error = 0.1}).text, "≈ 0");
  EXPECT_EQ(bias_cell(ErrorSplit{.bias2 = 0.15, .bias2_error = 0.1}).note, "0.15 ± 0.2");
  EXPECT_EQ(bias_cell(ErrorSplit{.bias2 = 0.5}).text, "0.5");
  EXPECT_EQ(bias_cell(ErrorSplit{.bias2 = 0.5}).note, "± not known");
  EXPECT_EQ(bias_cell(std::nullopt).note, "not known");
}

TEST(ComparisonPage, NumbersKeepSignificantDigits) {
  EXPECT_EQ(short_number(1024), "1024");
  EXPECT_EQ(short_number(999.6), "1000");
  EXPECT_EQ(short_number(1234.5), "1234");
  EXPECT_EQ(short_number(0.0012345), "0.00123");
  EXPECT_EQ(short_number(3.2e9), "3.2e+09");
  EXPECT_EQ(short_number(NAN), "–");
}

TEST(ComparisonPage, TheSplitOfAnAnimationIsOfItsLastFrame) {
  Comparison c = compared({contender("a", {1, 2, 3})});
  const auto help_of_bias = [&] { return comparison_table(c).columns.at(kBias).help; };
  EXPECT_EQ(help_of_bias().find("last frame"), std::string::npos);
  c.options.times_s = {0, 1};
  EXPECT_NE(help_of_bias().find("last frame"), std::string::npos);
}

TEST(ComparisonPage, MarksTheBestIfIntervalsAreDisjoint) {
  const Comparison c = compared({contender("a", {1, 2, 3}), contender("b", {4, 5, 6})});
  EXPECT_EQ(comparison_table(c).columns.at(kRelMse).better, Better::lower);
  EXPECT_EQ(in_short(c), "a is closest to the reference: relMSE 2. By the same measure, b has 2.5 times as much.");
}

TEST(ComparisonPage, MarksNoBestIfIntervalsOverlap) {
  const Comparison c = compared({contender("a", {1, 2, 3}), contender("b", {2.5, 4, 6}), contender("c", {9, 10, 11})});
  EXPECT_EQ(comparison_table(c).columns.at(kRelMse).better, Better::none);
  EXPECT_EQ(in_short(c),
            "a (relMSE 2) and b (relMSE 4) are closest to the reference; their intervals overlap. By the same measure, "
            "c has 5 times as much as a.");
  const Comparison few = compared({contender("a", {1, 2}), contender("b", {5, 6})});
  EXPECT_EQ(comparison_table(few).columns.at(kRelMse).better, Better::none);
  EXPECT_NE(in_short(few).find("fewer than three repetitions"), std::string::npos);
}

TEST(ComparisonPage, NonFiniteValuesAreNeverBest) {
  Comparison c = compared({contender("a", {1, 1, 1}), contender("b", {4, 5, 6})});
  c.contenders.front().repetitions.front().nonfinite = 1;
  EXPECT_EQ(in_short(c), "b has a relMSE of 5.");
  EXPECT_FALSE(comparison_table(c).rows.front().competes);
  EXPECT_TRUE(comparison_table(c).rows.back().name == "reference");
}

}  // namespace
}  // namespace relume
