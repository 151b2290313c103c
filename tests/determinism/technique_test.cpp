// Techniques that carry something from frame to frame, on a scene in which everything moves: the same bits with any
// number of threads and after a resume. No choice of a slot is left out.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "determinism/same_bits.h"
#include "settings/settings_json.h"
#include "support/measure.h"

namespace relume::support {
namespace {

struct Technique {
  const char* name;
  const char* json;             ///< what differs from small_settings()
  int frames_of_a_picture = 3;  ///< between moves
};

// Regions are small, so that small pictures fill many; cells are believed early, so that few frames cull some paths.
const Technique kTechniques[] = {
    {"uniform", R"({"lights": "uniform", "history": "none"})"},
    {"light_tree", R"({"lights": "light-tree"})"},
    {"static_lists", R"({"lights": "static-lists", "static-lists.rays": 64})"},
    {"vlc", R"({"lights": "vlc"})"},
    {"cdq", R"({"guide": "cdq"})"},
    {"vlc_cdq", R"({"lights": "vlc", "guide": "cdq"})"},
    {"vlc_cdq_memory", R"({"lights": "vlc", "guide": "cdq", "vlc.memory": 0, "cdq.memory": 8, "cdq.spread": 1,
                           "cdq.migrations": 4, "octree.jitter": 1})"},
    {"vlc_cdq_combination", R"({"lights": "vlc", "guide": "cdq", "allocation": "adaptive", "adaptive.max": 6,
                                "history": "reproject"})"},
    {"reproject", R"({"history": "reproject"})"},
    {"reproject_one", R"({"history": "reproject", "reproject.stored": "1"})"},
    {"backward", R"({"history": "reproject", "reproject.method": "backward"})"},
    {"backward_svgf", R"({"history": "reproject", "reproject.method": "backward", "denoise": "svgf"})"},
    {"adaptive", R"({"allocation": "adaptive", "adaptive.max": 6})"},
    // A resume in the middle of the second picture's pilot.
    {"adaptive_pilot", R"({"allocation": "adaptive", "adaptive.max": 6, "adaptive.pilot": true})", 12},
    {"combination", R"({"allocation": "adaptive", "adaptive.max": 6, "history": "reproject"})"},
    {"psf", R"({"cache": "psf"})"},
    {"psf_none", R"({"cache": "psf", "history": "none"})"},
    {"psf_neighbours", R"({"cache": "psf", "psf.thin-cells": "neighbours"})"},
    {"psf_directions", R"({"cache": "psf", "psf.direction-bins": 4})"},
    {"apsf", R"({"cache": "apsf", "apsf.min-samples": 16})"},
    {"apg", R"({"cache": "apg"})"},
    {"apsf_apg", R"({"cache": "apsf+apg", "apsf.min-samples": 16})"},
    {"bmfr", R"({"denoise": "bmfr"})"},
    {"svgf", R"({"denoise": "svgf"})"},
    {"bdpt", R"({"estimator": "bdpt"})"},
    {"light", R"({"estimator": "light"})"},
};

RenderSettings settings_of(const Technique& technique, int threads) {
  RenderSettings s = small_settings(61, 33);
  s.threads = threads;
  s.auxiliary = true;
  s.octree = {.collapse = 32, .split = 64, .scale = false};
  settings_from_json(describe(s), technique.json, technique.name);
  return s;
}

class TechniqueDeterminism : public ::testing::TestWithParam<Technique> {
 protected:
  static constexpr int kFrames = 24;

  static Session session(int threads) { return Session(build("turntable"), settings_of(GetParam(), threads)); }
  /// Frames `first` to `last` of the sequence.
  static void render(Session& session, int first, int last) {
    const int of_a_picture = GetParam().frames_of_a_picture;
    for (int frame = first; frame < last; ++frame) {
      if (frame % of_a_picture == 0) session.set_time(0.05f * static_cast<float>(frame / of_a_picture));
      session.render_frame();
    }
  }
};

TEST_P(TechniqueDeterminism, AnyNumberOfThreads) {
  const auto frames = [&](int threads) {
    Session rendered = session(threads);
    render(rendered, 0, kFrames);
    return bits_of(rendered);
  };
  const std::vector<uint32_t> one = frames(1);
  EXPECT_EQ(frames(2), one);
  EXPECT_EQ(frames(5), one);
}

TEST_P(TechniqueDeterminism, ResumedEqualsUninterrupted) {
  const std::filesystem::path file = checkpoint_file(GetParam().name);
  Session whole = session(2);
  render(whole, 0, kFrames);
  {
    Session first = session(1);
    render(first, 0, 14);
    first.save_checkpoint(file);
  }
  Session second = session(2);
  second.load_checkpoint(file);
  render(second, 14, kFrames);
  EXPECT_EQ(bits_of(second), bits_of(whole));
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(All, TechniqueDeterminism, ::testing::ValuesIn(kTechniques),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(TechniqueDeterminismList, HasEveryChoiceOfEverySlot) {
  RenderSettings defaults;
  for (const Setting& slot : describe_slots(defaults)) {
    for (const std::string_view choice : std::get<ChoiceRef>(slot.value).names) {
      if (choice == "oidn") continue;  // another's library, which promises nothing of the kind
      bool listed = false;
      for (const Technique& technique : kTechniques) {
        RenderSettings settings = settings_of(technique, 1);
        listed = listed || to_string(require_setting(describe_slots(settings), slot.name, "")) == choice;
      }
      EXPECT_TRUE(listed) << slot.name << " " << choice << " is in no case of kTechniques";
    }
  }
}

}  // namespace
}  // namespace relume::support
