// Comparisons bit by bit, and what every resumed session is held to.
#pragma once

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "render/session.h"
#include "scene/builtin.h"

namespace relume::support {

inline Scene build(const char* name) { return find_builtin_scene(name)->build(); }

/// NaNs included.
inline bool same_bits(const Image& a, const Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

/// Three frames of the box, a checkpoint, and two more, by the same session and by one that takes it up. `name` tells
/// files of tests that run at once apart.
inline void expect_resumed_equals_uninterrupted(const RenderSettings& settings, std::string_view name) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) /
                                     ("relume_" + std::string(name) + "_" + std::to_string(::getpid()) + ".ckpt");
  Session whole(build("cornell"), settings);
  for (int i = 0; i < 3; ++i) whole.render_frame();
  whole.save_checkpoint(file);
  Session resumed(build("cornell"), settings);
  resumed.load_checkpoint(file);
  for (int i = 0; i < 2; ++i) {
    whole.render_frame();
    resumed.render_frame();
  }
  EXPECT_TRUE(same_bits(resumed.image(), whole.image()));
  std::filesystem::remove(file);
}

}  // namespace relume::support
