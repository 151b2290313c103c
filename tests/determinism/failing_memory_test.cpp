// Tests sessions whose memory runs out at any allocation: they report it, stay usable and free their memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <new>
#include <stdexcept>
#include <stop_token>
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

/// Calls `action` while the allocation after `before` others fails, and `failures` − 1 after it. Returns whether one
/// failed, which `action` must report.
template <typename F>
bool fails_in(testing::FailingMemory& memory, int before, int failures, const F& action) {
  bool threw = false;
  memory.fail_after(before, failures);
  try {
    action();
  } catch (const std::bad_alloc&) {
    threw = true;
  }
  memory.recover();
  EXPECT_EQ(threw, memory.failed());
  return memory.failed();
}

void move(Session& session, int frame) { session.set_time(0.05f * static_cast<float>(frame)); }

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

/// The first frame with time 0 after a restart.
std::vector<uint32_t> bits_after_restart(Session& session, int seed) {
  session.set_time(0);
  session.restart(seed);
  session.render_frame();
  return bits_of(session);
}

/// Why these tests are skipped on a device.
constexpr const char* kOfTheHost = "memory of the host fails";

class FailingMemory : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (is_host_replaced()) GTEST_SKIP() << kOfTheHost;
  }
};
/// Tries every `stride`-th allocation of each frame.
void expect_sessions_stay_usable(std::string_view technique, int stride) {
  const RenderSettings settings = settings_of(technique);
  testing::FailingMemory memory;
  Session whole(build("turntable"), settings);
  const std::vector<uint32_t> restarted = bits_after_restart(whole, settings.seed);
  for (int frame = 0; frame < kFrames; ++frame) {
    bool fails = true;
    for (int before = 0; fails; before += stride) {
      SCOPED_TRACE(::testing::Message() << "frame " << frame << ", allocation " << before);
      Session session = make_session(build("turntable"), settings, memory);
      for (int i = 0; i < frame; ++i) {
        move(session, i);
        session.render_frame();
      }
      move(session, frame);
      fails = fails_in(memory, before, 1, [&] { session.render_frame(); });
      expect_usable(session);
      EXPECT_EQ(bits_after_restart(session, settings.seed), restarted);
    }
    EXPECT_EQ(memory.blocks(), 0) << "leaked";
  }
}
TEST_P(FailingMemory, LeavesSessionsUsable) { expect_sessions_stay_usable(GetParam(), 3); }
class SlowFailingMemory : public FailingMemory {};
TEST_P(SlowFailingMemory, LeavesSessionsUsable) { expect_sessions_stay_usable(GetParam(), 1); }

std::string technique_name(const ::testing::TestParamInfo<const char*>& instance) { return instance.param; }

// Sessions with many structures that grow.
const auto kTechniques = ::testing::Values("vlc_cdq_combination", "apsf_apg", "reproject", "svgf", "static_lists");
INSTANTIATE_TEST_SUITE_P(Some, FailingMemory, kTechniques, technique_name);
INSTANTIATE_TEST_SUITE_P(Some, SlowFailingMemory, kTechniques, technique_name);

/// Expects the same state after a failed frame as after a stopped frame whose histories have all ended. Fails every
/// `stride`-th allocation of a frame, in each frame with another offset.
void expect_failures_equal_stops(std::string_view technique, int stride) {
  const RenderSettings settings = settings_of(technique);
  RenderSettings other = settings;
  other.path.max_bounces -= 1;
  testing::FailingMemory memory;
  for (int frame = 1; frame < kFrames; ++frame) {
    const auto begin = [&](Session& session) {
      for (int i = 0; i < frame; ++i) {
        move(session, i);
        session.render_frame();
      }
      move(session, frame);
    };
    Session stopped(build("turntable"), settings);
    begin(stopped);
    std::stop_source stop;
    stop.request_stop();
    ASSERT_FALSE(stopped.render_frame(stop.get_token()));
    ASSERT_TRUE(stopped.set_settings(other));
    ASSERT_TRUE(stopped.set_settings(settings));
    expect_usable(stopped);
    for (int before = (frame - 1) % stride;; before += stride) {
      SCOPED_TRACE(::testing::Message() << "frame " << frame << ", allocation " << before);
      Session session = make_session(build("turntable"), settings, memory);
      begin(session);
      if (!fails_in(memory, before, 1, [&] { session.render_frame(); })) break;
      expect_usable(session);
      EXPECT_EQ(bits_of(session), bits_of(stopped));
    }
  }
}

class FailedFrame : public FailingMemory {};
TEST_P(FailedFrame, EqualsAStopAndAChangeOfSettings) { expect_failures_equal_stops(GetParam(), 3); }
class SlowFailedFrame : public FailingMemory {};
TEST_P(SlowFailedFrame, EqualsAStopAndAChangeOfSettings) { expect_failures_equal_stops(GetParam(), 1); }

INSTANTIATE_TEST_SUITE_P(Some, FailedFrame, kTechniques, technique_name);
INSTANTIATE_TEST_SUITE_P(Some, SlowFailedFrame, kTechniques, technique_name);

/// A call between frames.
struct Call {
  const char* name;
  std::function<void(Session&)> run;
};

// Every seventh allocation; buffers of pixels are tried twice before a failure.
TEST(FailingMemory, LeavesSessionsUsableBetweenFrames) {
  if (is_host_replaced()) GTEST_SKIP() << kOfTheHost;
  constexpr int kStride = 7;
  for (const char* technique : {"vlc_cdq_combination", "svgf"}) {
    const RenderSettings settings = settings_of(technique);
    RenderSettings resized = settings;
    resized.width += 5;
    RenderSettings plain = small_settings(24, 14);
    plain.accel = settings.accel;
    const std::filesystem::path file = checkpoint_file(std::string("failing_") + technique);
    {
      Session saved(build("turntable"), settings);
      move(saved, 3);
      saved.render_frame();
      saved.save_checkpoint(file);
    }
    const Call calls[] = {
        {"set_time", [](Session& session) { session.set_time(0.4f); }},
        {"set_transform",
         [](Session& session) {
           const Index moving = build("turntable").animation.front().node;
           session.set_transform(moving, {.translation = Vec3(0, 0.1f, 0)});
         }},
        {"set_environment",
         [](Session& session) {
           Environment light;
           light.kind = EnvironmentKind::constant;
           session.set_environment(light);
         }},
        {"add_node, render_frame",
         [](Session& session) {
           const MeshHandle mesh = session.add_mesh(build("turntable").meshes.front());
           Node node;
           node.meshes = {mesh.index};
           session.add_node(node);
           session.render_frame();
         }},
        {"set_settings of another size", [&](Session& session) { session.set_settings(resized); }},
        {"set_settings of another technique", [&](Session& session) { session.set_settings(plain); }},
        {"load_checkpoint", [&](Session& session) { session.load_checkpoint(file); }},
    };
    testing::FailingMemory memory;
    for (const Call& call : calls) {
      bool fails = true;
      for (int before = 0; fails; before += kStride) {
        SCOPED_TRACE(::testing::Message() << technique << ", " << call.name << ", allocation " << before);
        Session session = make_session(build("turntable"), settings, memory);
        move(session, 1);
        session.render_frame();
        fails = fails_in(memory, before, 2, [&] { call.run(session); });
        EXPECT_TRUE(session.render_frame());
        EXPECT_GT(mean_luminance(session.image()), 0.0) << "an empty scene";
        expect_usable(session);
      }
      EXPECT_EQ(memory.blocks(), 0) << "leaked";
    }
    std::filesystem::remove(file);
  }
}

TEST(FailingMemory, SettingsChangeTogetherOrNotAtAll) {
  if (is_host_replaced()) GTEST_SKIP() << kOfTheHost;
  RenderSettings settings = settings_of("svgf");
  RenderSettings other = settings;
  other.width += 5;
  other.time_s = 0.4f;
  Session whole(build("turntable"), settings);
  ASSERT_TRUE(whole.set_settings(other));
  const std::vector<uint32_t> expected = bits_after_restart(whole, other.seed);
  testing::FailingMemory memory;
  bool fails = true;
  for (int before = 0; fails; ++before) {
    SCOPED_TRACE(before);
    Session session = make_session(build("turntable"), settings, memory);
    session.render_frame();
    fails = fails_in(memory, before, 2, [&] { session.set_settings(other); });
    if (!fails) break;
    RenderSettings kept = render_settings(session);
    EXPECT_TRUE(differing_settings(describe(settings), describe(kept)).empty());
    EXPECT_TRUE(session.render_frame());
    EXPECT_TRUE(session.set_settings(other));
    EXPECT_EQ(bits_after_restart(session, other.seed), expected);
  }
}

TEST(FailingMemory, EndsConstructionWithoutLeaks) {
  if (is_host_replaced()) GTEST_SKIP() << kOfTheHost;
  const RenderSettings settings = small_settings(24, 14);
  testing::FailingMemory memory;
  bool fails = true;
  for (int before = 0; fails; ++before) {
    // Two failures: buffers of pixels are tried twice.
    fails = fails_in(memory, before, 2, [&] { make_session(build("turntable"), settings, memory); });
    EXPECT_EQ(memory.blocks(), 0) << before;
  }
}

}  // namespace
}  // namespace relume::support
