#include "parts/sample_ranges.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(SampleRanges, ParseOneRange) {
  EXPECT_EQ(parse_sample_range("0-127"), (SampleRange{0, 127}));
  EXPECT_EQ(parse_sample_range("64-64"), (SampleRange{64, 64}));
  EXPECT_EQ(parse_sample_range("16-8388607"), (SampleRange{16, kLastSample}));
  for (const char* text :
       {"", "-", "0", "0-", "-1", "6-15", "32-16", "0-15 ", "0--15", "a-b", "0-8388608", "0-99999999999"})
    EXPECT_EQ(parse_sample_range(text), std::nullopt) << text;
}

TEST(SampleRanges, JoinAdjacentRangesInAnyOrder) {
  SampleRanges ranges(SampleRange{32, 47});
  ranges.add(SampleRanges(SampleRange{0, 15}));
  EXPECT_EQ(ranges.to_string(), "0-15,32-47");
  EXPECT_EQ(ranges.count(), 32u);
  EXPECT_EQ(ranges.missing(), 16u);
  ranges.add(SampleRanges(SampleRange{16, 31}));
  EXPECT_EQ(ranges.to_string(), "0-47");
  EXPECT_EQ(ranges.missing(), 0u);
}

TEST(SampleRanges, KnowOverlaps) {
  const SampleRanges ranges = *SampleRanges::parse("0-15,32-47");
  EXPECT_TRUE(ranges.overlaps(SampleRanges(SampleRange{32, 32})));
  EXPECT_TRUE(ranges.overlaps(SampleRanges(SampleRange{0, 127})));
  EXPECT_FALSE(ranges.overlaps(SampleRanges(SampleRange{16, 31})));
  EXPECT_FALSE(ranges.overlaps(SampleRanges()));
}

TEST(SampleRanges, ParseWhatTheyPrint) {
  for (const char* text : {"0-15", "16-19,32-47", "0-8388607"}) EXPECT_EQ(SampleRanges::parse(text)->to_string(), text);
  for (const char* text : {"", ",", "0-15,", "0-15,0-15", "0-31,16-47", "3-4"})
    EXPECT_FALSE(SampleRanges::parse(text)) << text;
}

}  // namespace
}  // namespace relume
