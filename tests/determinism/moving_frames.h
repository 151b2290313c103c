// Hashes of a few frames while the camera moves, for comparisons of two ways to compute them.
#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/fnv1a.h"
#include "determinism/same_bits.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/technique_checks.h"

namespace relume::support {

inline constexpr int kMovingFrames = 4;

/// Pixels of an image.
struct ImageSize {
  int width = 64;
  int height = 36;
};
/// Images of four tiles with a fifth of the pixels, for quick tests.
inline constexpr ImageSize kQuickSize{25, 17};

/// Small images of a technique.
inline RenderSettings moving_settings(const DeterminismCheck& technique, const ImageSize& size = {}) {
  RenderSettings s = small_settings(size.width, size.height);
  s.auxiliary = true;
  s.static_lists.rays = 64;                                  // their preparation would dominate the test's time
  s.octree = {.collapse = 32, .split = 64, .scale = false};  // many regions for few pixels
  settings_from_json(describe(s), technique.json, technique.name);
  s.threads = 2;
  return s;
}

/// Number of slots in which a technique has another choice than the default.
inline int count_choices(const DeterminismCheck& technique) {
  RenderSettings defaults;
  RenderSettings changed;
  settings_from_json(describe(changed), technique.json, technique.name);
  const SettingList before = describe_slots(defaults);
  const SettingList after = describe_slots(changed);
  int choices = 0;
  for (size_t i = 0; i < after.size(); ++i) choices += to_string(after[i]) != to_string(before[i]) ? 1 : 0;
  return choices;
}

/// Hash of all bits of the last frame.
inline uint64_t frame_hash(const Session& session) {
  const std::vector<uint32_t> bits = bits_of(session);
  Fnv1a hash;
  hash.add(bits.data(), bits.size() * sizeof(uint32_t));
  return hash.value();
}

/// Hash of each of `count` frames from a restart on, while the camera moves sideways and, with `frame_s` > 0, the scene
/// by that time per frame, seconds. Restores the camera, and then the time 0.
inline std::vector<uint64_t> moving_frames(Session& session, const RenderSettings& settings, float frame_s = 0,
                                           int count = kMovingFrames) {
  const CameraPose start = session.camera();
  EXPECT_TRUE(session.set_settings(settings));
  session.restart(settings.seed);
  std::vector<uint64_t> frames;
  for (int frame = 0; frame < count; ++frame) {
    CameraPose moved = start;
    moved.to_world[3] += 0.02f * static_cast<float>(frame) * start.to_world[0];
    session.set_camera(moved);
    if (frame_s > 0) session.set_time(frame_s * static_cast<float>(frame));
    session.render_frame();
    frames.push_back(frame_hash(session));
  }
  session.set_camera(start);
  if (frame_s > 0) session.set_time(0);
  return frames;
}

}  // namespace relume::support
