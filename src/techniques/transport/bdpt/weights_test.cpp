// The weights of bidirectional path tracing equal those from all strategies' densities.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace relume::testing
