// A box with a dark, reflective floor under a walking camera, and errors of the floor.
#pragma once

#include <vector>

#include "render/session.h"

namespace relume::support {

/// The Cornell box with such a floor and a camera path of 0.75 s.
Scene polished_box(float roughness);

/// 160 × 90 pixels, four bounces.
RenderSettings floor_settings();

/// The true image of a compared frame.
struct FloorTruth {
  Image image;
  std::vector<bool> floor;  ///< pixels that show the floor
  double noise = 0;         ///< MSE of the reference at the floor
};

/// The compared frames of the walk. The difference of two images of independent seeds gives the noise of their mean.
std::vector<FloorTruth> floor_truths(const Scene& scene);

/// MSE of the floor's pixels over two seeds, minus the noise of the reference.
double floor_error(const Scene& scene, const std::vector<FloorTruth>& truths, RenderSettings settings);

}  // namespace relume::support
