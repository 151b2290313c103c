#include "compare/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builtin.h"
#include "compare/comparison_page.h"
#include "relume/error.h"

namespace relume {
namespace {

size_t occurrences(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// One microsecond per ray, independent of machine and load.
double ray_clock(const Session& session) { return 1e-6 * static_cast<double>(session.statistics().rays); }

class ComparisonTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::temp_directory_path() / ("relume_comparison_" + name);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  ComparisonOptions options(const char* techniques) {
    ComparisonOptions o;
    o.scene_name = "test";
    o.contenders = parse_contenders(techniques, "test");
    o.common.flags = {{"width", "40"}, {"height", "30"}, {"max-bounces", "3"}};
    o.cache_folder = folder_;
    o.reference_spp = 256;
    o.repetitions = 3;
    return o;
  }

  static Image grey() {
    Image image(40, 30);
    for (Rgb& pixel : image.pixels) pixel = Rgb(0.3f);
    return image;
  }
  /// Options for a few samples, compared with the image as well.
  ComparisonOptions beside_image(const std::string& name, const Image& image) {
    ComparisonOptions o = options("all=seed:1");
    o.spp = 4;
    o.repetitions = 1;
    const std::filesystem::path file = folder_ / (name + ".exr");
    write_image(file, image);
    o.images = {{name, file}};
    return o;
  }

  Comparison run(const Scene& scene, const ComparisonOptions& o) {
    std::optional<Comparison> comparison = compare(scene, o, {}, {});
    EXPECT_TRUE(comparison);
    return std::move(*comparison);
  }
  Comparison run(const char* scene, const ComparisonOptions& o) { return run(find_builtin_scene(scene)->build(), o); }

  std::filesystem::path folder_;
};

TEST_F(ComparisonTest, EqualSamples) {
  ComparisonOptions o = options("few=max-bounces:1,all=seed:7");
  o.spp = 16;
  // Keeps the lamp out of view: a few pixels on its edges would outweigh all others.
  Scene scene = find_builtin_scene("cornell")->build();
  scene.cameras.front().fov_y_rad *= 0.5f;
  const Comparison c = run(scene, o);
  ASSERT_EQ(c.contenders.size(), 2u);
  EXPECT_EQ(c.reference_settings.render.path.max_bounces, 3);
  for (const ContenderResult& contender : c.contenders) {
    ASSERT_EQ(contender.repetitions.size(), 3u);
    for (const Repetition& r : contender.repetitions) {
      EXPECT_EQ(r.frames, 16u);
      EXPECT_DOUBLE_EQ(r.samples, 16);
      EXPECT_GT(r.rays, 40u * 30u * 16u);
      ASSERT_GE(r.curve.size(), 5u);
      EXPECT_EQ(r.curve.front().frames, 1u);
      EXPECT_EQ(r.curve.back().frames, 16u);
      EXPECT_EQ(r.curve.back().mse, r.mse);
    }
  }
  EXPECT_EQ(c.contenders[1].repetitions[2].seed, 9);
  // The light missing from the first is bias; the second has none.
  ASSERT_TRUE(c.contenders[0].split && c.contenders[1].split);
  ASSERT_TRUE(c.contenders[0].split->bias2_error && c.contenders[1].split->bias2_error);
  EXPECT_GT(c.contenders[0].split->bias2, 5 * *c.contenders[0].split->bias2_error);
  EXPECT_LT(std::fabs(c.contenders[1].split->bias2), 8 * *c.contenders[1].split->bias2_error);  // 3 repetitions
  const double mse = median_of(c.contenders[1], [](const Repetition& r) { return r.mse; });
  EXPECT_NEAR(c.contenders[1].split->variance / mse, 1, 0.25);  // all of it is variance; the reference's noise is 1/16
}

TEST_F(ComparisonTest, CommonFlagsDoNotBiasTheReference) {
  ComparisonOptions o = options("all=seed:1");
  o.spp = 1;
  o.repetitions = 1;
  o.reference_spp = 4;
  const Comparison plain = run("cornell", o);
  o.common.flags.insert(o.common.flags.end(), {{"cache", "psf"}, {"denoise", "svgf"}, {"history", "none"}});
  const Comparison filtered = run("cornell", o);
  EXPECT_TRUE(filtered.reference.cached);  // the reference is unchanged
  EXPECT_EQ(filtered.reference.image.pixels, plain.reference.image.pixels);
  EXPECT_NE(filtered.contenders[0].image.pixels, plain.contenders[0].image.pixels);
  EXPECT_EQ(filtered.reference_left_out.size(), 3u);
  const auto json = nlohmann::json::parse(to_json(filtered, {}));
  EXPECT_EQ(json["reference"]["flags_left_out"]["cache"], "psf");
  EXPECT_EQ(json["reference"]["settings"]["cache"], "none");
  EXPECT_NE(to_html(comparison_page(filtered, {})).find("Not for the reference"), std::string::npos);
  o.reference_settings = {{"cache", "psf"}};
  const Comparison as_asked = run("cornell", o);
  EXPECT_EQ(as_asked.reference_settings.render.cache, CacheChoice::psf);
  EXPECT_FALSE(as_asked.reference.cached);
}

TEST_F(ComparisonTest, EqualTimeIsEqualWithin5Percent) {
  ComparisonOptions o = options("cheap=max-bounces:1,dear=max-bounces:3");
  o.budget_s = 0.4;
  o.repetitions = 5;
  o.reference_spp = 16;
  o.clock = ray_clock;
  const Comparison c = run("cornell", o);
  EXPECT_LT(c.budget_spread, 0.02);
  const auto time_s = [](const Repetition& r) { return r.time_s; };
  EXPECT_NEAR(median_of(c.contenders[0], time_s), o.budget_s, 0.2 * o.budget_s);
  EXPECT_NEAR(median_of(c.contenders[0], time_s) / median_of(c.contenders[1], time_s), 1, 0.05);
  EXPECT_GT(c.contenders[0].repetitions[0].frames, c.contenders[1].repetitions[0].frames);
  EXPECT_TRUE(c.notes.empty() || c.notes.front().find("times differ") == std::string::npos);
}

TEST_F(ComparisonTest, AStallDoesNotShortenAContenderForGood) {
  // Another program occupies the processor for a second, more than twice the budget, in the fifth frame of each
  // contender.
  ComparisonOptions o = options("a=seed:1,b=seed:2");
  o.budget_s = 0.4;
  o.repetitions = 1;
  o.reference_spp = 16;
  o.clock = [calls = std::make_shared<std::map<const Session*, int>>()](const Session& session) {
    return ray_clock(session) + (++(*calls)[&session] > 11 ? 1.0 : 0.0);
  };
  const Comparison stalled = run("cornell", o);
  o.clock = ray_clock;
  const Comparison usual = run("cornell", o);
  for (size_t i = 0; i < 2; ++i) {
    const double frames = usual.contenders[i].repetitions[0].frames;
    ASSERT_GT(frames, 20);
    EXPECT_NEAR(stalled.contenders[i].repetitions[0].frames / frames, 1, 0.05);
  }
}

TEST_F(ComparisonTest, ReportsUnequalTimes) {
  // One frame of the second contender exceeds the whole budget.
  ComparisonOptions o = options("cheap=max-bounces:1,dear=max-bounces:3");
  o.budget_s = 0.006;
  o.repetitions = 1;
  o.reference_spp = 16;
  o.clock = ray_clock;
  const Comparison c = run("cornell", o);
  ASSERT_FALSE(c.notes.empty());
  EXPECT_NE(c.notes.front().find("times differ"), std::string::npos);
}

TEST_F(ComparisonTest, AnimationsReportFlicker) {
  ComparisonOptions o = options("separate=history:none,kept=history:reproject");
  o.spp = 2;
  o.times_s = {0, 0.1f, 0.2f, 0.3f};
  const Comparison c = run("cornell-closed", o);
  const auto temporal = [](const Repetition& r) { return r.temporal_error; };
  const double separate = median_of(c.contenders[0], temporal);
  const double kept = median_of(c.contenders[1], temporal);
  EXPECT_GT(separate, 0);
  EXPECT_LT(kept, 0.8 * separate);
  // 256 samples against two.
  EXPECT_GT(c.reference_noise.temporal_error, 0);
  EXPECT_LT(c.reference_noise.temporal_error, 0.1 * separate);
  EXPECT_EQ(c.contenders[0].repetitions[0].curve.size(), 4u);
  EXPECT_EQ(c.contenders[0].repetitions[0].frames, 8u);
}

TEST_F(ComparisonTest, AnExternalImageIsAContender) {
  ComparisonOptions o = beside_image("grey", grey());
  const Comparison c = run("cornell", o);
  ASSERT_EQ(c.contenders.size(), 2u);
  EXPECT_TRUE(c.contenders[1].is_image);
  EXPECT_GT(c.contenders[1].repetitions[0].mse, 0);
  write_image(folder_ / "small.exr", Image(3, 3));
  o.images = {{"small", folder_ / "small.exr"}};
  EXPECT_THROW(compare(find_builtin_scene("cornell")->build(), o, {}, {}), Error);
}

TEST_F(ComparisonTest, ImagesAloneReportNoRendering) {
  ComparisonOptions o = beside_image("grey", grey());
  o.contenders.clear();
  o.repetitions = 5;
  const Comparison c = run("cornell", o);
  const auto json = nlohmann::json::parse(to_json(c, {}));
  EXPECT_GT(json["triangles"], 0);
  EXPECT_NE(json["scene_hash"], "0000000000000000");
  EXPECT_EQ(json["mode"], "images");
  EXPECT_TRUE(json["repetitions"].is_null() && json["spp"].is_null());
  EXPECT_FALSE(json["machine"].contains("threads"));
  const std::string html = to_html(comparison_page(c, {}));
  for (const char* claim : {"5 repetitions", "first repetition", "take turns", "Threads", "equal samples"})
    EXPECT_EQ(occurrences(html, claim), 0u) << claim;
}

TEST_F(ComparisonTest, ReportsNonFinitePixels) {
  Image image = grey();
  image.at(3, 4) = Rgb(std::nanf(""));
  image.at(5, 6).g = kInfinity;
  const ComparisonOptions o = beside_image("grey", image);
  const Comparison c = run("cornell", o);
  EXPECT_EQ(most_nonfinite(c.contenders[0]), 0u);
  EXPECT_EQ(most_nonfinite(c.contenders[1]), 2u);
  EXPECT_TRUE(std::any_of(c.notes.begin(), c.notes.end(), [](const std::string& note) {
    return note.starts_with("grey has pixels that are not finite (2)");
  }));
  EXPECT_EQ(nlohmann::json::parse(to_json(c, {}))["contenders"][1]["nonfinite_pixels"], 2);
  EXPECT_FALSE(comparison_table(c).rows[1].competes);
  for (Rgb& pixel : image.pixels) pixel.g = std::nanf("");
  write_image(folder_ / "grey.exr", image);
  EXPECT_THROW(compare(find_builtin_scene("cornell")->build(), o, {}, {}), Error);
}

TEST_F(ComparisonTest, StopsWhenAsked) {
  ComparisonOptions o = options("all=seed:1");
  std::stop_source stop;
  const auto stopped =
      compare(find_builtin_scene("cornell")->build(), o, stop.get_token(), [&](const std::string& stage, double) {
        if (stage == "contenders") stop.request_stop();
      });
  EXPECT_FALSE(stopped);
}

TEST_F(ComparisonTest, NumbersImageAndPageAgree) {
  ComparisonOptions o = options("few=max-bounces:1,\"all\"=seed:7");
  o.spp = 4;
  const Comparison c = run("cornell", o);
  const auto json = nlohmann::json::parse(to_json(c, {{"Processor", "test"}}));
  EXPECT_EQ(json["machine"]["Processor"], "test");
  EXPECT_EQ(json["contenders"].size(), 2u);
  EXPECT_DOUBLE_EQ(json["contenders"][0]["mse"]["median"].get<double>(),
                   median_of(c.contenders[0], [](const Repetition& r) { return r.mse; }));
  EXPECT_EQ(json["contenders"][0]["settings"]["max-bounces"], 1);
  EXPECT_GT(json["contenders"][0]["passes"].size(), 0u);
  const std::string csv = to_csv(c);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_NE(csv.find("\"\"\"all\"\"\","), std::string::npos);  // quoted for CSV
  const Page page = comparison_page(c, {{"Processor", "test"}});
  const std::string html = to_html(page);
  EXPECT_NE(html.find("data-theme-choice"), std::string::npos);
  EXPECT_EQ(occurrences(html, "http://"), occurrences(html, "http://www.w3.org/2000/svg"));  // an XML namespace
  EXPECT_EQ(html.find("https://"), std::string::npos);
}

}  // namespace
}  // namespace relume
