#include "techniques/gbuffer/primary_hits/primary_hits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 37;  // not a multiple of packet or tile sizes
constexpr uint32_t kHeight = 23;

CompiledScene compile(const char* name, int width = kWidth, int height = kHeight) {
  return {find_builtin_scene(name)->build(), CompileOptions{.camera = {}, .width = width, .height = height}};
}

PrimaryHitsKernel kernel_for(const CompiledScene& scene, std::vector<Hit>& hits) {
  const Vec2 resolution = scene.view().camera.resolution;
  const auto width = static_cast<uint32_t>(resolution.x);
  hits.assign(size_t{width} * static_cast<uint32_t>(resolution.y), Hit{});
  return {scene.view(), SampleIndex{.seed = 3, .sample = 5}, mutable_view_of(hits), {}, width};
}

/// Hits of all pixels must be equal, also at shared edges and coincident faces.
void compare_forms(const char* name) {
  constexpr uint32_t kColumns = 321;  // not multiples of packet sizes
  constexpr uint32_t kRows = 181;
  const CompiledScene scene = compile(name, kColumns, kRows);
  std::vector<Hit> single;
  std::vector<Hit> tiled;
  const PrimaryHitsKernel one = kernel_for(scene, single);
  const PrimaryHitsKernel many = kernel_for(scene, tiled);
  for (uint32_t y = 0; y < kRows; ++y) {
    for (uint32_t x = 0; x < kColumns; ++x) one(x, y);
  }
  for (uint32_t y = 0; y < kRows; y += kTileSize) {
    for (uint32_t x = 0; x < kColumns; x += kTileSize)
      many(Tile{x, y, std::min(x + kTileSize, kColumns), std::min(y + kTileSize, kRows)});
  }
  for (size_t i = 0; i < single.size(); ++i)
    EXPECT_EQ(std::memcmp(&single[i], &tiled[i], sizeof(Hit)), 0) << name << ", pixel " << i;
  EXPECT_TRUE(std::any_of(single.begin(), single.end(), [](const Hit& hit) { return hit.valid(); })) << name;
}

TEST(PrimaryHits, TilesMatchSingleRays) {
  for (const char* name : {"cornell", "cornell-mirror", "cornell-water", "warehouse", "mine", "corridor", "turntable",
                           "door", "slit", "cover", "city"})
    compare_forms(name);
}

TEST(PrimaryHits, PacketsHoldTheRaysOfSinglePixels) {
  const CompiledScene scene = compile("cornell");
  std::vector<uint32_t> taken(kWidth * kHeight);
  for (uint32_t i = 0; i < taken.size(); ++i) taken[i] = i % 7;
  for (int kind = 0; kind < 8; ++kind) {
    SampleIndex index{.seed = 3, .sample = 5};
    if (kind >= 4) index.taken = view_of(taken);
    index.width = kWidth;
    CameraView camera = scene.view().camera;
    if (kind % 4 == 1) camera.lens_radius = 0.1f;
    if (kind % 4 == 2) camera.projection = Projection::orthographic;
    if (kind % 4 == 3) camera.projection = Projection::panoramic;
    uint32_t seen = 0;
    for (uint32_t y = 0; y < kHeight; y += 2) {
      for (uint32_t x = 0; x < kWidth; x += CameraPacket::kColumns) {
        CameraPacket packet;
        packet.take_rows(x, y, Tile{0, 0, kWidth, kHeight});
        packet.generate(camera, index);
        for (int i = 0; i < packet.count; ++i, ++seen) {
          Sampler sampler = index.sampler(packet.x[i], packet.y[i]);
          const Ray ray = lone_camera_ray(camera, packet.x[i], packet.y[i], sampler);
          ASSERT_EQ(packet.rays[i].origin, ray.origin) << kind;
          ASSERT_EQ(packet.rays[i].direction, ray.direction) << kind;
          ASSERT_EQ(packet.ids[i], sampler.camera_ray_id());
        }
      }
    }
    EXPECT_EQ(seen, kWidth * kHeight);
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
      Vec2 raster;
      ASSERT_TRUE(
          raster_position(scene.view().camera, {scene.view().camera.position, ray.direction, kInfinity}, &raster));
      ASSERT_EQ(static_cast<uint32_t>(raster.x), x);
      ASSERT_EQ(static_cast<uint32_t>(raster.y), y);
    }
  }
}

/// The buffers that SurfaceKernel writes, of kWidth × kHeight pixels.
struct Surfaces {
  std::vector<Vec3> position{kWidth * kHeight};
  std::vector<Vec3> previous{kWidth * kHeight};
  std::vector<Vec3> normal{kWidth * kHeight};
  std::vector<Rgb> albedo{kWidth * kHeight};
  std::vector<float> depth = std::vector<float>(kWidth * kHeight);
  std::vector<Vec2> motion{kWidth * kHeight};
  std::vector<uint32_t> instance = std::vector<uint32_t>(kWidth * kHeight);

  SurfaceKernel kernel(const CompiledScene& scene, const SampleIndex& index, const std::vector<Hit>& hits) {
    SurfaceKernel k;
    k.scene = scene.view();
    k.index = index;
    k.hits = view_of(hits);
    k.position = mutable_view_of(position);
    k.previous = mutable_view_of(previous);
    k.normal = mutable_view_of(normal);
    k.albedo = mutable_view_of(albedo);
    k.depth = mutable_view_of(depth);
    k.motion = mutable_view_of(motion);
    k.surface = mutable_view_of(instance);
    k.width = kWidth;
    return k;
  }
};

TEST(PrimaryHits, SurfaceBuffersShowTheFirstHit) {
  const CompiledScene scene = compile("cornell");
  std::vector<Hit> hits;
  const PrimaryHitsKernel kernel = kernel_for(scene, hits);
  Surfaces s;
  const SurfaceKernel surface = s.kernel(scene, kernel.index, hits);
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      kernel(x, y);
      surface(x, y);
      const size_t i = y * kWidth + x;
      EXPECT_EQ(s.instance[i], hits[i].instance);
      if (!hits[i].valid()) continue;
      EXPECT_NEAR(glm::length(s.normal[i]), 1.0f, 1e-5f);
      EXPECT_EQ(s.depth[i], hits[i].t);
      EXPECT_NEAR(glm::length(s.position[i] - scene.view().camera.position), hits[i].t, 1e-4f);
      EXPECT_GT(max_component(s.albedo[i]), 0.0f);
      EXPECT_LE(max_component(s.albedo[i]), 1.0f);
      EXPECT_LT(std::hypot(s.motion[i].x, s.motion[i].y), 1e-3f);  // static scene
    }
  }
}

TEST(PrimaryHits, MotionPointsFromThePreviousRasterPosition) {
  // Moving the camera 0.1 m right shifts a point at depth z left by 0.1 / (z · pixel width at 1 m).
  CompiledScene scene(find_builtin_scene("cornell")->build(), CompileOptions{.width = kWidth, .height = kHeight});
  CameraPose camera = scene.camera();
  camera.to_world[3] += 0.1f * camera.to_world[0];
  EXPECT_EQ(scene.set_camera(camera), Change::camera);
  std::vector<Hit> hits;
  const PrimaryHitsKernel kernel = kernel_for(scene, hits);
  Surfaces s;
  const SurfaceKernel surface = s.kernel(scene, kernel.index, hits);
  const CameraView& view = scene.view().camera;
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      kernel(x, y);
      surface(x, y);
      const size_t i = y * kWidth + x;
      if (!hits[i].valid()) continue;
      const float z = -glm::dot(s.position[i] - view.position, view.axes.n);
      EXPECT_NEAR(s.motion[i].x, -0.1f / (z * 2.0f * view.half_extent.x / kWidth), 2e-2f);
      EXPECT_NEAR(s.motion[i].y, 0.0f, 1e-3f);
    }
  }
  scene.end_frame();
  const SurfaceKernel still = s.kernel(scene, kernel.index, hits);
  still(kWidth / 2, kHeight / 2);
  EXPECT_LT(std::fabs(s.motion[kHeight / 2 * kWidth + kWidth / 2].x), 1e-3f);
}

TEST(PrimaryHits, SurfacesFromBehindTheCameraAreMarked) {
  const CompiledScene scene = compile("cornell");
  SceneView view = scene.view();
  const Vec3 seen(0, 2.7f, 0);
  EXPECT_EQ(raster_motion(view, seen, seen), Vec2(0));
  view.previous_camera.axes.n = -view.previous_camera.axes.n;
  EXPECT_EQ(raster_motion(view, seen, seen), Vec2(kFromNowhere));
}

TEST(PrimaryHits, AuxiliarySumsAndKeepsTheFirstMotion) {
  std::vector<Rgb> albedo{Rgb(1)};
  std::vector<Vec3> normal{Vec3(0, 1, 0)};
  std::vector<float> depth{2};
  std::vector<Vec2> motion{Vec2(3, 4)};
  AuxiliaryKernel kernel;
  std::vector<Rgb> source_albedo{Rgb(0.5f)};
  std::vector<Vec3> source_normal{Vec3(0, 0, 1)};
  std::vector<float> source_depth{5};
  std::vector<Vec2> source_motion{Vec2(7)};
  kernel.surface_albedo = view_of(source_albedo);
  kernel.surface_normal = view_of(source_normal);
  kernel.surface_depth = view_of(source_depth);
  kernel.surface_motion = view_of(source_motion);
  kernel.albedo = mutable_view_of(albedo);
  kernel.normal = mutable_view_of(normal);
  kernel.depth = mutable_view_of(depth);
  kernel.motion = mutable_view_of(motion);
  kernel.width = 1;
  kernel(0, 0);
  EXPECT_EQ(albedo[0], Rgb(1.5f));
  EXPECT_EQ(normal[0], Vec3(0, 1, 1));
  EXPECT_EQ(depth[0], 7.0f);
  EXPECT_EQ(motion[0], Vec2(3, 4));
  kernel.first = true;
  kernel(0, 0);
  EXPECT_EQ(motion[0], Vec2(7));
}

}  // namespace
}  // namespace relume
