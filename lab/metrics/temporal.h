// Flicker: the change of a sequence's error between frames, for an eye that follows the surfaces.
#pragma once

#include <cstdint>
#include <vector>

#include "relume/image_io.h"

namespace relume {

/// Surfaces at the pixels of a frame, to find them in the previous frame. Planes of the image's size.
struct SurfaceMotion {
  std::vector<Vec2> motion;  ///< position minus position in the previous frame, pixels
  std::vector<float> depth;  ///< metres
  std::vector<Vec3> normal;
};

struct TemporalError {
  double mse = 0;       ///< mean of (e_t(p) - e_{t-1}(q))²
  double rel_mse = 0;   ///< the same over reference² + 0.01
  uint64_t pixels = 0;  ///< number of pixels visible in the previous frame, too
};

/// Compares the error e = image - reference at each pixel p with that at q, the previous position of p's surface.
/// Changes of the reference (motion, light) cancel. q is the nearest pixel. p is excluded if q is outside the image or
/// shows another surface (depth differs by more than 10 % or normals by more than 25°). An error fixed to the surfaces,
/// such as bias or frozen noise, contributes 0; independent noise of variance σ² contributes 2σ². Throws Error if sizes
/// differ.
TemporalError temporal_error(const Image& image, const Image& reference, const SurfaceMotion& surface,
                             const Image& previous_image, const Image& previous_reference,
                             const SurfaceMotion& previous_surface);

/// Expected contribution of the references' noise to temporal_error(), if it is independent between frames: the sum of
/// both variances. `squared_error` and `previous_squared_error` contain them per pixel and channel. Throws Error if
/// sizes differ.
TemporalError temporal_noise(const Image& reference, const Image& squared_error, const SurfaceMotion& surface,
                             const Image& previous_squared_error, const SurfaceMotion& previous_surface);

}  // namespace relume
