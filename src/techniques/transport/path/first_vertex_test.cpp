#include "techniques/transport/path/first_vertex.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 53;  // not a multiple of tiles or batches
constexpr uint32_t kHeight = 47;
constexpr uint32_t kPixels = kWidth * kHeight;

/// First vertices of one sample per allocated pixel of the Cornell box, pixel by pixel or in tiles.
std::vector<FirstVertex> trace(const std::vector<uint32_t>& allocation, bool tiles) {
  const CompiledScene scene(find_builtin_scene("cornell")->build(),
                            CompileOptions{.camera = {}, .width = kWidth, .height = kHeight});
  FirstVertex of_before;
  of_before.light_scale = 7;
  std::vector<FirstVertex> vertices(kPixels, of_before);
  std::vector<Rgb> radiance(kPixels);
  testing::trace_pixels(
      scene,
      {.width = kWidth, .height = kHeight, .tile_size = tiles ? kTileSize : 0, .allocation = view_of(allocation)},
      RadianceOutput{mutable_view_of(radiance)}, FirstVertexOutput{mutable_view_of(vertices)});
  return vertices;
}

TEST(FirstVertex, TilesMatchElements) {
  const std::vector<uint32_t> allocation(kPixels, 1);
  const std::vector<FirstVertex> elements = trace(allocation, false);
  const std::vector<FirstVertex> tiles = trace(allocation, true);
  uint32_t different = 0;
  uint32_t lit = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const FirstVertex& a = elements[i];
    const FirstVertex& b = tiles[i];
    ASSERT_EQ(a.scatter, b.scatter) << i;
    ASSERT_EQ(a.to_light, b.to_light) << i;
    ASSERT_EQ(a.light, b.light) << i;
    ASSERT_EQ(a.light_u, b.light_u) << i;
    ASSERT_EQ(a.light_scale, b.light_scale) << i;
    lit += is_black(a.direct) ? 0u : 1u;
    different += a.direct == b.direct && a.indirect == b.indirect && a.light_value == b.light_value ? 0u : 1u;
  }
  EXPECT_GT(lit, kPixels / 4);
  EXPECT_EQ(different, 0u);
}

TEST(FirstVertex, PixelsWithoutPathsHaveNone) {
  std::vector<uint32_t> allocation(kPixels, 1);
  for (uint32_t i = 0; i < kPixels; i += 3) allocation[i] = 0;
  for (const bool in_tiles : {false, true}) {
    const std::vector<FirstVertex> vertices = trace(allocation, in_tiles);
    for (uint32_t i = 0; i < kPixels; i += 3) {
      EXPECT_EQ(vertices[i].light, kNoLight);
      EXPECT_EQ(vertices[i].light_scale, 0.0f);
      EXPECT_EQ(vertices[i].scatter, Vec3(0));
    }
  }
}

/// Expects radiance = emission + f(scatter) · indirect + f(to_light) · direct for a sample of each pixel. Returns the
/// first vertices.
std::vector<FirstVertex> expect_radiance_of_first_vertices(const Scene& source) {
  constexpr uint32_t kSize = 24;
  const CompiledScene scene(source, {.camera = {}, .width = kSize, .height = kSize});
  std::vector<Rgb> radiance(kSize * kSize);
  std::vector<FirstVertex> vertices(radiance.size());
  testing::trace_pixels(scene, {.width = kSize, .height = kSize, .max_bounces = 2},
                        RadianceOutput{mutable_view_of(radiance)}, FirstVertexOutput{mutable_view_of(vertices)});
  const SceneView& view = scene.view();
  int checked = 0;
  for (uint32_t i = 0; i < kSize * kSize; ++i) {
    const uint32_t x = i % kSize;
    const uint32_t y = i / kSize;
    Sampler sampler = SampleIndex{.seed = 7, .sample = 3}.sampler(x, y);  // as in trace_pixels()
    const Ray ray = lone_camera_ray(view.camera, x, y, sampler);
    const Hit hit = intersect_from_camera(view.accel, ray, sampler.camera_ray_id());
    if (!hit.valid()) continue;
    SurfacePoint sp;
    make_surface_point(view, ray, hit, view.camera.cone_spread() * hit.t, sp, path_wavelength(view, sampler));
    const FirstVertex& v = vertices[i];
    Rgb sum = sp.emission;
    if (length_squared(v.scatter) > 0) sum += eval_pdf(sp, v.scatter).f * v.indirect;
    if (length_squared(v.to_light) > 0) sum += eval_pdf(sp, v.to_light).f * v.direct;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], radiance[i][c], 1e-3f * (1.0f + radiance[i][c])) << x << ' ' << y;
    ++checked;
  }
  EXPECT_GT(checked, 100);
  return vertices;
}

TEST(FirstVertex, AccountsForReflectedLight) {
  expect_radiance_of_first_vertices(find_builtin_scene("cornell")->build());
}

/// Lamps on both sides of a sheet of rough dispersive glass, which shows its outer or its inner side.
TEST(FirstVertex, AccountsForTheWeightOfTheWavelength) {
  for (const bool inner_side : {false, true}) {
    Material glass = testing::matte(Rgb(0.9f, 0.7f, 0.5f));
    glass.specular = 1;
    glass.transmission = 1;
    glass.roughness = 0.5f;
    glass.thickness = 1;
    glass.dispersion = 5;
    Scene scene = testing::plate(glass, 3, 1);
    testing::add_square_lamp(scene, Rgb(5));
    Material lamp = testing::matte(Rgb(0));
    lamp.emission = Rgb(5);
    Mesh below = scene.meshes[0];
    for (Vec3& p : below.positions) p.y = -1;
    testing::add_mesh(scene, lamp, std::move(below));
    for (UVec3& t : scene.meshes[0].triangles) {
      if (inner_side) std::swap(t.y, t.z);
    }
    const std::vector<FirstVertex> vertices = expect_radiance_of_first_vertices(scene);
    const auto is_colored = [](const FirstVertex& v) { return std::fabs(v.direct.r - v.direct.b) > 0.1f * v.direct.g; };
    EXPECT_GT(std::count_if(vertices.begin(), vertices.end(), is_colored), 20) << inner_side;
  }
}

}  // namespace
}  // namespace relume
