#include "techniques/transport/path/path_policy.h"

#include <gtest/gtest.h>

#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/specular_part.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 40;
constexpr uint32_t kHeight = 30;
constexpr uint32_t kPixels = kWidth * kHeight;

/// Darkens paths at surfaces of odd instances, and ends every third path there.
struct SteeringPolicy : NoPolicy {
  bool reached = false;  ///< whether the path reached such a surface
  bool arrives = false;  ///< whether it reached one in this step
  bool ends_here = false;

  bool arrived(const SurfacePoint& sp, PathState& path) {
    arrives = sp.instance % 2 == 1;
    if (!arrives) return true;
    reached = true;
    path.throughput *= 0.5f;
    return true;
  }
  bool goes_on(PathState&) { return !arrives || !ends_here; }
};

struct SteeringOutput {
  using Policy = SteeringPolicy;

  View<uint32_t> reached;

  SteeringPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    SteeringPolicy policy;
    policy.ends_here = pixel % 3 == 0;
    return policy;
  }
  void finish(uint32_t pixel, const SteeringPolicy& policy, const PathState&) const { reached[pixel] = policy.reached; }
  void leave_out(uint32_t) const {}
};

struct Traced {
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
  std::vector<uint32_t> reached = std::vector<uint32_t>(kPixels);
  std::vector<FirstVertex> vertices = std::vector<FirstVertex>(kPixels);
  std::vector<Rgb> specular = std::vector<Rgb>(kPixels);

  RadianceOutput radiance_output() { return {mutable_view_of(radiance)}; }
  SteeringOutput steering_output() { return {mutable_view_of(reached)}; }
  FirstVertexOutput vertex_output() { return {mutable_view_of(vertices)}; }
  SpecularOutput specular_output() { return {mutable_view_of(specular)}; }
};

class PathPolicies : public ::testing::TestWithParam<uint32_t> {
 protected:
  template <typename... Outputs>
  void trace(const Outputs&... outputs) const {
    testing::trace_pixels(scene_, {.width = kWidth, .height = kHeight, .tile_size = GetParam(), .max_bounces = 4},
                          outputs...);
  }

  const CompiledScene scene_{find_builtin_scene("cornell-spheres")->build(),
                             CompileOptions{.camera = {}, .width = kWidth, .height = kHeight}};
};

TEST_P(PathPolicies, WatchingPoliciesDoNotChangeSteeredPaths) {
  Traced alone;
  trace(alone.radiance_output(), alone.steering_output());
  Traced watched;
  trace(watched.radiance_output(), watched.vertex_output(), watched.specular_output(), watched.steering_output());
  EXPECT_EQ(watched.radiance, alone.radiance);
  EXPECT_EQ(watched.reached, alone.reached);
  Traced steering_first;
  trace(steering_first.steering_output(), steering_first.radiance_output(), steering_first.vertex_output(),
        steering_first.specular_output());
  EXPECT_EQ(steering_first.radiance, alone.radiance);
}

TEST_P(PathPolicies, WatchingPoliciesAreBitExactWithoutSteering) {
  Traced vertices_alone;
  trace(vertices_alone.radiance_output(), vertices_alone.vertex_output());
  Traced specular_alone;
  trace(specular_alone.radiance_output(), specular_alone.specular_output());
  Traced all;
  trace(all.radiance_output(), all.vertex_output(), all.specular_output(), all.steering_output());
  uint32_t same = 0;
  uint32_t different = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const FirstVertex& a = vertices_alone.vertices[i];
    const FirstVertex& b = all.vertices[i];
    const bool equal = a.indirect == b.indirect && a.direct == b.direct && a.scatter == b.scatter &&
                       a.to_light == b.to_light && a.light == b.light &&
                       specular_alone.specular[i] == all.specular[i] && specular_alone.radiance[i] == all.radiance[i];
    if (all.reached[i]) {
      different += equal ? 0u : 1u;
    } else {
      ASSERT_TRUE(equal) << i;
      same += is_black(all.radiance[i]) ? 0u : 1u;
    }
  }
  EXPECT_GT(same, kPixels / 20);
  EXPECT_GT(different, kPixels / 4);
}

INSTANTIATE_TEST_SUITE_P(Forms, PathPolicies, ::testing::Values(0u, kTileSize));

}  // namespace
}  // namespace relume
