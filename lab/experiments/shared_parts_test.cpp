#include "experiments/shared_parts.h"

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "compare/testing/thread_ranks.h"
#include "experiments/output/results.h"
#include "relume/error.h"

namespace relume {
namespace {

/// Calls `run` with the contexts of two ranks at the same time.
template <typename Run>
void on_two_ranks(const ExperimentContext& context, const Run& run) {
  RankRoom room;
  ThreadRank first(room, true);
  ThreadRank second(room, false);
  const auto with = [&](SharedWork& rank) {
    ExperimentContext own = context;
    own.ranks = &rank;
    run(own);
  };
  std::thread thread([&] { with(second); });
  with(first);
  thread.join();
}

TEST(SharedParts, AllRanksGetAllResults) {
  const auto square = [](const ExperimentContext& own, int part) {
    EXPECT_EQ(own.ranks, nullptr) << "a part would wait for ranks that wait for it";
    return std::pair(std::string(3, static_cast<char>('a' + part)), std::vector<double>{1.0 * part * part});
  };
  const auto alone = deal_parts({}, "squares", 5, square);
  ASSERT_EQ(alone.size(), 5u);
  EXPECT_EQ(alone[4].first, "eee");
  EXPECT_EQ(alone[4].second, std::vector<double>{16.0});
  on_two_ranks({}, [&](const ExperimentContext& own) { EXPECT_EQ(deal_parts(own, "squares", 5, square), alone); });
}

TEST(SharedParts, TimesAreMeasuredOnTheFirstRank) {
  const std::thread::id first = std::this_thread::get_id();
  std::atomic<int> runs = 0;
  on_two_ranks({}, [&](const ExperimentContext& own) {
    const bool on_first = measure_on_first(own, "time", [&](const ExperimentContext&) {
      ++runs;
      return std::this_thread::get_id() == first;
    });
    EXPECT_TRUE(on_first);
  });
  EXPECT_EQ(runs, 1);
}

/// A first rank that shares `bytes` only.
struct FirstRank : SharedWork {
  int ranks() const override { return 2; }
  bool is_first() const override { return false; }
  std::optional<std::vector<std::string>> gather(const SharedTasks&, const std::stop_token&) override { return {}; }
  std::optional<std::string> share(std::string) override { return bytes; }

  std::optional<std::string> bytes;
};

TEST(SharedParts, AnotherStepIsAnError) {
  FirstRank first;
  ExperimentContext context;
  context.ranks = &first;
  const auto part = [](const ExperimentContext&, int) { return 1.0; };
  EXPECT_THROW(deal_parts(context, "stage", 2, part), ExperimentStopped) << "the first rank has ended";
  first.bytes = "another stage";
  EXPECT_THROW(deal_parts(context, "stage", 2, part), Error);
  first.bytes = "stage, 2 parts";
  EXPECT_THROW(deal_parts(context, "stage", 2, part), ExperimentStopped) << "the stage was stopped";
}

TEST(PartBytes, AreRejectedIfShortened) {
  Image image(2, 1);
  image.at(1, 0) = Rgb(1, 2, 3);
  using Part = std::pair<std::optional<Image>, std::vector<std::vector<std::string>>>;
  const std::string bytes = part_to_bytes(Part(image, {{"a", ""}, {}, {"bc"}}));
  const auto [same_image, texts] = part_from_bytes<Part>(bytes);
  ASSERT_TRUE(same_image);
  EXPECT_EQ(same_image->width, 2);
  EXPECT_EQ(same_image->pixels, image.pixels);
  EXPECT_EQ(texts, (std::vector<std::vector<std::string>>{{"a", ""}, {}, {"bc"}}));
  EXPECT_FALSE(part_from_bytes<std::optional<Image>>(part_to_bytes(std::optional<Image>())));
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(part_from_bytes<Part>(bytes.substr(0, size)), Error) << size;
}

/// Experiments without times, on two ranks and on one.
class ExperimentOnRanks : public ::testing::TestWithParam<const char*> {};

TEST_P(ExperimentOnRanks, HasTheSameResult) {
  const Experiment& experiment = require_experiment(GetParam());
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / (std::string("relume_experiment_on_ranks_") + GetParam());
  std::filesystem::remove_all(folder);
  ExperimentContext context;
  context.quick = true;
  const auto result = [&](const ExperimentContext& own) { return to_json(experiment, experiment.run(own), {}); };
  context.cache_folder = folder / "alone";
  const std::string alone = result(context);
  on_two_ranks(context, [&](ExperimentContext own) {
    own.cache_folder = folder / (own.ranks->is_first() ? "first" : "second");
    EXPECT_EQ(result(own), alone);
  });
  std::filesystem::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Some, ExperimentOnRanks, ::testing::Values("apg-depth"));
INSTANTIATE_TEST_SUITE_P(SlowOther, ExperimentOnRanks,
                         ::testing::Values("psf-variance", "readapt", "restir-bias", "restir-correlation"));

}  // namespace
}  // namespace relume
