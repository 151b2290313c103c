#include "render/checkpoint.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <string>

#include "relume/error.h"

namespace relume {
namespace {

/// A checkpoint with one buffer and no passes.
class CheckpointTest : public ::testing::Test {
 protected:
  CheckpointTest() { buffers_.add({.id = kMean, .persistent = true}); }
  ~CheckpointTest() override { std::filesystem::remove(file_); }

  void write(const Counters& counters) { write_checkpoint(file_, {1, "settings", counters}, buffers_, pipeline_); }
  Counters read() { return read_checkpoint(file_, {1, "settings", {}}, buffers_, pipeline_); }

  const std::filesystem::path file_ =
      std::filesystem::path(::testing::TempDir()) / ("relume_counters_" + std::to_string(::getpid()) + ".ckpt");
  BufferTable buffers_{2, 2};
  Pipeline pipeline_;
};

TEST_F(CheckpointTest, RestoresTheCounters) {
  write({.frames = 7,
         .since_change = 3,
         .epoch = 2,
         .time_s = 1e6f,
         .previous_time_s = 0,
         .stretch_time_s = 3,
         .image_frames = 6,
         .sequence_age = 5,
         .paths = 4,
         .rays = 9,
         .image_paths = 1});
  const Counters counters = read();
  EXPECT_EQ(counters.frames, 7u);
  EXPECT_EQ(counters.since_change, 3u);
  EXPECT_EQ(counters.epoch, 2u);
  EXPECT_EQ(counters.time_s, 1e6f);
  EXPECT_EQ(counters.previous_time_s, 0.0f);
  EXPECT_EQ(counters.stretch_time_s, 3.0f);
  EXPECT_EQ(counters.image_frames, 6u);
  EXPECT_EQ(counters.sequence_age, 5u);
  EXPECT_EQ(counters.image_paths, 1u);
  EXPECT_EQ(counters.paths, 4u);
  EXPECT_EQ(counters.rays, 9u);
}

TEST_F(CheckpointTest, RejectsImpossibleTimes) {
  for (const float time_s : {std::nanf(""), std::numeric_limits<float>::infinity(), -1.0f, 2e6f}) {
    write({.time_s = time_s});
    EXPECT_THROW(read(), Error) << time_s;
    write({.previous_time_s = time_s});
    EXPECT_THROW(read(), Error) << time_s;
    write({.stretch_time_s = time_s});
    EXPECT_THROW(read(), Error) << time_s;
  }
}

TEST_F(CheckpointTest, RejectsMoreFramesSinceAChangeThanInTotal) {
  write({.frames = 2, .since_change = 3});
  EXPECT_THROW(read(), Error);
}

TEST_F(CheckpointTest, RejectsMoreFramesInTheImageThanInTotal) {
  write({.frames = 2, .image_frames = 3});
  EXPECT_THROW(read(), Error);
  write({.paths = 2, .image_paths = 3});
  EXPECT_THROW(read(), Error);
}

}  // namespace
}  // namespace relume
