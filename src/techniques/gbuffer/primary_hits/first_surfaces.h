// Surfaces at primary hits, handed from the pass that traces paths to one that needs them too. Host only.
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// Receives the surface at each primary hit from the pass that traces paths. A surface point takes longer to compute
/// than most of what is derived from it.
class FirstSurfaces {
 public:
  virtual ~FirstSurfaces() = default;

  /// Whether receive() must be called in this frame, exactly once for each rendered pixel.
  virtual bool expected() const = 0;

  /// Takes the surface of one pixel. `ray`: its camera ray. `ray_id`: Sampler::camera_ray_id(). `surface`: only
  /// defined if `hit` is valid. Threads call this concurrently, for different pixels.
  virtual void receive(uint32_t pixel, const Ray& ray, uint32_t ray_id, const Hit& hit,
                       const SurfacePoint& surface) const = 0;
};

}  // namespace relume
