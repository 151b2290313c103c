// Kernels that choose the point of the view of directions, and draw its two maps.
#pragma once

#include "core/octahedral.h"
#include "techniques/guiding/direction_view/incident_light.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

/// Finds the first hit of one pixel; one call.
struct FindViewedPointKernel {
  SceneView scene;
  SampleIndex index;
  OctreeView octree;
  View<const Hit> hits;
  uint32_t pixel = 0;
  uint32_t width = 0;
  View<ViewedPoint> point;  ///< one element

  RELUME_HD void operator()(uint32_t, uint32_t) const {
    ViewedPoint& viewed = point[0];
    viewed.hit = hits[pixel];
    if (!viewed.hit.valid()) return;
    const CameraView& camera = scene.camera;
    Sampler sampler = index.sampler(pixel % width, pixel / width);
    viewed.ray = camera_ray(camera, pixel % width, pixel / width, sampler);
    viewed.cone_width = camera.cone_width() + camera.cone_spread() * viewed.hit.t;
    viewed.region = octree.find(surface_position(scene, viewed.hit).before);
  }
};

/// Direction at the middle of a texel of an octahedral map of edge `edge`.
RELUME_HD inline Vec3 direction_of_texel(uint32_t x, uint32_t y, uint32_t edge) {
  const Vec2 middle(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  return direction_from_square(middle / static_cast<float>(edge));
}

/// Integral of a map's sums over each texel, as the input of a reduction.
struct TexelIntegrals {
  View<const float> sums;
  uint32_t edge = 0;

  RELUME_HD double operator()(size_t i) const {
    const auto texel = static_cast<uint32_t>(i);
    const float area = 1.0f / static_cast<float>(edge * edge);
    return static_cast<double>(sums[texel] *
                               octahedral_solid_angle(direction_of_texel(texel % edge, texel / edge, edge)) * area);
  }
};

/// Writes both maps into the centres of the halves of the layer, unscaled; one call per half (0: left) and row.
struct DrawDirectionMapsKernel {
  QuadtreeArray quadtrees;
  View<const ViewedPoint> point;
  View<const float> sums;
  double integral = 0;  ///< of `sums` over the sphere
  uint32_t edge = 0;
  uint32_t width = 0;  ///< of the layer
  uint32_t height = 0;
  View<float> out;

  RELUME_HD void operator()(uint32_t half, uint32_t y) const {
    const uint32_t x0 = half * (width / 2) + (width / 2 - edge) / 2;
    const uint32_t y0 = (height - edge) / 2;
    float* const row = out.data + (y0 + y) * width + x0;
    if (half == 0) {
      const DirectionalQuadtree tree = quadtrees.load(point[0].region);
      for (uint32_t x = 0; x < edge; ++x) row[x] = tree.pdf(direction_of_texel(x, y, edge));
    } else {
      for (uint32_t x = 0; x < edge; ++x)
        row[x] = integral > 0 ? static_cast<float>(static_cast<double>(sums[y * edge + x]) / integral) : 0.0f;
    }
  }
};

}  // namespace relume
