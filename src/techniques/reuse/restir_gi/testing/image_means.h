// Means of images and of their blocks over seeds.
#pragma once

#include <optional>
#include <vector>

#include "core/vec.h"
#include "render/session.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume::testing {

inline constexpr int kReuseSize = 24;      // pixels
inline constexpr size_t kReuseBlocks = 4;  // per edge of the image

/// Mean luminance of the image, then of its blocks.
inline std::vector<double> means_of(const Image& image) {
  constexpr size_t kSize = kReuseSize;
  std::vector<double> means(1 + kReuseBlocks * kReuseBlocks);
  for (size_t p = 0; p < kSize * kSize; ++p) {
    const double y = static_cast<double>(luminance(image.pixels[p]));
    const size_t block = p / kSize * kReuseBlocks / kSize * kReuseBlocks + p % kSize * kReuseBlocks / kSize;
    means[0] += y / (kSize * kSize);
    means[1 + block] += y * kReuseBlocks * kReuseBlocks / (kSize * kSize);
  }
  return means;
}

/// means_of() images of each of the seeds 1, 2, … after the camera has moved in each of the first frames, then rested.
/// The images contain the last `kept` frames. The seed is the last index.
inline std::vector<std::vector<double>> values_after_moves(const Scene& scene, const RenderSettings& settings,
                                                           int seeds, int moving, int kept) {
  Session session(Scene(scene), settings);
  std::vector<std::vector<double>> values(1 + kReuseBlocks * kReuseBlocks);
  for (int seed = 1; seed <= seeds; ++seed) {
    session.set_camera(std::nullopt);
    session.restart(seed);
    CameraPose camera = session.camera();
    for (int i = 0; i < moving; ++i) {
      camera.to_world[3] += 0.03f * camera.to_world[0];
      session.set_camera(camera);
      session.render_frame();
    }
    for (int i = 0; i < kept; ++i) session.render_frame();
    const std::vector<double> means = means_of(session.image());
    for (size_t k = 0; k < means.size(); ++k) values[k].push_back(means[k]);
  }
  return values;
}

/// The means over seeds of values_after_moves().
inline std::vector<Measured> after_moves(const Scene& scene, const RenderSettings& settings, int seeds, int moving,
                                         int kept) {
  const std::vector<std::vector<double>> values = values_after_moves(scene, settings, seeds, moving, kept);
  std::vector<Measured> result;
  result.reserve(values.size());
  for (const std::vector<double>& of_one : values) result.push_back(measured_over(of_one));
  return result;
}

inline RenderSettings reuse_settings(ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kReuseSize;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.restir_gi.radius = 6;
  settings.path.max_bounces = 2;
  return settings;
}

}  // namespace relume::testing
