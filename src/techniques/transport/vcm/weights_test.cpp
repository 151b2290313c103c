// The weights of vertex connection and merging equal those from the densities of all strategies, so they sum to one.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "techniques/transport/bdpt/testing/weight_check.h"
#include "techniques/transport/vcm/merging.h"

namespace relume::testing {
namespace {

/// Also compares the weights of merging, on paths whose subpaths are joined by the segment between two vertices.
template <typename Context>
class MergingCheckOf : public WeightCheckOf<Context> {
 public:
  using WeightCheckOf<Context>::WeightCheckOf;
  using WeightCheckOf<Context>::context;

 protected:
  using WeightCheckOf<Context>::joined;

  void more(const TracedLight& light, size_t s, const TracedCamera& camera, size_t t) override {
    const Vec3 d = light.places[s - 1].position - camera.places[t - 1].position;
    if (!(length_squared(d) > 1e-3f)) return;
    at_light_vertex(light, s, camera, t, d);
    at_camera_vertex(light, s, camera, t, d);
  }

 private:
  /// Continues the camera subpath by `d` to vertex `s` of the light subpath, and merges there.
  void at_light_vertex(const TracedLight& light, size_t s, const TracedCamera& camera, size_t t, const Vec3& d) {
    const LightSubpath& l = light.states[s - 1];
    const SurfacePoint y = seen(context(), light.places[s - 1], -l.path.ray.direction);
    CameraSubpath e = camera.states[t - 1];
    const SurfacePoint z = seen(context(), camera.places[t - 1], -e.path.ray.direction);
    const Vec3 w = glm::normalize(d);
    const BsdfEval scattered = eval_camera_vertex(context(), e, z, w);
    if (!has_non_delta(y.bsdf) || !has_non_delta(z.bsdf) || is_black(scattered.f)) return;
    e.weights.leave(std::fabs(glm::dot(z.ng, w)), scattered.pdf_forward, scattered.pdf_reverse);
    const SurfacePoint sp = seen(context(), light.places[s - 1], -w);
    e.weights.arrive(std::fabs(glm::dot(sp.ng, w)), length_squared(d));
    merge(e, sp, make_path_vertex(y, Rgb(1), l.weights.at(), Dispersion::none), joined(light, s, camera, t), s);
  }

  /// Continues the light subpath by −`d` to vertex `t` of the camera subpath, and merges there.
  void at_camera_vertex(const TracedLight& light, size_t s, const TracedCamera& camera, size_t t, const Vec3& d) {
    LightSubpath l = light.states[s - 1];
    const SurfacePoint y = seen(context(), light.places[s - 1], -l.path.ray.direction);
    const CameraSubpath& e = camera.states[t - 1];
    const SurfacePoint z = seen(context(), camera.places[t - 1], -e.path.ray.direction);
    const Vec3 w = -glm::normalize(d);
    if (!has_non_delta(y.bsdf) || !has_non_delta(z.bsdf)) return;
    const AdjointEval scattered = eval_light_vertex(context(), y, w);
    if (!(scattered.pdf_light > 0.0f)) return;
    l.weights.leave(std::fabs(glm::dot(y.ng, w)), scattered.pdf_light, scattered.pdf_camera);
    const SurfacePoint sp = seen(context(), camera.places[t - 1], -w);
    l.weights.arrive(std::fabs(glm::dot(sp.ng, w)), length_squared(d));
    merge(e, z, make_path_vertex(sp, Rgb(1), l.weights.at(), Dispersion::none), joined(light, s, camera, t), s + 1);
  }

  void merge(const CameraSubpath& e, const SurfacePoint& sp, const PathVertex& v, const WholePath& path, size_t i) {
    const BsdfEval bsdf = eval_camera_vertex(context(), e, sp, v.wo);
    if (is_black(bsdf.f)) return;
    this->compare(weight_of_merging(e, bsdf, v), this->densities(path).weight_of_merging(i), path, i, kMerging);
  }
};
using MergingCheck = MergingCheckOf<BdptContext>;
using GuidedMergingCheck = MergingCheckOf<LearningContext>;

TEST(VcmWeights, MatchTheProductsOfAllDensities) {
  int compared[kKinds] = {};
  for (const ZooLight light : {ZooLight::triangles, ZooLight::two_sided, ZooLight::point, ZooLight::directional,
                               ZooLight::environment_map, ZooLight::mixed}) {
    for (const ZooCamera camera : kZooCameras) {
      SCOPED_TRACE(std::string(kZooLightNames[static_cast<int>(light)]) + " " +
                   kZooCameraNames[static_cast<int>(camera)]);
      MergingCheck check(light, camera, LightSelectorKind::power, {.eta = 2.0f});
      check.run(512);
      check.expect_few_wrong();
      for (int kind = 0; kind < kKinds; ++kind) compared[kind] += check.compared[kind];
    }
  }
  EXPECT_GT(compared[kVertexConnection], 500);
  EXPECT_GT(compared[kCameraConnection], 500);
  EXPECT_GT(compared[kLightConnection], 150);
  EXPECT_GT(compared[kLightMet], 10);
  EXPECT_GT(compared[kLensMet], 10);
  EXPECT_GT(compared[kMerging], 2000);
}

TEST(VcmWeights, IncludeTheDensitiesOfGuidedCameraSubpaths) {
  for (const ZooLight light : {ZooLight::triangles, ZooLight::mixed}) {
    GuidedMergingCheck check(light, ZooCamera::thin_lens, LightSelectorKind::power, {.eta = 2.0f});
    check.run(2048);
    check.expect_few_wrong();
    EXPECT_GT(check.compared[kVertexConnection], 50);
    EXPECT_GT(check.compared[kMerging], 200);
  }
}

TEST(VcmWeights, IncludeTheDensitiesOfGuidedLightSubpaths) {
  for (const ZooLight light : {ZooLight::triangles, ZooLight::mixed}) {
    GuidedMergingCheck check(light, ZooCamera::thin_lens, LightSelectorKind::power, {.eta = 2.0f});
    check.guide_light_subpaths();
    check.run(2048);
    check.expect_few_wrong();
    EXPECT_GT(check.compared[kVertexConnection], 40);
    EXPECT_GT(check.compared[kMerging], 150);
  }
}

TEST(VcmWeights, IgnoreTheDensitiesOfChains) {
  for (const ZooLight light : {ZooLight::triangles, ZooLight::mixed}) {
    GuidedMergingCheck check(light, ZooCamera::thin_lens, LightSelectorKind::power, {.eta = 2.0f});
    check.guide_by_chains();
    check.run(2048);
    check.expect_few_wrong();
    EXPECT_GT(check.guided, 200);
    EXPECT_GT(check.compared[kVertexConnection], 50);
    EXPECT_GT(check.compared[kMerging], 200);
  }
}

/// A sample of indirect light has a camera subpath of at least three vertices, and may merge at the third.
TEST(VcmWeights, OfSamplesCountTheStrategiesThatSampleTheSecondVertex) {
  for (const ZooLight light : {ZooLight::triangles, ZooLight::point, ZooLight::mixed}) {
    for (const float connections : {1.0f, 2.0f}) {
      MergingCheck check(light, ZooCamera::pinhole, LightSelectorKind::power,
                         {.eta = 2.0f, .light_paths = 0.5f, .connections = connections, .least_camera = 3});
      check.run(2048);
      check.expect_few_wrong();
      EXPECT_GT(check.compared[kVertexConnection], 20);
      EXPECT_GT(check.compared[kLightConnection], 10);
      EXPECT_GT(check.compared[kMerging], 100);
    }
  }
}

TEST(VcmWeights, AccountForTheNumbersOfSamples) {
  for (const AssumedNumbers& numbers :
       {AssumedNumbers{.eta = 0.3f, .light_paths = 0.25f}, AssumedNumbers{.eta = 0.3f, .connections = 0.4f},
        AssumedNumbers{.eta = 0.3f, .light_paths = 1.0f / 3.0f, .connections = 2}}) {
    MergingCheck check(ZooLight::mixed, ZooCamera::thin_lens, LightSelectorKind::power, numbers);
    check.run(2048);
    check.expect_few_wrong();
    EXPECT_GT(check.compared[kCameraConnection], 100);
    EXPECT_GT(check.compared[kLensMet], 0);
    EXPECT_GT(check.compared[kMerging], 200);
  }
}

}  // namespace
}  // namespace relume::testing
