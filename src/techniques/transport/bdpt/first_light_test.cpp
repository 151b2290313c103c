#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "techniques/transport/bdpt/first_light_kernel.h"
#include "techniques/transport/bdpt/testing/bdpt_frame.h"

namespace relume::testing {
namespace {

const Vec3 kA(1, 0, 0);
const Vec3 kB(0, 1, 0);

/// The record of one pixel.
struct OnePixel {
  FirstLight light(uint32_t seed) {
    chosen = 0;
    return {.vertices = {&vertex, 1}, .chosen = {&chosen, 1}, .seed = seed};
  }
  Vec3 direction() const { return unpack_direction(static_cast<uint32_t>(chosen)); }

  FirstVertex vertex;
  uint64_t chosen = 0;
};

TEST(FirstLight, ChoosesInProportionToTheContribution) {
  constexpr int kChoices = 20000;
  OnePixel pixel;
  int b = 0;
  for (uint32_t seed = 0; seed < kChoices; ++seed) {
    const FirstLight light = pixel.light(seed);
    light.offer(0, kA, Rgb(1), 5);
    light.offer(0, kB, Rgb(3), 6);
    b += pixel.direction().y > 0.9f ? 1 : 0;
  }
  EXPECT_NEAR(b, 0.75 * kChoices, 5 * 61);  // a standard deviation of 61
}

TEST(FirstLight, DependsNeitherOnTheOrderNorOnTheScaleOfSplats) {
  OnePixel pixel;
  for (uint32_t seed = 0; seed < 200; ++seed) {
    FirstLight light = pixel.light(seed);
    light.offer(0, kA, Rgb(1), 5);
    light.offer(0, kB, Rgb(2), 6);
    const uint64_t first = pixel.chosen;
    light = pixel.light(seed);
    light.splat_scale = 4;
    light.offer_splat(0, pack_direction(kB), Rgb(0.5f), 6);
    light.offer(0, kA, Rgb(1), 5);
    EXPECT_EQ(pixel.chosen, first);
  }
}

TEST(FirstLight, ChoosesAmongSplatsApart) {
  OnePixel pixel;
  uint64_t splat = 0;
  FirstLight light = pixel.light(1);
  light.splats = {&splat, 1};
  light.offer_splat(0, pack_direction(kB), Rgb(1000), 6);
  EXPECT_EQ(pixel.chosen, 0u);
  light.offer(0, kA, Rgb(1), 5);
  EXPECT_NEAR(pixel.direction().x, 1, 1e-3f);
  EXPECT_NEAR(unpack_direction(static_cast<uint32_t>(splat)).y, 1, 1e-3f);
}

TEST(FirstLight, IgnoresContributionsWithoutLight) {
  OnePixel pixel;
  const FirstLight light = pixel.light(1);
  light.offer(0, kA, Rgb(0), 1);
  light.offer(0, kA, Rgb(-1), 2);
  light.offer(0, kA, Rgb(std::numeric_limits<float>::quiet_NaN()), 3);
  EXPECT_EQ(pixel.chosen, 0u);
  const FirstLight none;
  none.offer(0, kA, Rgb(1), 4);
  none.begin(0);
}

TEST(FirstLight, KeysArePositiveAndFinite) {
  for (const uint32_t bits : {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    EXPECT_GT(choice_key(1.0f, bits), 0.0f);
    EXPECT_LT(choice_key(1.0f, bits), kInfinity);
  }
}

/// A frame of a glossy Cornell box with records.
struct Recorded {
  explicit Recorded(bool light_only, int threads, uint32_t first_nee_bounce = 0)
      : frame(glossy(), options(light_only, threads, first_nee_bounce)) {
    const auto pixels = static_cast<size_t>(frame.width()) * frame.height();
    vertices.resize(pixels);
    chosen.resize(pixels);
    const SceneView& view = frame.compiled.view();
    launch(frame.backend, "gbuffer", PrimaryHitsKernel{view, index, mutable_view_of(frame.hits), {}, frame.width()},
           frame.width(), frame.height());
    BdptContext context = frame.context();
    context.first_light = {mutable_view_of(vertices), mutable_view_of(chosen), 9, 1};
    const BdptKernel kernel{context,
                            index,
                            view_of(frame.hits),
                            {},
                            {mutable_view_of(frame.radiance)},
                            mutable_view_of(frame.rays),
                            {&frame.saturated, 1},
                            {&frame.nonfinite, 1}};
    launch(frame.backend, "trace", kernel, frame.width(), frame.height());
    const AddSplatsKernel add{mutable_view_of(frame.splats), mutable_view_of(frame.radiance), {}, 1.0f, frame.width()};
    launch(frame.backend, "splats", add, frame.width(), frame.height());
    const FirstLightKernel record{context, index, view_of(frame.hits), {}, view_of(frame.radiance)};
    launch(frame.backend, "first-vertices", record, frame.width(), frame.height());
  }

  static Scene glossy() {
    Scene scene = find_builtin_scene("cornell")->build();
    for (Material& m : scene.materials) {
      m.roughness = 0.4f;
      m.metallic = 1;
    }
    return scene;
  }
  static BdptOptions options(bool light_only, int threads, uint32_t first_nee_bounce) {
    BdptOptions o;
    o.width = o.height = 32;
    o.max_bounces = 3;
    o.light_only = light_only;
    o.threads = threads;
    o.first_nee_bounce = first_nee_bounce;
    return o;
  }

  const SampleIndex index{.seed = 3, .sample = 2, .frame = 2, .age = 2};
  BdptFrame frame;
  std::vector<FirstVertex> vertices;
  std::vector<uint64_t> chosen;
};

class FirstLightOf : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Estimators, FirstLightOf, ::testing::Bool());

TEST_P(FirstLightOf, ReflectsTheRadianceOfTheSample) {
  Recorded recorded(GetParam(), 1);
  const SceneView& view = recorded.frame.compiled.view();
  int lit = 0;
  for (uint32_t i = 0; i < recorded.vertices.size(); ++i) {
    const uint32_t x = i % recorded.frame.width();
    const uint32_t y = i / recorded.frame.width();
    const Hit& hit = recorded.frame.hits[i];
    if (!hit.valid()) continue;
    Sampler sampler = recorded.index.sampler(x, y);
    const Ray ray = lone_camera_ray(view.camera, x, y, sampler);
    SurfacePoint sp;
    make_surface_point(view, ray, hit, view.camera.cone_width() + view.camera.cone_spread() * hit.t, sp);
    const FirstVertex& v = recorded.vertices[i];
    if (sp.bsdf.empty() || length_squared(v.scatter) == 0.0f) continue;
    const Rgb radiance = recorded.frame.radiance[i];
    const Rgb sum = sp.emission + eval_pdf(sp, v.scatter).f * v.indirect;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], radiance[c], 1e-3f * (1.0f + radiance[c])) << i;
    lit += recorded.chosen[i] != 0 && !is_black(v.indirect) ? 1 : 0;
  }
  EXPECT_GT(lit, 200);
}

TEST_P(FirstLightOf, LeavesLightSamplesToReservoirs) {
  const auto count_lights = [](const Recorded& recorded) {
    return std::count_if(recorded.vertices.begin(), recorded.vertices.end(),
                         [](const FirstVertex& v) { return v.light != kNoLight; });
  };
  EXPECT_GT(count_lights(Recorded(GetParam(), 1)), 200);
  EXPECT_EQ(count_lights(Recorded(GetParam(), 1, 1)), 0);
}

TEST_P(FirstLightOf, IsTheSameWithAnyNumberOfThreads) {
  const Recorded one(GetParam(), 1);
  const Recorded five(GetParam(), 5);
  EXPECT_EQ(one.chosen, five.chosen);
  for (size_t i = 0; i < one.vertices.size(); ++i) {
    EXPECT_EQ(one.vertices[i].scatter, five.vertices[i].scatter);
    EXPECT_EQ(one.vertices[i].indirect, five.vertices[i].indirect);
  }
}

}  // namespace
}  // namespace relume::testing
