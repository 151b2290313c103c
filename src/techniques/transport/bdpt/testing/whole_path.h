// Whole paths through a scene: their subpaths, and the densities of all strategies that can sample them.
#pragma once

#include <functional>
#include <vector>

#include "techniques/transport/bdpt/testing/bdpt_frame.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {

/// A surface vertex, and whether its subpath scattered there by a delta lobe.
struct Place {
  Hit hit;
  Vec3 position;
  Vec3 ng;
  bool delta = false;
};

struct TracedLight {
  EmissionSample emission;
  LightId light = kNoLight;
  std::vector<Place> places;
  std::vector<LightSubpath> states;  ///< state on arrival at each vertex
};

struct TracedCamera {
  Ray ray;  ///< camera ray
  std::vector<Place> places;
  std::vector<CameraSubpath> states;
};

// All functions exist for BdptContext and LearningContext.

/// Surface point of a vertex for a viewer along `wo`, with its region.
template <typename Context>
SurfacePoint seen(const Context& c, const Place& place, const Vec3& wo);

/// Light subpath of up to six vertices.
template <typename Context>
TracedLight trace_light(const Context& c, Sampler& sampler);
/// Camera subpath of up to seven vertices. Calls `at_vertex` for each before a direction is sampled there. The weights
/// restart at vertex number `restart`, where the camera has number 1; 0: never.
template <typename Context>
TracedCamera trace_camera(const Context& c, uint32_t x, uint32_t y, Sampler& sampler,
                          const std::function<void(const SurfacePoint&)>& at_vertex, uint32_t restart = 0);

/// All inputs to the densities of a whole path, from the light over surfaces to the camera.
struct WholePath {
  LightId light;
  bool infinite;
  bool light_can_be_hit;
  EmitterPoint on_light;
  Vec3 from_light;  ///< towards the first surface
  Vec3 light_normal{0};
  std::vector<Place> surfaces;
  Vec3 camera;
  bool camera_can_be_hit;
};

/// Densities of the strategies for one path, times their numbers of samples; zero for strategies that are impossible or
/// left out.
template <typename Context>
class Densities {
 public:
  /// `eta`: π r² n of vertex merging. `least_camera`: strategies with fewer vertices of the camera subpath are left
  /// out.
  Densities(const Context& c, const WholePath& path, double eta, size_t least_camera = 0);

  /// Connection of s light vertices, s = 0 … k + 1.
  double of(size_t s) const;
  /// Merging at vertex i, 0 < i < k.
  double of_merging(size_t i) const;
  /// Weight of of(s).
  double weight(size_t s) const;
  /// Weight of of_merging(i).
  double weight_of_merging(size_t i) const;

 private:
  bool delta(size_t i) const { return i >= 1 && i < k_ && path_.surfaces[i - 1].delta; }
  Vec3 position(size_t i) const;
  Vec3 towards(size_t from, size_t to) const;
  double per_area(size_t from, size_t to) const;
  double cosine(size_t at, size_t other) const;
  void ends();
  void scatter(size_t i);
  double sum_of_squares() const;
  /// Number of samples per pixel of strategy s.
  double samples(size_t s) const;

  const Context& c_;
  const WholePath& path_;
  double eta_;
  size_t least_camera_;
  size_t k_;
  std::vector<double> light_;
  std::vector<double> camera_;
};

}  // namespace relume::testing
