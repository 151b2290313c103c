// Compares results bit by bit, including those of resumed sessions.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cmath>
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

/// Scene, built once per process.
inline const Scene& build(const char* name) {
  static std::map<std::string, Scene> known;
  const auto [found, is_new] = known.try_emplace(name);
  if (is_new) found->second = find_builtin_scene(name)->build();
  return found->second;
}

/// Bitwise comparison, including NaNs.
inline bool same_bits(const Image& a, const Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

/// All floats of a render as bits. None may be NaN, whose bits differ between processors.
inline std::vector<uint32_t> bits_of(const Session& session) {
  std::vector<uint32_t> bits;
  const auto add = [&](const float* data, size_t floats) {
    EXPECT_TRUE(std::none_of(data, data + floats, [](float x) { return std::isnan(x); }));
    const size_t old = bits.size();
    bits.resize(old + floats);
    std::memcpy(bits.data() + old, data, floats * sizeof(float));
  };
  const Image image = session.image();
  add(&image.pixels.data()->x, image.pixels.size() * 3);
  for (const std::string& name : Session::aov_names(render_settings(session))) {
    const Buffer* buffer = buffer_table(session).find(name);
    if (buffer && !buffer->description().persistent) continue;  // transient, and possibly from an abandoned frame
    for (const ExrChannel& channel : session.aov(name)) add(channel.values.data(), channel.values.size());
  }
  return bits;
}

/// Path in the folder for temporary files; `name` distinguishes tests of one process.
inline std::filesystem::path checkpoint_file(std::string_view name) {
  return std::filesystem::path(::testing::TempDir()) /
         ("relume_" + std::string(name) + "_" + std::to_string(::getpid()) + ".ckpt");
}

/// Renders three frames of the box, writes a checkpoint, and compares two more frames of the same session and of a
/// resumed one. `name` distinguishes the files of concurrent tests.
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
