// Tests that bits do not depend on the number of threads and interruptions.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "determinism/same_bits.h"
#include "relume/error.h"
#include "support/measure.h"

namespace relume::support {
namespace {

struct Case {
  const char* scene;
  int width;
  int height;
  bool learns = false;  ///< light selection and guiding from earlier frames
};

// Sizes that are not multiples of tiles. The scenes include textures, instances, animation, glass, environments and
// many lights.
const Case kCases[] = {
    {"cornell", 45, 37}, {"cornell-glass", 37, 45}, {"warehouse", 67, 35},       {"mine", 61, 33},
    {"slit", 45, 27},    {"door", 45, 34},          {"warehouse", 67, 35, true}, {"slit", 45, 27, true}};

RenderSettings settings_of(const Case& c, int threads) {
  RenderSettings s = small_settings(c.width, c.height);
  s.threads = threads;
  s.auxiliary = true;
  if (c.learns) {
    s.lights = LightSelectionChoice::vlc;
    s.vlc.memory = 2;
    s.guide = GuideChoice::cdq;
    s.cdq.migrations = 2;
    s.octree.scale = false;  // small regions, which small images can fill
    s.octree.split = 64;
    s.octree.collapse = 32;
  }
  return s;
}

std::vector<uint32_t> rendered(const Case& c, const RenderSettings& settings, int spp) {
  Session session(build(c.scene), settings);
  for (int i = 0; i < spp; ++i) session.render_frame();
  return bits_of(session);
}

class Determinism : public ::testing::TestWithParam<Case> {};
class WithoutLearning : public Determinism {};

TEST_P(Determinism, AnyNumberOfThreads) {
  const std::vector<uint32_t> one = rendered(GetParam(), settings_of(GetParam(), 1), 3);
  for (const int threads : {2, 5})
    EXPECT_EQ(rendered(GetParam(), settings_of(GetParam(), threads), 3), one) << threads << " threads";
}

TEST_P(WithoutLearning, LightSubpathsToo) {  // provides no samples for learning
  Session one(build(GetParam().scene), settings_of(GetParam(), 1));
  Session four(build(GetParam().scene), settings_of(GetParam(), 4));
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::light}) {
    for (Session* session : {&one, &four}) {
      RenderSettings settings = render_settings(*session);
      settings.estimator = estimator;
      ASSERT_TRUE(session->set_settings(settings));
      session->restart(settings.seed);
      for (int i = 0; i < 2; ++i) session->render_frame();
    }
    EXPECT_EQ(bits_of(four), bits_of(one));
  }
}

TEST_P(Determinism, SequencesToo) {
  const auto frames = [&](int threads) {
    Session session(build(GetParam().scene), settings_of(GetParam(), threads));
    std::vector<uint32_t> bits;
    for (const float time_s : {0.0f, 0.1f, 0.5f}) {
      session.set_time(time_s);
      session.render_frame();
      const std::vector<uint32_t> frame = bits_of(session);
      bits.insert(bits.end(), frame.begin(), frame.end());
    }
    return bits;
  };
  EXPECT_EQ(frames(5), frames(1));
}

TEST_P(WithoutLearning, TimeReachedBySteppingOrAtOnce) {  // excludes motion vectors and learned state
  RenderSettings settings = settings_of(GetParam(), 2);
  settings.auxiliary = false;
  Session stepped(build(GetParam().scene), settings);
  for (const float time_s : {0.2f, 0.35f, 0.5f}) stepped.set_time(time_s);
  settings.time_s = 0.5f;
  Session direct(build(GetParam().scene), settings);
  stepped.render_frame();
  direct.render_frame();
  EXPECT_EQ(bits_of(stepped), bits_of(direct));
}

TEST_P(Determinism, SeedsDiffer) {
  Session session(build(GetParam().scene), settings_of(GetParam(), 2));
  session.render_frame();
  const std::vector<uint32_t> zero = bits_of(session);
  session.restart(1);
  session.render_frame();
  EXPECT_NE(bits_of(session), zero);
}

TEST_P(Determinism, ResumedEqualsUninterrupted) {
  const std::filesystem::path file = checkpoint_file("resume");
  Session first(build(GetParam().scene), settings_of(GetParam(), 2));
  for (int i = 0; i < 2; ++i) first.render_frame();
  first.save_checkpoint(file);
  for (int i = 0; i < 3; ++i) first.render_frame();  // not in the checkpoint
  const std::vector<uint32_t> uninterrupted = bits_of(first);
  Session second(build(GetParam().scene), settings_of(GetParam(), 1));
  second.load_checkpoint(file);
  EXPECT_EQ(second.frames_since_change(), 2u);
  for (int i = 0; i < 3; ++i) second.render_frame();
  EXPECT_EQ(bits_of(second), uninterrupted);
  std::filesystem::remove(file);
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.scene;
  for (char& c : name) c = c == '-' ? '_' : c;
  return info.param.learns ? name + "_learns" : name;
}
INSTANTIATE_TEST_SUITE_P(Scenes, Determinism, ::testing::ValuesIn(kCases), case_name);
INSTANTIATE_TEST_SUITE_P(Scenes, WithoutLearning, ::testing::ValuesIn(std::begin(kCases), std::end(kCases) - 2),
                         case_name);

/// Spheres of dispersive glass, whose paths have wavelengths.
Scene dispersive_spheres() {
  Scene scene = build("cornell-glass");
  for (Material& m : scene.materials) m.dispersion = 2;
  return scene;
}

std::vector<uint32_t> rendered(const Scene& scene, const RenderSettings& settings) {
  Session session(scene, settings);
  for (int i = 0; i < 3; ++i) session.render_frame();
  return bits_of(session);
}

TEST(DispersionDeterminism, AnyNumberOfThreadsAndInterruptions) {
  const Scene scene = dispersive_spheres();
  const std::filesystem::path file = checkpoint_file("dispersion");
  for (const EstimatorChoice estimator : {EstimatorChoice::path, EstimatorChoice::bdpt}) {
    RenderSettings settings = small_settings(37, 45);
    settings.estimator = estimator;
    const std::vector<uint32_t> one = rendered(scene, settings);
    EXPECT_NE(rendered(build("cornell-glass"), settings), one);
    for (const int threads : {2, 5}) {
      settings.threads = threads;
      EXPECT_EQ(rendered(scene, settings), one) << threads << " threads";
    }
    Session first(scene, settings);
    first.render_frame();
    first.save_checkpoint(file);
    Session resumed(scene, settings);
    resumed.load_checkpoint(file);
    for (int i = 0; i < 2; ++i) resumed.render_frame();
    EXPECT_EQ(bits_of(resumed), one);
    std::filesystem::remove(file);
  }
}

TEST(DispersionDeterminism, AWindowHasTheBitsOfTheWholeImage) {
  const Scene scene = dispersive_spheres();
  RenderSettings settings = small_settings(37, 45);
  const Image whole = render(scene, settings, 3);
  settings.crop = {.x = 5, .y = 19, .width = 21, .height = 23};
  const Image part = render(scene, settings, 3);
  for (int y = 19; y < 42; ++y) {
    for (int x = 5; x < 26; ++x) ASSERT_EQ(part.at(x, y), whole.at(x, y)) << x << ' ' << y;
  }
}

TEST(Checkpoint, RefusesOtherSettingsAndScenesAndStaysUsable) {
  const std::filesystem::path file = checkpoint_file("other");
  const RenderSettings settings = small_settings(8, 8);
  Session session(build("cornell"), settings);
  session.render_frame();
  session.save_checkpoint(file);
  RenderSettings other = settings;
  other.seed = 7;
  Session seeded(build("cornell"), other);
  EXPECT_THROW(seeded.load_checkpoint(file), Error);
  other = settings;
  other.path.max_bounces = 3;
  EXPECT_THROW(Session(build("cornell"), other).load_checkpoint(file), Error);
  EXPECT_THROW(Session(build("cornell-glass"), settings).load_checkpoint(file), Error);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 5);
  Session truncated(build("cornell"), settings);
  EXPECT_THROW(truncated.load_checkpoint(file), Error);
  truncated.render_frame();
  EXPECT_EQ(bits_of(truncated), bits_of(session));
  std::filesystem::remove(file);
}

TEST(Checkpoint, DetectsDamageBeforeChangingTheSession) {
  const std::filesystem::path file = checkpoint_file("flipped");
  RenderSettings settings = small_settings(8, 8);
  settings.history = HistoryChoice::reproject;
  Session session(build("cornell"), settings);
  session.render_frame();
  session.save_checkpoint(file);
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(file));
  for (const std::streamoff at : {std::streamoff{9}, size / 3, size / 2, size - 30, size - 9, size - 1}) {
    std::fstream damaged(file, std::ios::binary | std::ios::in | std::ios::out);
    const auto flip = [&] {
      damaged.seekg(at);
      const char byte = static_cast<char>(damaged.get() ^ 16);
      damaged.seekp(at);
      damaged.put(byte).flush();
    };
    flip();
    Session other(build("cornell"), settings);
    EXPECT_THROW(other.load_checkpoint(file), Error) << at << " of " << size;
    other.render_frame();
    EXPECT_EQ(bits_of(other), bits_of(session));
    flip();
  }
  Session whole(build("cornell"), settings);
  EXPECT_NO_THROW(whole.load_checkpoint(file));
  std::filesystem::remove(file);
}

TEST(Cancellation, LeavesCompleteFramesOnly) {
  Session session(build("cornell"), small_settings(160, 160));
  session.render_frame();
  const std::vector<uint32_t> before = bits_of(session);
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_FALSE(session.render_frame(stopped.get_token()));
  EXPECT_EQ(session.frames_since_change(), 1u);
  EXPECT_EQ(bits_of(session), before);
  EXPECT_EQ(session.statistics().samples, 160u * 160u);
}

TEST(Cancellation, MidFrameLeavesNoTrace) {
  Session session(build("cornell"), small_settings(160, 160));
  session.render_frame();
  const auto frame_s = std::chrono::duration<double>(session.statistics().render_s);
  int stopped = 0;
  for (int attempt = 0; attempt < 40 && stopped < 4;
       ++attempt) {  // wall-clock time determines whether and where it stops
    const std::vector<uint32_t> before = bits_of(session);
    const uint64_t rays = session.statistics().rays;
    std::stop_source stop;
    std::jthread later([&] {
      std::this_thread::sleep_for((0.05 + 0.02 * attempt) * frame_s);
      stop.request_stop();
    });
    if (session.render_frame(stop.get_token())) continue;
    ++stopped;
    EXPECT_EQ(bits_of(session), before);  // the heat map counts rays
    EXPECT_EQ(session.statistics().rays, rays);
  }
  EXPECT_GT(stopped, 0);
}

TEST(Cancellation, MidFrameLeavesNoTraceInTechniques) {
  RenderSettings learning = settings_of({"cornell", 112, 112, true}, 2);
  learning.denoise = DenoiseChoice::svgf;
  RenderSettings cells = small_settings(112, 112);
  cells.cache = CacheChoice::psf;
  for (const RenderSettings& settings : {learning, cells}) {
    Session whole(build("cornell"), settings);
    Session interrupted(build("cornell"), settings);
    int stopped = 0;
    for (int frame = 0; frame < 12; ++frame) {
      const double before_s = whole.statistics().render_s;
      whole.render_frame();
      const auto frame_s = std::chrono::duration<double>(whole.statistics().render_s - before_s);
      std::stop_source stop;
      std::jthread later([&] {
        std::this_thread::sleep_for(0.07 * (frame + 1) * frame_s);
        stop.request_stop();
      });
      if (!interrupted.render_frame(stop.get_token())) {
        ++stopped;
        interrupted.render_frame();
      }
      ASSERT_EQ(bits_of(interrupted), bits_of(whole)) << "frame " << frame;
    }
    EXPECT_GT(stopped, 0);
  }
}

}  // namespace
}  // namespace relume::support
