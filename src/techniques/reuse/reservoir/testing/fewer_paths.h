// Settings under which pixels lack a path in some frames, and what becomes of their reservoirs: for tests of every kind
// of reservoirs.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/reservoir.h"

namespace relume::testing {

enum class FewerPaths { upscaled, adaptive, adaptive_after_pilot };

inline void apply(FewerPaths fewer, RenderSettings& settings) {
  if (fewer == FewerPaths::upscaled) {
    settings.upscaling.factor = 2;
    return;
  }
  settings.allocation = AllocationChoice::adaptive;
  settings.adaptive.max_samples = 8;
  settings.adaptive.pilot = fewer == FewerPaths::adaptive_after_pilot;
}

/// Bias of an image's mean, relative: without a pilot, sample values decide sample counts.
inline double bias_of(FewerPaths fewer) { return fewer == FewerPaths::adaptive ? 0.01 : 0; }

inline std::string name_of(FewerPaths fewer) {
  if (fewer == FewerPaths::upscaled) return "upscaled";
  return fewer == FewerPaths::adaptive ? "adaptive" : "adaptive_after_pilot";
}

/// Reservoirs that the next frame will reuse, their receivers, and the number of paths of each pixel in this frame.
template <typename Sample>
struct StoredReservoirs {
  std::vector<Reservoir<Sample>> reservoirs;
  std::vector<ReceiverRecord> receivers;
  std::vector<uint32_t> paths;

  /// `technique`: first part of the names of its buffers.
  StoredReservoirs(const Session& session, const std::string& technique)
      : reservoirs(copy_of<Reservoir<Sample>>(session, technique + "-history")),
        receivers(copy_of<ReceiverRecord>(session, technique + "-receivers")),
        paths(copy_of<uint32_t>(session, kAllocation.name)) {}

  bool has_reservoir(size_t pixel) const { return reservoirs[pixel].confidence > 0.0f; }

 private:
  template <typename T>
  static std::vector<T> copy_of(const Session& session, std::string_view name) {
    const View<const T> view = buffer_table(session).read(BufferKey<T>{name});
    return {view.begin(), view.end()};
  }
};

template <typename T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Renders four frames of a session with upscale 2, in whose scene all pixels have reservoirs. The camera moves before
/// the third frame. Before the fourth, the first light becomes `changed`.
template <typename Sample>
void expect_reservoirs_to_be_kept(Session& session, const std::string& technique, const PunctualLight& changed) {
  const auto next = [&] {
    session.render_frame();
    return StoredReservoirs<Sample>(session, technique);
  };
  const StoredReservoirs<Sample> first = next();
  const size_t pixels = first.paths.size();
  size_t filled = 0;
  for (size_t p = 0; p < pixels; ++p) {
    EXPECT_EQ(first.has_reservoir(p), first.paths[p] > 0) << p;
    EXPECT_EQ(first.receivers[p].valid(), first.paths[p] > 0) << p;
    filled += first.has_reservoir(p) ? 1 : 0;
  }
  EXPECT_EQ(4 * filled, pixels);

  const StoredReservoirs<Sample> second = next();
  size_t kept = 0;
  for (size_t p = 0; p < pixels; ++p) {
    if (second.paths[p] > 0 || !second.has_reservoir(p)) continue;
    ++kept;
    EXPECT_TRUE(same_bits(second.reservoirs[p], first.reservoirs[p])) << p;
    EXPECT_TRUE(same_bits(second.receivers[p], first.receivers[p])) << p;
  }
  EXPECT_GT(kept, filled / 2) << "only edges of surfaces lose some";

  CameraPose camera = session.camera();
  camera.to_world[3] += 0.05f * camera.to_world[0];
  session.set_camera(camera);
  const StoredReservoirs<Sample> third = next();
  kept = 0;
  for (size_t p = 0; p < pixels; ++p) {
    if (third.paths[p] > 0 || !third.has_reservoir(p)) continue;
    ++kept;
    const auto is_same = [&](const ReceiverRecord& receiver) { return same_bits(receiver, third.receivers[p]); };
    EXPECT_TRUE(std::any_of(second.receivers.begin(), second.receivers.end(), is_same)) << p;
  }
  EXPECT_GT(kept, pixels / 5);

  session.set_light(0, changed);
  const StoredReservoirs<Sample> fourth = next();
  for (size_t p = 0; p < pixels; ++p) EXPECT_EQ(fourth.has_reservoir(p), fourth.paths[p] > 0) << p;
}

}  // namespace relume::testing
