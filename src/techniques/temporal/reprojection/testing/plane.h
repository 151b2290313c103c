// A moved plane and the moments of its pixels in the previous frame: input of backward look-ups.
#pragma once

#include <vector>

#include "framebuffer/testing/moment_vectors.h"
#include "techniques/temporal/reprojection/backward.h"

namespace relume::testing {

/// A plane that moves to the right by half a pixel. Pixel 5 showed another surface in the previous frame.
struct Plane {
  BackwardReprojection reprojection() const {
    return {view_of(motion),
            view_of(position),
            view_of(normal),
            view_of(depth),
            view_of(instance),
            view_of(position),
            view_of(normal),
            view_of(before),
            4,
            4};
  }

  std::vector<Vec2> motion = std::vector<Vec2>(16, Vec2(0.5f, 0));
  std::vector<Vec3> position = std::vector<Vec3>(16, Vec3(0));
  std::vector<Vec3> normal = std::vector<Vec3>(16, Vec3(0, 0, 1));
  std::vector<float> depth = std::vector<float>(16, 1.0f);
  std::vector<uint32_t> instance = std::vector<uint32_t>(16, 7);
  std::vector<uint32_t> before = {7, 7, 7, 7, 7, 8, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7};
};

/// Moments of the plane's pixels.
struct History : MomentVectors {
  History() : MomentVectors(16, {Rgb(3), 1, 6, 9}) {}
};

}  // namespace relume::testing
