// Compares the incremental weights of the subpaths with weights from all strategies' densities of the whole path.
#pragma once

#include <optional>
#include <string>

#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "techniques/transport/bdpt/testing/random_guides.h"
#include "techniques/transport/bdpt/testing/whole_path.h"

namespace relume::testing {

enum Strategy : int { kVertexConnection, kCameraConnection, kLightConnection, kLightMet, kLensMet, kMerging, kKinds };

/// Numbers of samples that the weights assume, and of the strategies that they count.
struct AssumedNumbers {
  float eta = 0;              ///< π r² n of vertex merging, m²; 0: no merging
  float light_paths = 1;      ///< per pixel
  float connections = 1;      ///< between surfaces, per strategy
  uint32_t least_camera = 0;  ///< minimum vertices of camera subpaths, 3 for samples of indirect light; 0: any
};

/// Compares the weights of all strategies on random paths of one scene. In a LearningContext, random quadtrees guide
/// the camera subpaths, in regions looked up with jitter.
template <typename Context>
class WeightCheckOf {
 public:
  WeightCheckOf(ZooLight light, ZooCamera camera, LightSelectorKind selector, const AssumedNumbers& numbers = {});
  virtual ~WeightCheckOf() = default;

  Context& context() { return c_; }
  /// Also guides the light subpaths, by other quadtrees. Only in a LearningContext.
  void guide_light_subpaths() {
    if constexpr (Context::kLearns) guides_->guide_light_subpaths(c_);
  }
  /// Lets Markov chains with random lobes guide the camera subpaths instead. Weights then assume the density of the
  /// BSDF. Only in a LearningContext.
  void guide_by_chains();
  void run(uint32_t samples);
  /// Allows for rounding: a direction may fall into the neighbouring texel of an environment, or leaf of a quadtree,
  /// which has another density.
  void expect_few_wrong() const;

  int compared[kKinds] = {};
  int wrong[kKinds] = {};
  int guided = 0;       ///< vertices of camera subpaths around which chains have lobes
  std::string example;  ///< last wrong weight

 protected:
  /// Compares the weights of other strategies on paths that contain both subpaths up to vertices s and t.
  virtual void more(const TracedLight& /*light*/, size_t /*s*/, const TracedCamera& /*camera*/, size_t /*t*/) {}

  /// The path from `places` vertices of the light subpath and `camera_places` of the camera subpath, of which the last
  /// two do not scatter by delta lobes.
  WholePath joined(const TracedLight& light, size_t places, const TracedCamera& camera, size_t camera_places) const;
  Densities<Context> densities(const WholePath& path) const {
    return {c_, path, static_cast<double>(numbers_.eta), numbers_.least_camera};
  }
  void compare(float weight, double expected, const WholePath& path, size_t s, Strategy kind);

 private:
  WholePath from(const TracedLight& t, size_t places) const;
  Vec2 barycentric(const TracedLight& t) const;
  /// Fills the cells around a vertex, if chains guide the subpaths.
  void fill_chains(const SurfacePoint& sp);
  void set_camera(WholePath& path, const Vec3& position) const;
  void to_vertex(const TracedLight& light, size_t s, const TracedCamera& camera, size_t t);
  void to_camera(const TracedLight& light, size_t s, Sampler& sampler);
  void to_light(const TracedCamera& camera, size_t t, Sampler& sampler);
  void light_met(const TracedCamera& camera, size_t t);
  WholePath path_to_light(const TracedCamera& camera, size_t places, LightId id, const EmitterPoint& on_light,
                          const Vec3& from_light) const;

  AssumedNumbers numbers_;
  BdptFrame frame_;
  std::optional<RandomGuides> guides_;  ///< none unless the context learns
  FilledTable<GuideState> chains_;
  Context c_;
};

using WeightCheck = WeightCheckOf<BdptContext>;
using GuidedWeightCheck = WeightCheckOf<LearningContext>;

}  // namespace relume::testing
