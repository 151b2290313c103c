// Tests techniques with state between frames in a fully animated scene: equal bits with any number of threads and after
// a resume. Covers all choices of all slots.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <stop_token>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "determinism/moving_frames.h"
#include "determinism/same_bits.h"
#include "materials/ltc.h"
#include "sampling/blue_noise.h"
#include "scene/testing/figure.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/technique_checks.h"
#include "support/watch_accesses.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "testing/walled_memory.h"

namespace relume::support {
namespace {

// Small regions, which small images can fill.
RenderSettings settings_of(const DeterminismCheck& technique, int threads) {
  RenderSettings s = small_settings(61, 33);
  s.threads = threads;
  s.auxiliary = true;
  s.octree = {.collapse = 32, .split = 64, .scale = false};
  settings_from_json(describe(s), technique.json, technique.name);
  return s;
}

/// Why tests that watch accesses are skipped on a device.
constexpr const char* kWatchedOnTheHost = "DeviceBits watches accesses of sessions on the emulated device";

/// In a frame, host code may open blocks of a few numbers only.
void limit_host_access(testing::WalledMemory& memory) {
  const size_t directions = size_t{ltc_table().entries.size} * sizeof(LtcMatrix);
  const size_t blue_noise = size_t{blue_noise_tile().size} * sizeof(uint16_t);
  // Exceptions: counters of the hash grid, and tables that are copied once.
  memory.limit_host_access(64, {sizeof(HashGridTally), directions, blue_noise});
}

/// A technique with the length of its sequence and the size of its images.
struct TechniqueCase : DeterminismCheck {
  int frames = 0;
  int width = 0;
  int height = 0;
};

/// Hashes of the frames of a sequence, and the tiles that the passes of each launched.
struct Sequence {
  std::vector<uint64_t> frames;
  std::vector<size_t> tiles;
};

class TechniqueDeterminism : public ::testing::TestWithParam<TechniqueCase> {
 protected:
  static int frames() { return GetParam().frames; }
  static RenderSettings settings(int threads) {
    RenderSettings s = settings_of(GetParam(), threads);
    s.width = GetParam().width;
    s.height = GetParam().height;
    return s;
  }
  static Session session(int threads) { return Session(build("turntable"), settings(threads)); }
  /// Renders frames [first, last) of the sequence.
  static void render(Session& session, int first, int last) {
    const int of_an_image = GetParam().frames_of_an_image;
    for (int frame = first; frame < last; ++frame) {
      if (frame % of_an_image == 0) session.set_time(0.05f * static_cast<float>(frame / of_an_image));
      session.render_frame();
    }
  }
  /// The same with limited access of host code to `memory` between the launches of a frame.
  static void render(Session& session, int first, int last, testing::WalledMemory& memory) {
    const int of_an_image = GetParam().frames_of_an_image;
    for (int frame = first; frame < last; ++frame) {
      if (frame % of_an_image == 0) session.set_time(0.05f * static_cast<float>(frame / of_an_image));
      limit_host_access(memory);
      session.render_frame();
      memory.permit_host_access();
    }
  }
  /// Renders a frame and counts the tiles launched by its passes.
  static size_t count_tiles(Session& session, int frame) {
    std::atomic<size_t> tiles = 0;
    on_tile(session, [&] { ++tiles; });
    render(session, frame, frame + 1);
    on_tile(session, {});
    return tiles;
  }
  /// The whole sequence with one thread, rendered once per process.
  static const Sequence& of_one_thread() {
    static std::map<std::pair<std::string, int>, Sequence> known;
    const std::pair key(GetParam().name, frames());
    if (const auto found = known.find(key); found != known.end()) return found->second;
    Sequence sequence;
    Session rendered = session(1);
    for (int frame = 0; frame < frames(); ++frame) {
      sequence.tiles.push_back(count_tiles(rendered, frame));
      sequence.frames.push_back(frame_hash(rendered));
    }
    return known.emplace(key, std::move(sequence)).first->second;
  }
  /// Starts a frame and requests a stop after `tiles` tiles have started. Returns whether the frame was stopped rather
  /// than completed.
  static bool abandon_at_tile(Session& session, size_t tiles) {
    std::stop_source stop;
    std::atomic<size_t> begun = 0;
    on_tile(session, [&] {
      if (begun++ == tiles) stop.request_stop();
    });
    const bool complete = session.render_frame(stop.get_token());
    on_tile(session, {});
    return !complete;
  }
  /// Same, after the pass with this number.
  static bool abandon_after_pass(Session& session, size_t pass) {
    std::stop_source stop;
    size_t done = 0;
    session.on_pass([&](const std::string&) {
      if (done++ == pass) stop.request_stop();
    });
    const bool complete = session.render_frame(stop.get_token());
    session.on_pass({});
    return !complete;
  }
};

/// Compares five threads with one; the tests below compare two with one.
TEST_P(TechniqueDeterminism, AnyNumberOfThreads) {
  Session rendered = session(5);
  render(rendered, 0, frames());
  EXPECT_EQ(frame_hash(rendered), of_one_thread().frames.back());
}

// Abandons each frame twice: at a tile, whose index increases between frames, and after a pass, whose index does, too.
TEST_P(TechniqueDeterminism, AbandonedFramesLeaveNoTrace) {
  const Sequence& whole = of_one_thread();
  Session interrupted = session(2);
  const size_t passes = pass_declarations(interrupted).size();
  const auto count = static_cast<size_t>(frames());
  size_t at_tiles = 0;
  size_t after_passes = 0;
  for (int frame = 0; frame < frames(); ++frame) {
    if (frame % GetParam().frames_of_an_image == 0)
      interrupted.set_time(0.05f * static_cast<float>(frame / GetParam().frames_of_an_image));
    const auto number = static_cast<size_t>(frame);
    const bool at_tile = abandon_at_tile(interrupted, number * whole.tiles[number] / count);
    const bool after_pass = at_tile && abandon_after_pass(interrupted, number * passes / count);
    if (after_pass) interrupted.render_frame();
    at_tiles += at_tile ? 1 : 0;
    after_passes += after_pass ? 1 : 0;
    ASSERT_EQ(frame_hash(interrupted), whole.frames[number]) << "frame " << frame;
  }
  EXPECT_GT(at_tiles, count / 8);
  EXPECT_GT(after_passes, count / 8);
}

/// Tests that render several seeds in one session rely on this.
TEST_P(TechniqueDeterminism, RestartEqualsAFreshSession) {
  RenderSettings of_two = settings(2);
  Session used(build("turntable"), of_two);
  const CameraPose start = used.camera();
  for (int frame = 0; frame < frames() / 2; ++frame) {
    if (frame == frames() / 4) {
      CameraPose moved = start;
      moved.to_world[3] += 0.1f * moved.to_world[0];
      used.set_camera(moved);
    }
    used.render_frame();
  }
  used.set_camera(start);
  of_two.seed = 5;
  used.restart(of_two.seed);
  Session fresh(build("turntable"), of_two);
  for (int frame = 0; frame < frames() / 4; ++frame) {
    used.render_frame();
    fresh.render_frame();
    ASSERT_EQ(bits_of(used), bits_of(fresh)) << "frame " << frame;
  }
}

TEST_P(TechniqueDeterminism, EditsAfterAnAbandonedFrameAreAsWithoutIt) {
  Session whole = session(2);
  Session interrupted = session(2);
  const CameraPose camera = whole.camera();
  const int edits = frames() / 2;
  for (int frame = 0; frame < edits; ++frame) {
    const size_t tiles = count_tiles(whole, frame);
    render(interrupted, frame, frame + 1);
    if (!abandon_at_tile(interrupted, tiles * static_cast<size_t>(frame + 1) / static_cast<size_t>(edits + 3)))
      whole.render_frame();
    for (Session* each : {&whole, &interrupted}) {
      CameraPose moved = camera;
      moved.to_world[3].x += 0.02f * static_cast<float>(frame);
      Environment light;
      light.kind = EnvironmentKind::constant;
      light.color = Rgb(0.1f * static_cast<float>(frame));
      if (frame % 3 == 1) each->set_camera(moved);
      if (frame % 3 == 2) each->set_environment(light);
      each->render_frame();
    }
    ASSERT_EQ(bits_of(interrupted), bits_of(whole)) << "frame " << frame;
  }
}

TEST_P(TechniqueDeterminism, ResumedAfterAnAbandonedFrameEqualsUninterrupted) {
  const std::filesystem::path file = checkpoint_file("abandoned_" + std::string(GetParam().name));
  Session whole = session(2);
  const int half = frames() / 2;
  render(whole, 0, half);
  const size_t tiles = count_tiles(whole, half);
  {
    Session first = session(2);
    render(first, 0, half + 1);
    bool stopped = false;
    for (const size_t share : {2u, 3u, 6u}) {  // a late stop completes the frame
      stopped = stopped || abandon_at_tile(first, tiles / share);
      if (!stopped) whole.render_frame();
    }
    EXPECT_TRUE(stopped);
    first.save_checkpoint(file);
  }
  Session second = session(2);
  second.load_checkpoint(file);
  for (int i = 0; i < 3; ++i) {
    whole.render_frame();
    second.render_frame();
    EXPECT_EQ(bits_of(second), bits_of(whole)) << i;
  }
  std::filesystem::remove(file);
}

TEST_P(TechniqueDeterminism, ResumedEqualsUninterrupted) {
  const std::filesystem::path file = checkpoint_file(GetParam().name);
  const int saved = frames() / 2 + 1;  // within an image
  {
    Session first = session(1);
    render(first, 0, saved);
    first.save_checkpoint(file);
  }
  Session second = session(2);
  second.load_checkpoint(file);
  render(second, saved, frames());
  EXPECT_EQ(frame_hash(second), of_one_thread().frames.back());
  std::filesystem::remove(file);
}

/// Tests that depend on neither the number of frames nor the size of images.
class TechniqueMemory : public TechniqueDeterminism {};

/// Renders on memory that is closed to the host between launches, where kernels may access no other memory. In a frame,
/// host code may open only small blocks there, and tables of constants. Loops over vectors of the host are not
/// detected. The kernels have the forms of the host; the next test checks the memory of those of a device.
TEST_P(TechniqueMemory, HostAndKernelsKeepToTheirMemory) {
#if !__has_builtin(__builtin_clear_padding)
  GTEST_SKIP() << "the compiler cannot clear padding, which may look like an address";
#endif
  if (is_host_replaced()) GTEST_SKIP() << kWatchedOnTheHost;
  constexpr int kShown = 5;
  const std::filesystem::path file = checkpoint_file("walled_" + std::string(GetParam().name));
  testing::WalledMemory memory;
  RenderSettings of_two = settings(2);
  of_two.scalar_kernels = false;
  of_two.accel = AccelChoice::embree;
  {
    Session walled = make_session(build("turntable"), of_two, memory);
    watch_accesses(walled, memory);
    render(walled, 0, kShown, memory);
    walled.statistics();
    for (const RecordTable& table : walled.record_tables()) walled.records(table.name);
    walled.save_checkpoint(file);
    walled.load_checkpoint(file);
    render(walled, kShown, kShown + 2, memory);
    Session plain(build("turntable"), of_two);
    render(plain, 0, kShown + 2);
    EXPECT_EQ(bits_of(walled), bits_of(plain));
  }
  for (const std::string& violation : memory.violations()) ADD_FAILURE() << violation;
  std::filesystem::remove(file);
}

/// The same while a skinned and morphed mesh moves.
TEST(DeformingScene, HostAndKernelsKeepToTheirMemory) {
#if !__has_builtin(__builtin_clear_padding)
  GTEST_SKIP() << "the compiler cannot clear padding, which may look like an address";
#endif
  if (is_host_replaced()) GTEST_SKIP() << kWatchedOnTheHost;
  for (const bool scalar : {false, true}) {
    testing::WalledMemory memory;
    RenderSettings settings = small_settings(64, 32);
    settings.scalar_kernels = scalar;
    settings.accel = scalar ? AccelChoice::bvh : AccelChoice::embree;  // the forms of a device, and those of the host
    {
      const Scene scene = testing::figure({.morphs = true});
      Session walled = make_session(scene, settings, memory);
      watch_accesses(walled, memory);
      Session plain(scene, settings);
      for (const float time_s : {0.0f, 0.3f, 0.6f}) {
        for (Session* session : {&walled, &plain}) {
          session->set_time(time_s);
          limit_host_access(memory);
          session->render_frame();
          memory.permit_host_access();
        }
        EXPECT_EQ(bits_of(walled), bits_of(plain)) << time_s;
      }
    }
    for (const std::string& violation : memory.violations()) ADD_FAILURE() << violation;
  }
}

/// Bytes of the blocks that timed host code accesses (Backend::run()), the most in a launch of each name. The form of
/// kernels is that of devices: others include loops of the host. Reports kernels that access other memory.
std::map<std::string, size_t> host_work(const DeterminismCheck& technique, int width, int height) {
  testing::WalledMemory memory;
  RenderSettings settings = settings_of(technique, 2);
  settings.width = width;
  settings.height = height;
  settings.scalar_kernels = true;
  settings.accel = AccelChoice::bvh;
  Session session = make_session(build("turntable"), settings, memory);
  watch_accesses(session, memory);
  memory.count_host_work();
  for (int frame = 0; frame < 4; ++frame) {
    session.set_time(0.05f * static_cast<float>(frame));
    session.render_frame();
  }
#if __has_builtin(__builtin_clear_padding)  // otherwise, padding may look like an address
  for (const std::string& violation : memory.violations()) ADD_FAILURE() << violation;
#endif
  return memory.host_work();
}

/// Backend::run() opens the walls. A loop over pixels there would access a block that has a byte per pixel or more.
TEST_P(TechniqueMemory, TimedHostCodeAccessesNoPixels) {
  if (is_host_replaced()) GTEST_SKIP() << kWatchedOnTheHost;
  constexpr int kWidth = 31;
  constexpr int kHeight = 17;
  constexpr size_t kAddedPixels = size_t{3} * kWidth * kHeight;
  const std::map<std::string, size_t> few = host_work(GetParam(), kWidth, kHeight);
  const std::map<std::string, size_t> many = host_work(GetParam(), 2 * kWidth, 2 * kHeight);
  EXPECT_TRUE(many.contains("scene")) << "which places the instances of each frame";
  for (const auto& [launch, bytes] : many) {
    const auto before = few.find(launch);
    EXPECT_LT(bytes, (before == few.end() ? 0 : before->second) + kAddedPixels) << launch;
  }
}

/// Sequences of at least two images, of techniques with this many choices that are not defaults.
std::vector<TechniqueCase> cases(int frames, int width, int height, int least_choices = 0, int most_choices = 100) {
  std::vector<TechniqueCase> list;
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    const int choices = count_choices(technique);
    if (choices < least_choices || choices > most_choices) continue;
    list.push_back({technique, std::max(frames, 2 * technique.frames_of_an_image), width, height});
  }
  return list;
}

std::string case_name(const ::testing::TestParamInfo<TechniqueCase>& instance) { return instance.param.name; }

// The images have several tiles in both directions, and sizes that are not multiples of tiles. In slow sequences,
// caches and guides learn for longer, and frames are abandoned at more tiles and after more passes.
INSTANTIATE_TEST_SUITE_P(All, TechniqueDeterminism, ::testing::ValuesIn(cases(12, 25, 17)), case_name);
// Host code belongs to passes, all of which are in pairs of choices. DeviceBits watches the kernels of all techniques.
INSTANTIATE_TEST_SUITE_P(Pairs, TechniqueMemory, ::testing::ValuesIn(cases(12, 25, 17, 0, 2)), case_name);
INSTANTIATE_TEST_SUITE_P(SlowOthers, TechniqueMemory, ::testing::ValuesIn(cases(12, 25, 17, 3)), case_name);
INSTANTIATE_TEST_SUITE_P(SlowAll, TechniqueDeterminism, ::testing::ValuesIn(cases(24, 61, 33)), case_name);

TEST(TechniqueDeterminismList, HasEveryChoiceOfEverySlot) {
  RenderSettings defaults;
  for (const Setting& slot : describe_slots(defaults)) {
    for (const std::string_view choice : std::get<ChoiceRef>(slot.value).names) {
      if (choice == "oidn") continue;  // external library without this guarantee
      bool listed = false;
      for (const DeterminismCheck& technique : technique_checks().determinism) {
        RenderSettings settings = settings_of(technique, 1);
        listed = listed || to_string(require_setting(describe_slots(settings), slot.name, "")) == choice;
      }
      EXPECT_TRUE(listed) << slot.name << " " << choice << " is in no checks.json";
    }
  }
}

}  // namespace
}  // namespace relume::support
