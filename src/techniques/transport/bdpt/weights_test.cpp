// The weights of bidirectional path tracing equal those from all strategies' densities.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "techniques/transport/bdpt/testing/weight_check.h"

namespace relume::testing {
namespace {

TEST(BdptWeights, MatchTheProductsOfAllDensities) {
  int compared[kKinds] = {};
  for (const ZooLight light : kZooLights) {
    if (light == ZooLight::constant) continue;  // found by s = 0 only: a single strategy
    for (const ZooCamera camera : kZooCameras) {
      SCOPED_TRACE(std::string(kZooLightNames[static_cast<int>(light)]) + " " +
                   kZooCameraNames[static_cast<int>(camera)]);
      WeightCheck check(light, camera, LightSelectorKind::power);
      check.run(2048);
      check.expect_few_wrong();
      EXPECT_GT(check.compared[kCameraConnection], 100);
      EXPECT_GT(check.compared[kLightConnection], 30);
      for (int kind = 0; kind < kKinds; ++kind) compared[kind] += check.compared[kind];
    }
  }
  EXPECT_GT(compared[kVertexConnection], 5000);
  EXPECT_GT(compared[kLightMet], 100);
  EXPECT_GT(compared[kLensMet], 100);
}

TEST(BdptWeights, AccountForLightSelectionOfConnections) {
  WeightCheck check(ZooLight::mixed, ZooCamera::pinhole, LightSelectorKind::uniform);
  check.run(4096);
  check.expect_few_wrong();
  EXPECT_GT(check.compared[kLightConnection], 1000);
  EXPECT_GT(check.compared[kLightMet], 10);
}

/// Checks weights with guided subpaths in scenes with different lights and cameras. Returns their number by kind.
std::array<int, kKinds> compare_guided(bool guides_light) {
  std::array<int, kKinds> compared{};
  for (const ZooLight light : {ZooLight::triangles, ZooLight::environment_map, ZooLight::mixed}) {
    for (const ZooCamera camera : {ZooCamera::pinhole, ZooCamera::thin_lens}) {
      SCOPED_TRACE(std::string(kZooLightNames[static_cast<int>(light)]) + " " +
                   kZooCameraNames[static_cast<int>(camera)]);
      GuidedWeightCheck check(light, camera, LightSelectorKind::power);
      if (guides_light) check.guide_light_subpaths();
      check.run(2048);
      check.expect_few_wrong();
      for (int kind = 0; kind < kKinds; ++kind) compared[kind] += check.compared[kind];
    }
  }
  return compared;
}

TEST(BdptWeights, IncludeTheDensitiesOfGuidedCameraSubpaths) {
  const std::array<int, kKinds> compared = compare_guided(false);
  EXPECT_GT(compared[kVertexConnection], 300);
  EXPECT_GT(compared[kCameraConnection], 500);
  EXPECT_GT(compared[kLightConnection], 100);
  EXPECT_GT(compared[kLightMet], 5);
  EXPECT_GT(compared[kLensMet], 5);
}

TEST(BdptWeights, IncludeTheDensitiesOfGuidedLightSubpaths) {
  const std::array<int, kKinds> compared = compare_guided(true);
  EXPECT_GT(compared[kVertexConnection], 200);
  EXPECT_GT(compared[kCameraConnection], 400);
  EXPECT_GT(compared[kLightConnection], 100);
  EXPECT_GT(compared[kLightMet], 5);
  EXPECT_GT(compared[kLensMet], 5);
}

/// A sample of indirect light has a camera subpath of at least three vertices, whatever finds the first of them.
template <typename Check>
std::array<int, kKinds> compare_samples() {
  std::array<int, kKinds> compared{};
  for (const ZooLight light :
       {ZooLight::triangles, ZooLight::point, ZooLight::directional, ZooLight::environment_map, ZooLight::mixed}) {
    for (const ZooCamera camera : {ZooCamera::pinhole, ZooCamera::thin_lens}) {
      SCOPED_TRACE(std::string(kZooLightNames[static_cast<int>(light)]) + " " +
                   kZooCameraNames[static_cast<int>(camera)]);
      Check check(light, camera, LightSelectorKind::power, AssumedNumbers{.least_camera = 3});
      check.run(2048);
      check.expect_few_wrong();
      for (int kind = 0; kind < kKinds; ++kind) compared[kind] += check.compared[kind];
    }
  }
  return compared;
}

TEST(BdptWeights, OfSamplesCountTheStrategiesThatSampleTheSecondVertex) {
  const std::array<int, kKinds> compared = compare_samples<WeightCheck>();
  EXPECT_GT(compared[kVertexConnection], 300);
  EXPECT_GT(compared[kLightConnection], 100);
  EXPECT_GT(compared[kLightMet], 5);
  EXPECT_EQ(compared[kCameraConnection] + compared[kLensMet], 0);
}

TEST(BdptWeights, OfSamplesIncludeTheDensitiesOfGuidedCameraSubpaths) {
  const std::array<int, kKinds> compared = compare_samples<GuidedWeightCheck>();
  EXPECT_GT(compared[kVertexConnection], 100);
  EXPECT_GT(compared[kLightConnection], 50);
}

/// For pixels whose samples and splats come from different frames.
TEST(BdptWeights, CanIgnoreGuiding) {
  for (const bool guides_light : {false, true}) {
    GuidedWeightCheck check(ZooLight::mixed, ZooCamera::thin_lens, LightSelectorKind::power);
    check.context().weighs_guide = false;
    if (guides_light) check.guide_light_subpaths();
    check.run(2048);
    check.expect_few_wrong();
    EXPECT_GT(check.compared[kVertexConnection], 50);
    EXPECT_GT(check.compared[kCameraConnection], 100);
  }
}

/// Light vertices would have to draw their chains again for every connection, so weights do without.
TEST(BdptWeights, IgnoreTheDensitiesOfChains) {
  for (const ZooCamera camera : {ZooCamera::pinhole, ZooCamera::thin_lens}) {
    GuidedWeightCheck check(ZooLight::mixed, camera, LightSelectorKind::power);
    check.guide_by_chains();
    check.run(2048);
    check.expect_few_wrong();
    EXPECT_GT(check.guided, 200);
    EXPECT_GT(check.compared[kVertexConnection], 50);
    EXPECT_GT(check.compared[kCameraConnection], 100);
    EXPECT_GT(check.compared[kLightConnection], 30);
  }
}

/// Light subpaths cannot evaluate a selector that depends on the camera vertex.
TEST(BdptWeights, AssumeAProbabilityOfLightsThatDoesNotDependOnTheVertex) {
  BdptFrame frame(make_zoo(ZooLight::mixed, ZooCamera::pinhole), {});
  BdptContext c = frame.context();
  for (const LightSelectorKind kind :
       {LightSelectorKind::light_tree, LightSelectorKind::cache, LightSelectorKind::markov_chains}) {
    c.path.selector.kind = kind;
    float sum = 0;
    for (LightId light = 0; light < c.scene().lights.lights.size; ++light) {
      EXPECT_EQ(weighting_pmf(c, light), c.connection.pmf(light));
      sum += weighting_pmf(c, light);
    }
    EXPECT_NEAR(sum, 1, 1e-4f);
  }
}

}  // namespace
}  // namespace relume::testing
