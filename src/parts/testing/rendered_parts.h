// Parts of images for tests.
#pragma once

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "parts/part_file.h"
#include "parts/part_info.h"
#include "relume/image_io.h"
#include "render/session.h"
#include "render/settings.h"
#include "settings/settings_json.h"

namespace relume::testing {

/// Renders samples of one scene with the same settings, and writes them.
class PartRenderer {
 public:
  /// `aovs`: layers beside the image.
  PartRenderer(std::function<Scene()> scene, const RenderSettings& settings, std::vector<std::string> aovs)
      : scene_(std::move(scene)), settings_(settings), aovs_(std::move(aovs)) {
    settings_.auxiliary = !aovs_.empty();
    settings_.samples.sums = true;
  }

  /// The image of samples 0 to `count` - 1, without a file.
  ExrFile whole(uint32_t count) const {
    Session session(scene_(), settings_);
    render(session, count);
    return image_of(session);
  }

  /// Writes a part, as `relume render --sample-range` does.
  void write(const std::filesystem::path& file, const SampleRange& range) const {
    RenderSettings settings = settings_;
    settings.samples.part = true;
    settings.samples.first = range.first;
    Session session(scene_(), settings);
    render(session, range.count());
    write_part(file, image_of(session), session);
  }

 private:
  static void render(Session& session, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) session.render_frame();
  }
  ExrFile image_of(const Session& session) const {
    const Image image = session.image();
    AllSettings all;
    all.render = render_settings(session);
    ExrFile exr{image.width, image.height, exr_channels(image), {}, settings_.crop};
    exr.attributes = {{"relume.version", "1"},
                      {"relume.scene_hash", std::to_string(session.scene_hash())},
                      {"relume.settings", settings_to_json(describe(all))},
                      {"relume.samples_per_pixel", std::to_string(rendered_samples(session).count)},
                      {"relume.timings", R"({"render_s": 1.500000})"}};
    for (const std::string& name : aovs_) {
      for (ExrChannel& channel : session.aov(name)) exr.channels.push_back(std::move(channel));
    }
    return exr;
  }

  std::function<Scene()> scene_;
  RenderSettings settings_;
  std::vector<std::string> aovs_;
};

inline bool in_window(const ExrFile& exr, size_t pixel) {
  const PixelWindow& w = exr.data_window;
  const int x = static_cast<int>(pixel) % exr.width - w.x;
  const int y = static_cast<int>(pixel) / exr.width - w.y;
  return w.empty() || (x >= 0 && x < w.width && y >= 0 && y < w.height);
}

/// Expects the channels of both, bit for bit. `except`: channels of this prefix are not compared.
inline void expect_same_channels(const ExrFile& a, const ExrFile& b, const std::string& except = "-") {
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (const ExrChannel& channel : a.channels) {
    const ExrChannel* const other = b.find(channel.name);
    ASSERT_NE(other, nullptr) << channel.name;
    if (channel.name.starts_with(except)) continue;
    size_t differences = 0;
    for (size_t i = 0; i < channel.values.size(); ++i) {
      const bool same = std::bit_cast<uint32_t>(channel.values[i]) == std::bit_cast<uint32_t>(other->values[i]);
      if (in_window(a, i) && !same) ++differences;
    }
    EXPECT_EQ(differences, 0u) << channel.name;
  }
}

}  // namespace relume::testing
