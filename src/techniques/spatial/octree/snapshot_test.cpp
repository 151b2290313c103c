#include "techniques/spatial/octree/snapshot.h"

#include <gtest/gtest.h>

#include <sstream>

namespace relume {
namespace {

/// A structure that counts the frames whose samples it has received.
struct Counter {
  uint32_t frames = 0;
  Counter copy(Backend&) const { return *this; }
  size_t memory_bytes() const { return 100; }
  void save(std::ostream& out) const { write_value(out, frames); }
  void load(std::istream& in) { read_value(in, frames); }
};

TEST(Snapshot, AnEpochSamplesWithTheStateOfItsFirstFrame) {
  Backend backend(1);
  Snapshot<Counter> snapshot;
  Counter learning;
  const auto frame = [&](bool begins_epoch) {
    snapshot.begin_frame(backend, begins_epoch, learning);
    ++learning.frames;
    return snapshot.of(learning).frames;
  };
  EXPECT_EQ(frame(true), 1u);
  EXPECT_FALSE(snapshot.frozen());
  EXPECT_EQ(snapshot.memory_bytes(), 0u) << "an epoch of one frame needs no copy";
  EXPECT_EQ(frame(true), 2u);
  EXPECT_EQ(frame(false), 2u);
  EXPECT_EQ(frame(false), 2u);
  EXPECT_TRUE(snapshot.frozen());
  EXPECT_EQ(snapshot.memory_bytes(), 100u);
  EXPECT_EQ(frame(true), 5u);
}

TEST(Snapshot, ContinuesAfterACheckpoint) {
  Backend backend(1);
  Snapshot<Counter> snapshot;
  Counter learning{7};
  snapshot.begin_frame(backend, false, learning);
  std::stringstream file;
  snapshot.save(file);
  Snapshot<Counter> other;
  other.load(file, {});
  learning.frames = 9;
  EXPECT_EQ(other.of(learning).frames, 7u);
  std::stringstream empty;
  other.load(empty, {});
  EXPECT_FALSE(empty);
  EXPECT_FALSE(other.frozen());
}

}  // namespace
}  // namespace relume
