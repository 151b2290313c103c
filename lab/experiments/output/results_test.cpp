#include "experiments/output/results.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "relume/error.h"

namespace relume {
namespace {

TEST(Results, AreJsonAndAPage) {
  ExperimentResult result;
  result.claims = {judged("a", "[X §1]", "holds here", "1", "below 2", true),
                   judged("b", "[X §1]", "fails", "3", "below 2", false),
                   unmeasured("c", "[X §1]", "unknown", "below 2", "no scene")};
  result.blocks = {ChartBlock{"t", "", {{"l", "x", "y", true, true, {{"curve", 0, false, {{1, 2}}}}}}},
                   TableBlock{"times", "", "who", {{"ms"}}, {{"we", 0, {{"3", 3, "of two"}}}}},
                   BarBlock{"parts", "", "ms", {{"we", {{"first", 1}, {"second", 2}}}}}};
  const Experiment& experiment = experiments().front();
  const auto json =
      nlohmann::json::parse(to_json(experiment, result, {{{"Processor", "p"}}, true, 3, false, "a build", "cuda"}));
  ASSERT_EQ(json["claims"].size(), 3u);
  for (const char* key : {"id", "paper", "claim", "measured", "threshold", "verdict"})
    EXPECT_TRUE(json["claims"][0].contains(key)) << key;
  EXPECT_EQ(json["claims"][0]["verdict"], "holds");
  EXPECT_EQ(json["claims"][1]["verdict"], "does not hold");
  EXPECT_EQ(json["claims"][2]["verdict"], "not measured");
  EXPECT_EQ(json["curves"][0]["points"][0], nlohmann::json({1.0, 2.0}));
  using Json = nlohmann::json;
  EXPECT_EQ(json["tables"][0],
            (Json{{"title", "times"}, {"columns", {"who", "ms"}}, {"rows", Json::array({{"we", "3 (of two)"}})}}));
  EXPECT_EQ(json["tables"][1]["rows"], (Json{{"we", "first", "1"}, {"we", "second", "2"}}));
  const ExperimentSummary summary = read_summary(json.dump(), "a.json");
  EXPECT_FALSE(summary.run.scenes);
  EXPECT_EQ(summary.run.program, "a build");
  EXPECT_EQ(summary.run.device, "cuda");
  EXPECT_NE(index_markdown({summary}).find("; Device: cuda."), std::string::npos);
  ExperimentSummary named = summary;
  named.run.machine.emplace_back("Device", "a GPU");
  EXPECT_NE(index_markdown({named}).find("; Device: a GPU."), std::string::npos);
  EXPECT_EQ(index_markdown({named}).find("Device: cuda"), std::string::npos) << "the machine names the device";
  const Page page = experiment_page(experiment, result, {{}, false, 3});
  EXPECT_TRUE(std::holds_alternative<TextBlock>(page.blocks[0]));
  EXPECT_EQ(std::get<TextBlock>(page.blocks[0]).text, "1 of 3 claims hold, 1 not measured.");
  EXPECT_TRUE(std::holds_alternative<ClaimBlock>(page.blocks[1]));
}

TEST(Results, TheIndexIsMadeFromFiles) {
  const Experiment& experiment = experiments().front();
  const std::string json =
      to_json(experiment, {{judged("a", "[X §1]", "holds here | there", "1", "below 2", true)}, {}, {}},
              {{{"Processor", "p"}}, true, 3});
  const ExperimentSummary summary = read_summary(json, "a.json");
  EXPECT_EQ(summary.name, experiment.name);
  EXPECT_TRUE(summary.run.quick);
  EXPECT_EQ(summary.run.seconds, 3);
  EXPECT_EQ(summary.run.device, "cpu");
  EXPECT_EQ(index_markdown({summary}).find("Device"), std::string::npos);
  ASSERT_EQ(summary.claims.size(), 1u);
  EXPECT_EQ(summary.claims[0].verdict, kVerdictHolds);
  const std::string index = to_html(index_page({summary}));
  EXPECT_NE(index.find(std::string(experiment.name) + ".html"), std::string::npos);
  EXPECT_NE(index.find("1 of 1 claims hold"), std::string::npos);
  const std::string markdown = index_markdown({summary});
  EXPECT_NE(markdown.find("| [X §1] | holds here \\| there | 1 | below 2 | holds |"), std::string::npos) << markdown;
  EXPECT_THROW(read_summary("{}", "a.json"), Error);
  EXPECT_THROW(read_summary("", "a.json"), Error);
}

}  // namespace
}  // namespace relume
