#include "sampling/sample_schedule.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "sampling/sampler.h"

namespace relume {
namespace {

std::vector<uint32_t> starts(uint32_t longest, uint32_t frames) {
  std::set<uint32_t> result;
  for (uint32_t frame = 0; frame < frames; ++frame) result.insert(epoch_start(frame, longest));
  return {result.begin(), result.end()};
}

TEST(SampleSchedule, EpochsDoubleUpToTheLongest) {
  EXPECT_EQ(starts(1, 5), (std::vector<uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(starts(1024, 32), (std::vector<uint32_t>{0, 1, 3, 7, 15, 31}));
  EXPECT_EQ(starts(8, 32), (std::vector<uint32_t>{0, 1, 3, 7, 15, 23, 31}));
  EXPECT_EQ(starts(15, 32), starts(8, 32)) << "lengths are powers of two";
}

TEST(SampleSchedule, OneSequenceServesAllFramesWhereNothingLearns) {
  const SampleSchedule schedule;
  for (const uint32_t frame : {0u, 1u, 100u}) {
    EXPECT_EQ(schedule.sample(frame, frame), frame);
    EXPECT_EQ(schedule.sequence(frame, frame, frame + 7), Sampler::kFirstSequence);
  }
  // A history that survives a change continues its sequence.
  EXPECT_EQ(schedule.sample(20, 3), 20u);
}

TEST(SampleSchedule, EachEpochTakesASequenceOfItsOwnFromItsStart) {
  const SampleSchedule schedule{.longest_epoch = 16};
  std::set<std::pair<uint32_t, uint32_t>> taken;
  for (uint32_t frame = 0; frame < 100; ++frame) {
    const uint32_t sample = schedule.sample(frame, frame);
    const uint32_t sequence = schedule.sequence(frame, frame, frame + 5);
    EXPECT_EQ(schedule.begins_epoch(frame), sample == 0) << frame;
    EXPECT_NE(sequence, Sampler::kFirstSequence);
    EXPECT_TRUE(taken.insert({sequence, sample}).second) << "frame " << frame << " repeats numbers";
    if (sample > 0) {
      EXPECT_EQ(sequence, schedule.sequence(frame - 1, frame - 1, frame + 4)) << frame;
    }
  }
}

TEST(SampleSchedule, APilotEndsTheSequence) {
  const SampleSchedule schedule{.pilot = 32};
  EXPECT_EQ(schedule.sample(31, 31), 31u);
  EXPECT_EQ(schedule.sequence(31, 31, 40), Sampler::kFirstSequence);
  EXPECT_EQ(schedule.sample(32, 32), 0u);
  EXPECT_EQ(schedule.sample(40, 40), 8u);
  EXPECT_EQ(schedule.sequence(32, 32, 41), schedule.sequence(40, 40, 49));
  EXPECT_NE(schedule.sequence(32, 32, 41), Sampler::kFirstSequence);
}

}  // namespace
}  // namespace relume
