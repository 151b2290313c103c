// Comparisons bit by bit, and what every resumed session is held to.
#pragma once

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"

namespace relume::support {

/// Built once a process.
inline const Scene& build(const char* name) {
  static std::map<std::string, Scene> known;
  const auto [found, is_new] = known.try_emplace(name);
  if (is_new) found->second = find_builtin_scene(name)->build();
  return found->second;
}

/// NaNs included.
inline bool same_bits(const Image& a, const Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

/// Every float that a render leaves behind, as bits.
inline std::vector<uint32_t> bits_of(const Session& session) {
  std::vector<uint32_t> bits;
  const auto add = [&](const void* data, size_t floats) {
    const size_t old = bits.size();
    bits.resize(old + floats);
    std::memcpy(bits.data() + old, data, floats * sizeof(float));
  };
  const Image image = session.image();
  add(image.pixels.data(), image.pixels.size() * 3);
  for (const std::string& name : Session::aov_names(render_settings(session))) {
    const Buffer* buffer = buffer_table(session).find(name);
    if (buffer && !buffer->description().persistent) continue;  // of this frame only, which may have been abandoned
    for (const ExrChannel& channel : session.aov(name)) add(channel.values.data(), channel.values.size());
  }
  return bits;
}

/// In the folder for temporary files; `name` tells tests of one process apart.
inline std::filesystem::path checkpoint_file(std::string_view name) {
  return std::filesystem::path(::testing::TempDir()) /
         ("relume_" + std::string(name) + "_" + std::to_string(::getpid()) + ".ckpt");
}

/// Three frames of the box, a checkpoint, and two more, by the same session and by one that takes it up. `name` tells
/// files of tests that run at once apart.
inline void expect_resumed_equals_uninterrupted(const RenderSettings& settings, std::string_view name) {
  const std::filesystem::path file = checkpoint_file(name);
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
