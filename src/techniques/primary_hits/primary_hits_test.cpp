#include "techniques/primary_hits/primary_hits.h"

#include <gtest/gtest.h>

#include <vector>

#include "scene/builtin.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 37;  // no multiple of packets or tiles
constexpr uint32_t kHeight = 23;

CompiledScene compile(const char* name) {
  return {find_builtin_scene(name)->build(), CompileOptions{.camera = {}, .width = kWidth, .height = kHeight}};
}

PrimaryHitsKernel kernel_for(const CompiledScene& scene, std::vector<Hit>& hits) {
  hits.assign(kWidth * kHeight, Hit{});
  return {scene.view().accel, scene.view().camera, SampleIndex{3, 0, 5, false}, mutable_view_of(hits), kWidth};
}

TEST(PrimaryHits, PacketsFindWhatSingleRaysFind) {
  const CompiledScene scene = compile("cornell");
  std::vector<Hit> single;
  std::vector<Hit> packets;
  const PrimaryHitsKernel one = kernel_for(scene, single);
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) one(x, y);
  }
  const PrimaryHitsKernel many = kernel_for(scene, packets);
  for (uint32_t y = 0; y < kHeight; y += 8) {
    for (uint32_t x = 0; x < kWidth; x += 16) many(Tile{x, y, std::min(x + 16, kWidth), std::min(y + 8, kHeight)});
  }
  for (size_t i = 0; i < single.size(); ++i) {
    ASSERT_EQ(single[i].instance, packets[i].instance) << i;
    ASSERT_EQ(single[i].primitive, packets[i].primitive) << i;
    if (!single[i].valid()) continue;
    ASSERT_NEAR(single[i].t, packets[i].t, 1e-5f * single[i].t);  // packets round differently
  }
}

TEST(PrimaryHits, HitsLieOnTheirRays) {
  const CompiledScene scene = compile("cornell");
  std::vector<Hit> hits;
  const PrimaryHitsKernel kernel = kernel_for(scene, hits);
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      kernel(x, y);
      const Hit& hit = hits[y * kWidth + x];
      if (!hit.valid()) continue;
      Sampler sampler = kernel.index.sampler(x, y);
      const Ray ray = lone_camera_ray(scene.view().camera, x, y, sampler);
      SurfacePoint sp;
      make_surface_point(scene.view(), ray, hit, 0.0f, sp);
      ASSERT_LT(glm::length(ray.origin + ray.direction * hit.t - sp.position), 1e-4f);
      Vec2 film;
      ASSERT_TRUE(film_position(scene.view().camera, {scene.view().camera.position, ray.direction, kInfinity}, &film));
      ASSERT_EQ(static_cast<uint32_t>(film.x), x);
      ASSERT_EQ(static_cast<uint32_t>(film.y), y);
    }
  }
}

TEST(PrimaryHits, AuxiliaryBuffersShowTheFirstHit) {
  const CompiledScene scene = compile("cornell");
  std::vector<Hit> hits;
  const PrimaryHitsKernel kernel = kernel_for(scene, hits);
  std::vector<Rgb> albedo(hits.size(), Rgb(0));
  std::vector<Rgb> normal(hits.size(), Rgb(0));
  std::vector<float> depth(hits.size(), 0.0f);
  std::vector<Vec2> motion(hits.size(), Vec2(0));
  AuxiliaryKernel auxiliary{scene.view(),
                            kernel.index,
                            view_of(hits),
                            mutable_view_of(albedo),
                            mutable_view_of(normal),
                            mutable_view_of(depth),
                            mutable_view_of(motion),
                            kWidth};
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      kernel(x, y);
      auxiliary(x, y);
      const size_t i = y * kWidth + x;
      if (!hits[i].valid()) continue;
      EXPECT_NEAR(glm::length(normal[i]), 1.0f, 1e-5f);
      EXPECT_EQ(depth[i], hits[i].t);
      EXPECT_GT(max_component(albedo[i]), 0.0f);
      EXPECT_LE(max_component(albedo[i]), 1.0f);
      EXPECT_LT(std::hypot(motion[i].x, motion[i].y), 1e-3f);  // nothing moves
    }
  }
}

}  // namespace
}  // namespace relume
