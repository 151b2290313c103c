// Flicker: how much the error of a sequence changes from one frame to the next, seen by an eye that follows the
// surfaces.
#pragma once

#include <cstdint>
#include <vector>

#include "relume/image_io.h"

namespace relume {

/// What each pixel of a frame shows, for finding it again in the frame before. Planes of the image's size.
struct SurfaceMotion {
  std::vector<Vec2> motion;  ///< position now minus position one frame ago, pixels
  std::vector<float> depth;  ///< metres
  std::vector<Vec3> normal;
};

struct TemporalError {
  double mse = 0;       ///< mean of (e_t(p) - e_{t-1}(q))²
  double rel_mse = 0;   ///< the same over reference² + 0.01
  uint64_t pixels = 0;  ///< that the frame before shows too
};

/// Compares the error e = image - reference at each pixel p with that at q, where p's surface was one frame ago: what
/// the reference does by itself (motion, changing light) cancels. q is the nearest pixel; p is left out if q is outside
/// the image or shows something else (depth differs by more than 10 % or normals by more than 25°). An error that stays
/// in place on the surfaces, such as bias or frozen noise, counts nothing; independent noise of variance σ² counts 2σ².
/// Throws Error if sizes differ.
TemporalError temporal_error(const Image& image, const Image& reference, const SurfaceMotion& surface,
                             const Image& previous_image, const Image& previous_reference,
                             const SurfaceMotion& previous_surface);

/// What noise of the references adds to temporal_error() on average, if it is independent from frame to frame: the sum
/// of both variances, which `squared_error` and `previous_squared_error` have for each pixel and channel. Throws Error
/// if sizes differ.
TemporalError temporal_noise(const Image& reference, const Image& squared_error, const SurfaceMotion& surface,
                             const Image& previous_squared_error, const SurfaceMotion& previous_surface);

}  // namespace relume
