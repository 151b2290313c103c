// Two threads as ranks that share a comparison: all values but times equal those of one process.
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builtin.h"
#include "compare/comparison.h"
#include "compare/shared_results.h"
#include "compare/testing/thread_ranks.h"
#include "relume/error.h"

namespace relume {
namespace {

using nlohmann::json;

/// One microsecond per ray, independent of machine and load.
double ray_clock(const Session& session) { return 1e-6 * static_cast<double>(session.statistics().rays); }

class SharedComparisonTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::temp_directory_path() / ("relume_shared_comparison_" + name);
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static ComparisonOptions options(const char* techniques) {
    ComparisonOptions o;
    o.scene_name = "test";
    o.contenders = parse_contenders(techniques, "test");
    o.common.flags = {{"width", "24"}, {"height", "18"}, {"max-bounces", "2"}, {"threads", "1"}};
    o.reference_spp = 8;
    o.repetitions = 3;
    o.spp = 4;
    o.clock = ray_clock;
    return o;
  }

  std::optional<Comparison> run(const Scene& scene, ComparisonOptions o, const std::string& folder,
                                SharedWork* shared) const {
    o.cache_folder = folder_ / folder;
    return compare(scene, o, {}, {}, shared);
  }

  Comparison run_on_two(const Scene& scene, const ComparisonOptions& o) const {
    RankRoom room;
    ThreadRank first(room, true);
    ThreadRank second(room, false);
    std::optional<Comparison> other;
    std::thread thread([&] { other = run(scene, o, "second", &second); });
    std::optional<Comparison> comparison = run(scene, o, "first", &first);
    thread.join();
    EXPECT_TRUE(comparison);
    EXPECT_EQ(other.has_value(), o.on_all_ranks);
    if (other) {
      EXPECT_EQ(to_json(*other, {}), to_json(*comparison, {}));
      EXPECT_EQ(other->reference.image.pixels, comparison->reference.image.pixels);
      EXPECT_EQ(other->contenders.back().image.pixels, comparison->contenders.back().image.pixels);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "second")) << "a checkpoint remains";
    return std::move(comparison.value());
  }

  /// The results without the times of passes, which the clock of rays does not count.
  static json values_of(const Comparison& comparison) {
    json values = json::parse(to_json(comparison, {}));
    values.erase("machine");
    values.erase("notes");
    for (json& contender : values["contenders"]) contender.erase("passes");
    return values;
  }

  void expect_equal(const Scene& scene, const ComparisonOptions& o) const {
    const std::optional<Comparison> one = run(scene, o, "one", nullptr);
    ASSERT_TRUE(one);
    const Comparison two = run_on_two(scene, o);
    EXPECT_EQ(values_of(two), values_of(*one));
    ASSERT_EQ(two.contenders.size(), one->contenders.size());
    for (size_t i = 0; i < two.contenders.size(); ++i)
      EXPECT_EQ(two.contenders[i].image.pixels, one->contenders[i].image.pixels);
    EXPECT_EQ(two.ranks, 2);
    EXPECT_EQ(two.threads, 1);
  }

  std::filesystem::path folder_;
};

TEST_F(SharedComparisonTest, EqualSamples) {
  expect_equal(find_builtin_scene("cornell")->build(), options("few=max-bounces:1,all=seed:7"));
}

TEST_F(SharedComparisonTest, OnAllRanks) {
  ComparisonOptions o = options("few=max-bounces:1,all=seed:7");
  o.on_all_ranks = true;
  expect_equal(find_builtin_scene("cornell")->build(), o);
}

TEST_F(SharedComparisonTest, TimedAtEqualSamples) {
  ComparisonOptions o = options("few=max-bounces:1,all=seed:7");
  o.timed = true;
  expect_equal(find_builtin_scene("cornell")->build(), o);
  for (const std::string& note : run_on_two(find_builtin_scene("cornell")->build(), o).notes)
    EXPECT_EQ(note.find("parallel load"), std::string::npos) << note;
}

TEST_F(SharedComparisonTest, EqualTime) {
  ComparisonOptions o = options("few=max-bounces:1,all=seed:7");
  o.budget_s = 0.02;
  expect_equal(find_builtin_scene("cornell")->build(), o);
}

TEST_F(SharedComparisonTest, Animation) {
  ComparisonOptions o = options("none=history:none,old=history:reproject");
  o.times_s = {0, 0.1f, 0.2f};
  o.spp = 1;
  o.repetitions = 2;
  expect_equal(find_builtin_scene("turntable")->build(), o);
}

TEST_F(SharedComparisonTest, TimesUnderParallelLoadAreNoted) {
  const Comparison two = run_on_two(find_builtin_scene("cornell")->build(), options("few=max-bounces:1"));
  ASSERT_FALSE(two.notes.empty());
  EXPECT_NE(two.notes.front().find("under parallel load"), std::string::npos);
  EXPECT_EQ(json::parse(to_json(two, {}))["machine"]["ranks"], 2);
}

/// A first rank that shares `bytes` only.
struct OtherRank : SharedWork {
  int ranks() const override { return 2; }
  bool is_first() const override { return false; }
  std::optional<std::vector<std::string>> gather(const SharedTasks&, const std::stop_token&) override { return {}; }
  std::optional<std::string> share(std::string) override { return bytes; }

  std::optional<std::string> bytes;
};

TEST_F(SharedComparisonTest, AnotherSceneIsAnError) {
  const Scene scene = find_builtin_scene("cornell")->build();
  OtherRank other;
  EXPECT_FALSE(run(scene, options("default"), "one", &other)) << "the first rank has ended";
  other.bytes = "another scene";
  EXPECT_THROW(run(scene, options("default"), "one", &other), Error);
}

TEST(SharedResults, RejectShortenedBytes) {
  RunResult result{.threads = 2, .repetitions = {{.seed = 3, .frames = 1}}, .images = {Image(2, 1)}};
  result.repetitions[0].passes.push_back({"trace", 0.5, 0.1});
  result.repetitions[0].curve.push_back({.frames = 1, .mse = 0.25});
  const std::string bytes = to_bytes(result);
  const RunResult same = run_result_from(bytes);
  EXPECT_EQ(same.repetitions[0].seed, 3);
  EXPECT_EQ(same.repetitions[0].passes[0].name, "trace");
  EXPECT_EQ(same.repetitions[0].curve[0].mse, 0.25);
  EXPECT_EQ(same.images[0].width, 2);
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(run_result_from(bytes.substr(0, size)), Error) << size;
}

}  // namespace
}  // namespace relume
