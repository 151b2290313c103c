// Compares bidirectional path tracing, light tracing, and vertex connection and merging with path tracing.
#include <gtest/gtest.h>

#include <string>

#include "builtin_scenes/builtin.h"
#include "support/image_test.h"
#include "support/test_name.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::support {
namespace {

using testing::ZooCamera;
using testing::ZooLight;

constexpr int kSeeds = 16;

/// Path tracing cannot sample paths from point or directional lights via mirrors or smooth glass.
bool delta_light(ZooLight light) {
  return light == ZooLight::point || light == ZooLight::spot || light == ZooLight::directional ||
         light == ZooLight::mixed;
}

struct ZooCase {
  ZooLight light = {};
  ZooCamera camera = {};
  int size = 24;  ///< in pixels
};
constexpr int kQuickSize = 16;  // fewer pixels of the same precision

/// Every light with a pinhole, and every other camera with each of `others`.
std::vector<ZooCase> zoo_cases(const std::vector<ZooLight>& others) {
  std::vector<ZooCase> cases;
  for (const ZooLight light : testing::kZooLights) cases.push_back({light, ZooCamera::pinhole, kQuickSize});
  for (const ZooCamera camera : {ZooCamera::thin_lens, ZooCamera::orthographic, ZooCamera::panoramic}) {
    for (const ZooLight light : others) {
      // A panorama shows the lamp in few pixels, and needs them.
      cases.push_back({light, camera, camera == ZooCamera::panoramic ? ZooCase{}.size : kQuickSize});
    }
  }
  return cases;
}
const std::vector<ZooLight> kOneOfAKind{ZooLight::two_sided, ZooLight::environment_map, ZooLight::directional};

/// Every light with a pinhole and a lamp with every camera, except plain triangles, which BdptLayers has in this scene.
std::vector<ZooCase> bidirectional_cases() {
  std::vector<ZooCase> cases = zoo_cases({ZooLight::two_sided});
  std::erase_if(cases, [](const ZooCase& c) { return c.light == ZooLight::triangles; });
  return cases;
}

/// A lamp with every projection, and lights of one kind each with a pinhole; `mixed` has a lamp, two of these and a
/// map.
std::vector<ZooCase> light_tracing_cases() {
  std::vector<ZooCase> cases;
  for (const ZooCase& c : zoo_cases({ZooLight::two_sided})) {
    const bool is_chosen = c.light == ZooLight::two_sided || c.light == ZooLight::point ||
                           c.light == ZooLight::directional || c.light == ZooLight::mixed;
    if (is_chosen && c.camera != ZooCamera::thin_lens) cases.push_back(c);
  }
  return cases;
}

/// Every light with every camera.
std::vector<ZooCase> zoo_grid() {
  std::vector<ZooCase> cases;
  for (const ZooCamera camera : testing::kZooCameras) {
    for (const ZooLight light : testing::kZooLights) {
      // The sun covers part of a pixel and outshines the remainder of a panorama.
      if (light != ZooLight::sun_sky || camera != ZooCamera::panoramic) cases.push_back({light, camera});
    }
  }
  return cases;
}

std::string zoo_name(const ::testing::TestParamInfo<ZooCase>& info) {
  return std::string(testing::kZooLightNames[static_cast<int>(info.param.light)]) + "_" +
         testing::kZooCameraNames[static_cast<int>(info.param.camera)];
}

class BdptZoo : public ::testing::TestWithParam<ZooCase> {};
class BdptLightZoo : public BdptZoo {};

TEST_P(BdptZoo, AgreesWithPathTracing) {
  const Scene scene = testing::make_zoo(GetParam().light, GetParam().camera, !delta_light(GetParam().light));
  RenderSettings path = small_settings(GetParam().size, GetParam().size);
  RenderSettings bdpt = path;
  bdpt.estimator = EstimatorChoice::bdpt;
  // A panorama shows the lamp in few pixels, which a sample hits or misses.
  const bool lamp_in_view = GetParam().camera == ZooCamera::panoramic && GetParam().light == ZooLight::two_sided;
  expect_same_image("bdpt-" + zoo_name({GetParam(), 0}), measure(scene, path, 96, kSeeds, 1),
                    measure(scene, bdpt, 48, kSeeds, 1001),
                    {.block_size = GetParam().size * 2 / 3,
                     .detectable = lamp_in_view ? 0.3 : 0.1,
                     .detectable_mean = lamp_in_view ? 0.25 : 0.05});
}

TEST_P(BdptLightZoo, LightTracingAgreesWithPathTracing) {
  // Without visible smooth surfaces and shading normals, light tracing renders the complete image.
  const Scene scene = testing::make_zoo(GetParam().light, GetParam().camera, false, false);
  RenderSettings path = small_settings(GetParam().size, GetParam().size);
  RenderSettings light = path;
  light.estimator = EstimatorChoice::light;
  // Sharp shadow edges under parallel light and parallel rays: with fewer samples, 16 images do not determine the
  // variance of pixels along them.
  const bool parallel_rays = GetParam().camera == ZooCamera::orthographic;
  const bool sharp = GetParam().light == ZooLight::directional && parallel_rays;
  // Pixels in the lamp's shadow receive few, bright light paths: over 64 images, their standard deviation is most of
  // their mean.
  const bool rare = GetParam().light == ZooLight::point && parallel_rays;
  expect_same_image("light-" + zoo_name({GetParam(), 0}),
                    measure(scene, path, sharp ? 384 : 192, kSeeds, sharp ? 501 : 1),
                    measure(scene, light, sharp ? 512 : 256, kSeeds, sharp ? 2001 : 1001),
                    {.pixels = !rare, .block_size = GetParam().size * 2 / 3});
}
// BdptWeights compares the densities of all pairs.
INSTANTIATE_TEST_SUITE_P(Zoo, BdptZoo, ::testing::ValuesIn(bidirectional_cases()), zoo_name);
INSTANTIATE_TEST_SUITE_P(SlowZoo, BdptZoo, ::testing::ValuesIn(zoo_cases(kOneOfAKind)), zoo_name);
INSTANTIATE_TEST_SUITE_P(Zoo, BdptLightZoo, ::testing::ValuesIn(light_tracing_cases()), zoo_name);
INSTANTIATE_TEST_SUITE_P(SlowZoo, BdptLightZoo, ::testing::ValuesIn(zoo_grid()), zoo_name);

/// A built-in scene with its image size, time, and samples per estimator. 0 samples disable light tracing: the scene
/// has visible smooth surfaces, or (mine) almost no light path reaches the view.
struct BuiltinCase {
  const char* scene;
  int width;
  int height;
  float time_s;
  int path;
  int bdpt;
  int light;
  bool rare = false;    ///< rare, bright paths dominate path tracing: compares blocks, not pixels
  double blocks = 0.1;  ///< ImageTestOptions::detectable
  double mean = 0.05;   ///< ImageTestOptions::detectable_mean
};

// Excludes scenes whose blocks need more than seconds of sampling, and cornell-closed, which resembles cornell. The
// slow test includes them, and BidirectionalLights compares less noisy light selections in the warehouse.
const BuiltinCase kQuick[] = {
    {"cornell", 32, 32, 0, 64, 32, 64}, {"turntable", 32, 18, 1.3f, 32, 16, 32}, {"furnace", 24, 24, 0, 4, 4, 32}};

const BuiltinCase kSharp[] = {{"cornell", 32, 32, 0, 512, 256, 512},
                              {"cornell-closed", 32, 32, 0, 512, 256, 512},
                              {"cornell-spheres", 32, 32, 0, 1024, 64, 0},
                              {"cornell-mirror", 32, 32, 0, 1024, 64, 0},
                              {"cornell-water", 32, 32, 0, 2048, 256, 0, true, 0.15, 0.06},
                              {"cornell-glass", 32, 32, 0, 2048, 256, 0, true},
                              {"corridor", 32, 32, 0, 256, 128, 256, false, 0.35, 0.17},
                              {"warehouse", 48, 27, 0, 128, 64, 256, false, 0.35, 0.16},
                              {"turntable", 48, 27, 1.3f, 256, 128, 256},
                              {"slit", 48, 27, 0.7f, 128, 64, 256},
                              {"door", 32, 24, 0, 256, 128, 0},
                              {"mine", 48, 27, 0, 128, 64, 0},
                              {"lamp-room", 32, 24, 0, 1024, 64, 0, true},
                              {"cover", 48, 27, 0, 1024, 512, 0, true},
                              {"city", 48, 27, 0, 256, 128, 0}};

std::string builtin_name(const ::testing::TestParamInfo<BuiltinCase>& info) { return test_name(info.param.scene); }

class BdptBuiltin : public ::testing::TestWithParam<BuiltinCase> {};

TEST_P(BdptBuiltin, AgreesWithPathTracing) {
  const BuiltinCase& c = GetParam();
  const Scene scene = find_builtin_scene(c.scene)->build();
  RenderSettings settings = small_settings(c.width, c.height);
  settings.time_s = c.time_s;
  const Moments path = measure(scene, settings, c.path, kSeeds, 1);
  settings.estimator = EstimatorChoice::bdpt;
  expect_same_image(std::string("bdpt-") + c.scene, path, measure(scene, settings, c.bdpt, kSeeds, 1001),
                    {.pixels = !c.rare, .detectable = c.blocks, .detectable_mean = c.mean});
  if (c.light == 0) return;
  settings.estimator = EstimatorChoice::light;
  expect_same_image(std::string("light-") + c.scene, path, measure(scene, settings, c.light, kSeeds, 2001),
                    {.detectable = c.blocks, .detectable_mean = c.mean});
}
INSTANTIATE_TEST_SUITE_P(Builtin, BdptBuiltin, ::testing::ValuesIn(kQuick), builtin_name);
INSTANTIATE_TEST_SUITE_P(SlowBuiltin, BdptBuiltin, ::testing::ValuesIn(kSharp), builtin_name);

/// A built-in scene for vertex connection and merging. Merging needs a radius with several light vertices per disc,
/// also in small images.
struct MergingCase {
  const char* scene;
  int width;
  int height;
  float time_s;
  int path;  ///< samples per pixel of path tracing
  int vcm;   ///< the same for vertex connection and merging
  float radius;
  double blocks = 0.1;  ///< ImageTestOptions::detectable
  double mean = 0.05;   ///< ImageTestOptions::detectable_mean
};

const MergingCase kQuickMerging[] = {{"cornell", 32, 32, 0, 64, 32, 0.02f},
                                     {"turntable", 32, 18, 1.3f, 32, 16, 0.005f}};

// Excludes cornell-water and cornell-glass: path tracing lacks most of the light that only merging finds.
const MergingCase kSharpMerging[] = {{"cornell", 32, 32, 0, 512, 256, 0.02f},
                                     {"cornell-closed", 32, 32, 0, 512, 256, 0.02f},
                                     {"cornell-spheres", 32, 32, 0, 1024, 64, 0.01f},
                                     {"cornell-mirror", 32, 32, 0, 1024, 64, 0.01f},
                                     {"corridor", 32, 32, 0, 256, 128, 0.003f, 0.35, 0.17},
                                     {"turntable", 48, 27, 1.3f, 256, 128, 0.005f},
                                     {"door", 32, 24, 0, 256, 128, 0.003f}};

class VcmBuiltin : public ::testing::TestWithParam<MergingCase> {};

TEST_P(VcmBuiltin, AgreesWithPathTracing) {
  const MergingCase& c = GetParam();
  const Scene scene = find_builtin_scene(c.scene)->build();
  RenderSettings settings = small_settings(c.width, c.height);
  settings.time_s = c.time_s;
  const Moments path = measure(scene, settings, c.path, kSeeds, 1);
  settings.estimator = EstimatorChoice::vcm;
  settings.vcm.radius = c.radius;
  // The blur of merging is a bias, largest for pixels at edges.
  expect_same_image(std::string("vcm-") + c.scene, path, measure(scene, settings, c.vcm, kSeeds, 1001),
                    {.pixels = false, .tolerance = 0.02, .detectable = c.blocks, .detectable_mean = c.mean});
}

std::string merging_name(const ::testing::TestParamInfo<MergingCase>& info) { return test_name(info.param.scene); }
INSTANTIATE_TEST_SUITE_P(Builtin, VcmBuiltin, ::testing::ValuesIn(kQuickMerging), merging_name);
INSTANTIATE_TEST_SUITE_P(SlowBuiltin, VcmBuiltin, ::testing::ValuesIn(kSharpMerging), merging_name);

}  // namespace
}  // namespace relume::support
