// The camera of the hash grid's tests.
#pragma once

#include "scene/camera_view.h"

namespace relume {

/// A camera at the origin that looks along −Z. Its image at distance 1 is 1 × 1 with 1000 × 1000 pixels.
inline CameraView grid_camera() {
  CameraView camera;
  camera.axes = make_frame(Vec3(0, 0, 1));
  camera.half_extent = Vec2(0.5f);
  camera.resolution = Vec2(1000);
  return camera;
}

}  // namespace relume
