#include "lights/sample_lights.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "scene/testing/light_scene.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::LightScene;
using testing::Random;

bool is_wide(const LightsView& view, const LightRequest& r) {
  const Light& light = view.lights[r.light];
  return light.kind == LightKind::triangle && light.triangle.emission_cosine(r.position - light.triangle.v0) > 0.0f &&
         is_wide(light.triangle, light.triangle.v0 - r.position, view.wide_triangle);
}

/// Counts samples that differ from those of sample_li().
int differences(const LightsView& view, const std::vector<LightRequest>& requests) {
  std::vector<LightSample> samples(requests.size());
  sample_lights(view, view_of(requests), samples.data());
  int different = 0;
  for (size_t i = 0; i < requests.size(); ++i) {
    const LightSample alone = sample_li(view, requests[i].light, requests[i].position, requests[i].u);
    const LightSample& s = samples[i];
    const bool equal = s.wi == alone.wi && s.distance == alone.distance && s.clearance == alone.clearance &&
                       s.radiance == alone.radiance && s.pdf_w == alone.pdf_w && s.delta == alone.delta &&
                       s.position == alone.position && s.normal == alone.normal && s.barycentric == alone.barycentric;
    different += equal ? 0 : 1;
  }
  return different;
}

TEST(SampleLights, EqualsSamplesOneByOne) {
  const LightScene scene = testing::make_light_scene(testing::noise_environment(24, 12));
  const LightsView& view = scene.lights();
  Random random(5);
  int wide[2] = {};
  for (uint32_t count = 0; count <= 64; ++count) {
    std::vector<LightRequest> requests(count);
    for (LightRequest& r : requests) {
      const float u = random.next();
      r.light = std::min(static_cast<uint32_t>(u * static_cast<float>(view.lights.size)), view.lights.size - 1);
      r.position = random.point(2);
      r.u = random.next_2d();
      if (is_wide(view, r)) ++wide[view.lights[r.light].triangle.is_parallelogram ? 1 : 0];
    }
    EXPECT_EQ(differences(view, requests), 0) << count << " lights";
  }
  EXPECT_GT(wide[0], 100);
  EXPECT_GT(wide[1], 50);
}

}  // namespace
}  // namespace relume
