// Tests that subpaths leave the direct light of primary hits to reservoirs, and record what reservoirs need.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "techniques/transport/bdpt/testing/bdpt_frame.h"

namespace relume::testing {
namespace {

constexpr int kEdge = 24;

/// A box without delta lobes, seen through a lens that light subpaths can meet.
Scene box_behind_lens() {
  Scene scene = find_builtin_scene("cornell")->build();
  scene.cameras[0].lens_radius = 0.5f;
  scene.cameras[0].focus_distance = 10;
  return scene;
}

/// Mean of 16 samples per pixel.
std::vector<Rgb> traced(const Scene& scene, bool light_only, uint32_t max_bounces, uint32_t first_nee_bounce) {
  const BdptOptions options{.width = kEdge,
                            .height = kEdge,
                            .max_bounces = max_bounces,
                            .light_only = light_only,
                            .first_nee_bounce = first_nee_bounce};
  return render_bdpt(Scene(scene), options, 16);
}

class DirectLight : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(LightOnly, DirectLight, ::testing::Bool());

TEST_P(DirectLight, IsLeftOutByEveryStrategy) {
  const Scene scene = box_behind_lens();
  const std::vector<Rgb> lamp = traced(scene, GetParam(), 0, 0);
  EXPECT_EQ(traced(scene, GetParam(), 1, 1), lamp);
  EXPECT_NE(traced(scene, GetParam(), 1, 0), lamp);
  EXPECT_NE(traced(scene, GetParam(), 2, 1), lamp) << "light of the second bounce remains";
}

/// No selection samples a constant environment, so reservoirs do not take it.
TEST_P(DirectLight, OfAConstantEnvironmentRemains) {
  const Scene scene = find_builtin_scene("furnace")->build();
  EXPECT_EQ(traced(scene, GetParam(), 1, 1), traced(scene, GetParam(), 1, 0));
}

TEST(DirectLightInMirrors, Remains) {
  const Scene scene = find_builtin_scene("cornell-mirror")->build();
  EXPECT_NE(traced(scene, false, 1, 1), traced(scene, false, 0, 0));
}

TEST_P(DirectLight, HasRecordsOfFirstDirections) {
  BdptFrame frame(find_builtin_scene("cornell")->build(),
                  {.width = kEdge, .height = kEdge, .max_bounces = 2, .light_only = GetParam(), .first_nee_bounce = 1});
  std::vector<FirstScatter> scatters(frame.hits.size());
  BdptContext context = frame.context();
  context.first_scatters = mutable_view_of(scatters);
  int lamps = 0;
  int open = 0;
  for (uint32_t sample = 0; sample < 64; ++sample) {
    frame.run_in(context, 1, sample);
    for (size_t p = 0; p < scatters.size(); ++p) {
      const FirstScatter& s = scatters[p];
      if (!(s.pdf_w > 0.0f)) continue;
      ASSERT_TRUE(frame.hits[p].valid());
      ASSERT_NEAR(glm::length(s.direction), 1, 1e-5f);
      if (s.light == kNoLight) {
        ++open;  // through the box's front
      } else {
        ++lamps;
        ASSERT_LT(s.light, frame.compiled.view().lights.lights.size);
      }
    }
  }
  EXPECT_GT(lamps, 100);
  EXPECT_GT(open, 100);
}

TEST_P(DirectLight, HasNoRecordsWithoutAPath) {
  BdptFrame frame(find_builtin_scene("cornell")->build(), {.light_only = GetParam(), .first_nee_bounce = 1});
  frame.allocation.assign(frame.hits.size(), 0);
  std::vector<FirstScatter> scatters(frame.hits.size(), FirstScatter{.pdf_w = 1});
  BdptContext context = frame.context();
  context.first_scatters = mutable_view_of(scatters);
  frame.run_in(context, 1, 0);
  for (const FirstScatter& s : scatters) EXPECT_EQ(s.pdf_w, 0.0f);
}

}  // namespace
}  // namespace relume::testing
