// The camera with which tests of the hash grid look at their cells.
#pragma once

#include "scene/camera_view.h"

namespace relume {

/// At the origin, along -Z; the image at distance 1 is 1 by 1, of 1000 × 1000 pixels.
inline CameraView grid_camera() {
  CameraView camera;
  camera.axes = make_frame(Vec3(0, 0, 1));
  camera.half_extent = Vec2(0.5f);
  camera.resolution = Vec2(1000);
  return camera;
}

}  // namespace relume
