#include "cli/progress.h"

#include <gtest/gtest.h>

#include <limits>

namespace relume::cli {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ProgressText, Durations) {
  EXPECT_EQ(format_duration(0), "0:00");
  EXPECT_EQ(format_duration(59.6), "1:00");
  EXPECT_EQ(format_duration(754), "12:34");
  EXPECT_EQ(format_duration(3723), "1:02:03");
  EXPECT_EQ(format_duration(-3), "0:00");
}

TEST(ProgressText, ShowsKnownQuantities) {
  EXPECT_EQ(format_progress({.label = "image 3 of 10",
                             .samples = 16,
                             .samples_wanted = 64,
                             .rays_per_s = 12.34e6,
                             .error = 0.0312,
                             .remaining_s = 42}),
            "image 3 of 10, 16/64 samples, 12.3 Mrays/s, error 0.031, 0:42 left");
  EXPECT_EQ(format_progress({.label = "", .samples = 16, .error = kInf, .remaining_s = kInf}), "16 samples");
}

TEST(ProgressText, BarFillsAndFitsTheTerminal) {
  const Progress half{.label = "", .samples = 1, .fraction = 0.5, .remaining_s = kInf};
  EXPECT_EQ(format_progress_bar(half, 80), "[############            ] 1 samples");
  EXPECT_EQ(format_progress_bar(half, 10), "[#########");
  const Progress beyond{.label = "", .samples = 1, .fraction = 7, .remaining_s = kInf};
  EXPECT_EQ(format_progress_bar(beyond, 26), "[########################]");
}

}  // namespace
}  // namespace relume::cli
