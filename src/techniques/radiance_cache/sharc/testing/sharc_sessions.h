// Sessions with the spatially hashed radiance cache, for tests and benchmarks.
#pragma once

#include <string_view>
#include <vector>

#include "render/session.h"

namespace relume::testing {

/// Settings of path tracing with the cache. A frame shows its own sample only.
inline RenderSettings sharc_settings(int width, int height) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.threads = 1;
  settings.cache = CacheChoice::sharc;
  settings.history = HistoryChoice::none;
  return settings;
}

/// `settings` with light selection and path guiding that learn in many regions.
inline RenderSettings with_learned_regions(RenderSettings settings) {
  settings.lights = LightSelectionChoice::vlc;
  settings.guide = GuideChoice::cdq;
  settings.octree = {.collapse = 32, .split = 64, .scale = false};
  return settings;
}

/// `settings` with light selection and path guiding that learn in chains.
inline RenderSettings with_chains(RenderSettings settings) {
  settings.lights = LightSelectionChoice::mcls;
  settings.guide = GuideChoice::mcpg;
  return settings;
}

/// Renders `count` frames.
inline void skip_frames(Session& session, int count) {
  for (int i = 0; i < count; ++i) session.render_frame();
}

inline double mean_luminance(const Image& image) {
  double sum = 0;
  for (const Rgb& p : image.pixels) sum += static_cast<double>(luminance(p));
  return sum / static_cast<double>(image.pixels.size());
}

/// Mean luminance of the next `count` frames.
inline double mean_of_frames(Session& session, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    session.render_frame();
    sum += mean_luminance(session.image()) / count;
  }
  return sum;
}

/// Value of a statistic, or −1 if no pass reports it.
inline double statistic(const Session& session, std::string_view name) {
  for (const PassStatistic& s : session.statistics().pass_statistics) {
    if (s.name == name) return s.value;
  }
  return -1;
}

}  // namespace relume::testing
