// Tests sessions whose memory runs out at any allocation: they report it, stay usable and free their memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "determinism/same_bits.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/technique_checks.h"
#include "testing/failing_memory.h"

namespace relume::support {
namespace {

constexpr int kFrames = 4;

RenderSettings settings_of(std::string_view name) {
  RenderSettings s = small_settings(24, 14);
  s.auxiliary = true;
  s.accel = AccelChoice::bvh;
  s.octree = {.collapse = 32, .split = 64, .scale = false};
  const std::vector<DeterminismCheck>& all = technique_checks().determinism;
  const auto technique = std::find_if(all.begin(), all.end(), [&](const auto& t) { return t.name == name; });
  if (technique == all.end()) throw std::invalid_argument("no technique " + std::string(name));
  settings_from_json(describe(s), technique->json, technique->name);
  return s;
}

/// Moves the scene, then renders a frame in which the allocation after `before` others fails. Returns false if the
/// frame has no more allocations.
bool fail_in_frame(Session& session, testing::FailingMemory& memory, int frame, int before) {
  session.set_time(0.05f * static_cast<float>(frame));
  memory.fail_after(before);
  try {
    session.render_frame();
  } catch (const std::bad_alloc&) {
    EXPECT_TRUE(memory.failed());
  }
  memory.recover();
  return memory.failed();
}

void expect_usable(Session& session) {
  for (int frame = 0; frame < kFrames; ++frame) {
    session.set_time(0.03f * static_cast<float>(frame));
    ASSERT_TRUE(session.render_frame());
  }
  session.statistics();
  for (const RecordTable& table : session.record_tables()) session.records(table.name);
  const Image image = session.image();
  EXPECT_TRUE(std::all_of(image.pixels.begin(), image.pixels.end(), [](const Rgb& p) { return is_finite(p); }));
  EXPECT_GT(mean_luminance(image), 0.0);
}

class FailingMemory : public ::testing::TestWithParam<const char*> {};
TEST_P(FailingMemory, LeavesSessionsUsable) {
  const RenderSettings settings = settings_of(GetParam());
  testing::FailingMemory memory;
  Session whole(build("turntable"), settings);
  for (int frame = 0; frame < kFrames; ++frame) {
    bool fails = true;
    for (int before = 0; fails; ++before) {
      SCOPED_TRACE(::testing::Message() << "frame " << frame << ", allocation " << before);
      Session session = make_session(build("turntable"), settings, memory);
      for (int i = 0; i < frame; ++i) ASSERT_FALSE(fail_in_frame(session, memory, i, 1 << 30));
      fails = fail_in_frame(session, memory, frame, before);
      expect_usable(session);
      if (before > 0) continue;
      // The first failure of each frame: the same bits as if nothing had failed.
      session.set_time(0);
      session.restart(settings.seed);
      whole.set_time(0);
      whole.restart(settings.seed);
      session.render_frame();
      whole.render_frame();
      EXPECT_EQ(bits_of(session), bits_of(whole));
    }
    EXPECT_EQ(memory.blocks(), 0) << "leaked";
  }
}
// Sessions with many structures that grow.
INSTANTIATE_TEST_SUITE_P(Some, FailingMemory,
                         ::testing::Values("vlc_cdq_combination", "apsf_apg", "reproject", "svgf", "static_lists"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(FailingMemory, EndsConstructionWithoutLeaks) {
  const RenderSettings settings = small_settings(24, 14);
  testing::FailingMemory memory;
  bool fails = true;
  for (int before = 0; fails; ++before) {
    memory.fail_after(before);
    try {
      const Session session = make_session(build("turntable"), settings, memory);
    } catch (const std::bad_alloc&) {
      EXPECT_TRUE(memory.failed());
    }
    fails = memory.failed();
    EXPECT_EQ(memory.blocks(), 0) << before;
  }
}

}  // namespace
}  // namespace relume::support
