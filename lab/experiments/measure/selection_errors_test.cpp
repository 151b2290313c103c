#include "experiments/measure/selection_errors.h"

#include <utility>

#include <gtest/gtest.h>

namespace relume {
namespace {

/// A scene in which the tree has `factor` times the cache's error, and lists three times.
SelectionErrors scene_with(double factor) {
  SelectionErrors scene{"base", 0, {}, {}};
  for (const auto& [name, mse] : {std::pair{"tree", factor}, std::pair{"lists", 3.0}, std::pair{"cache", 1.0}}) {
    AdaptedError error;
    error.name = name;
    error.mse = {{0.9 * mse, 1.1 * mse}};
    error.frame_s = {1, 1};
    scene.errors.push_back(std::move(error));
  }
  return scene;
}

TEST(SelectionErrors, GainsAreGeometricMeansOverTheScenes) {
  const Ratio ratio = mean_gain({scene_with(2), scene_with(8)}, "tree", "cache");
  EXPECT_NEAR(ratio.value, 4, 1e-9);
  EXPECT_LT(ratio.interval.low, 2);  // of two scenes
  EXPECT_GT(ratio.interval.high, 8);
  EXPECT_NEAR(mean_gain({scene_with(2), scene_with(8)}, "cache", "lists").value, 1.0 / 3, 1e-9);
}

TEST(SelectionErrors, BasesHaveARowForEachContender) {
  const TableBlock table = bases_table({scene_with(2), scene_with(8)}, "tree", "lists");
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[2].name, "cache");
  EXPECT_NEAR(table.rows[2].cells[0].value.value(), 4, 1e-9);
  EXPECT_EQ(table.rows[2].cells[1].text, "2.00 to 8.00");
  EXPECT_NEAR(table.rows[2].cells[2].value.value(), 3, 1e-9);
}

TEST(SelectionErrors, RoomsHaveARowForEachKind) {
  const TableBlock table = rooms_table(
      {{"strips", {scene_with(2), scene_with(8)}}, {"skylight", {scene_with(1), scene_with(1), scene_with(1)}}},
      "tree");
  ASSERT_EQ(table.columns.size(), 2u);
  EXPECT_EQ(table.columns[1].title, "cache");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].name, "strips (2)");
  EXPECT_EQ(table.rows[1].name, "skylight (3)");
  EXPECT_NEAR(table.rows[0].cells[1].value.value(), 4, 1e-9);
  EXPECT_NEAR(table.rows[1].cells[1].value.value(), 1, 1e-9);
}

}  // namespace
}  // namespace relume
