#include "cli/frame_sequence.h"

#include <gtest/gtest.h>

#include "cli/command.h"

namespace relume::cli {
namespace {

TEST(FrameRange, ReadsRanges) {
  EXPECT_EQ(parse_frame_range("0-99", "--frames").count(), 100);
  EXPECT_EQ(parse_frame_range("5..7", "--frames").last, 7);
  const FrameRange single = parse_frame_range("12", "--frames");
  EXPECT_EQ(single.first, 12);
  EXPECT_EQ(single.last, 12);
}

TEST(FrameRange, RejectsOtherText) {
  for (const char* text :
       {"", "-", "1-", "-1", "a-b", "1-2-3", "9-3", "1 - 2", "0-99999999999", "0-2000000000", "1.5-3"}) {
    EXPECT_THROW(parse_frame_range(text, "--frames"), UsageError) << text;
  }
}

TEST(FrameRange, FrameTimesStayInRange) {
  EXPECT_EQ(frame_time_s(0, 24, 0.5f), 0.5f);
  EXPECT_EQ(frame_time_s(12, 24, 0.5f), 1);
  EXPECT_EQ(frame_time_s(1000000, 1, 0), 1e6f);
  EXPECT_THROW(frame_time_s(1000001, 1, 0), UsageError);
  EXPECT_THROW(frame_time_s(24, 24, 1e6f), UsageError);
}

TEST(FrameNames, InsertTheNumber) {
  EXPECT_EQ(FrameNames("out.exr")(7), "out.0007.exr");
  EXPECT_EQ(FrameNames("a.b/out.v2.exr")(12345), "a.b/out.v2.12345.exr");
  EXPECT_EQ(FrameNames("dir/####.png")(7), "dir/0007.png");
  EXPECT_EQ(FrameNames("x_##_y.png")(123), "x_123_y.png");
  EXPECT_EQ(FrameNames("x%d.png")(7), "x7.png");
  EXPECT_EQ(FrameNames("x%04d_a.png")(7), "x0007_a.png");
  EXPECT_EQ(FrameNames("#1/x#.png")(7), "#1/x7.png") << "folders are taken literally";
}

TEST(FrameNames, RejectUnsafePrintfPatterns) {
  for (const char* pattern :
       {"%s.png", "%.png", "%04x.png", "%-4d.png", "%99999999999d.png", "%n%d.png", "%d%d.png", "#_#.png"}) {
    EXPECT_THROW(FrameNames{pattern}, UsageError) << pattern;
  }
}

}  // namespace
}  // namespace relume::cli
