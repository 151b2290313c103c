// Scenes with images known in closed form, rendered at low resolution.
#include "techniques/transport/path/path.h"

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

using testing::add_slab;
using testing::glowing_plate;
using testing::matte;
using testing::plate;
using testing::tint;

struct Rendered {
  Rgb mean{0};  ///< over all pixels
  uint64_t nonfinite = 0;
};

Rendered render(Scene scene, int samples, const RenderSettings& base) {
  RenderSettings settings = base;
  settings.threads = 1;
  Session session(std::move(scene), settings);
  for (int i = 0; i < samples; ++i) session.render_frame();
  const Image image = session.image();
  Rendered result;
  glm::dvec3 sum(0);
  for (const Rgb& p : image.pixels) sum += glm::dvec3(p);
  result.mean = Rgb(sum / static_cast<double>(image.pixels.size()));
  result.nonfinite = session.statistics().nonfinite_samples;
  return result;
}

RenderSettings small(int size, int max_bounces) {
  RenderSettings s;
  s.width = s.height = size;
  s.path.max_bounces = max_bounces;
  return s;
}

void add_light(Scene& scene, const PunctualLight& light, const Vec3& position) {
  scene.lights.push_back(light);
  Node node;
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  node.transform.translation = position;
  node.transform.rotation = glm::angleAxis(-kPi / 2, Vec3(1, 0, 0));  // shines down
  scene.add_node(node);
}

TEST(Path, FurnaceIsWhite) {
  for (const bool roulette : {false, true}) {
    RenderSettings settings = small(24, 64);
    settings.path.russian_roulette = roulette;
    const Rendered r = render(find_builtin_scene("furnace")->build(), 16, settings);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(r.mean[c], 1.0f, 1e-3f);
    EXPECT_EQ(r.nonfinite, 0u);
  }
}

TEST(Path, PlateUnderConstantSkyReflectsItsAlbedo) {
  Scene scene = plate(matte(Rgb(0.8f, 0.5f, 0.2f)), 5, 1);
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1, 2, 3);
  RenderSettings settings = small(8, 4);
  settings.path.russian_roulette = false;
  const Rendered r = render(scene, 8, settings);
  // A convex body reflects ρ L without noise, since every weight is the albedo.
  EXPECT_NEAR(r.mean.r, 0.8f, 1e-4f);
  EXPECT_NEAR(r.mean.g, 1.0f, 1e-4f);
  EXPECT_NEAR(r.mean.b, 0.6f, 1e-4f);
}

TEST(Path, DirectionalLightsGiveTheirIrradiance) {
  for (const float diameter : {0.0f, 0.00925f, 0.5f}) {
    Scene scene = plate(matte(Rgb(0.5f)), 5, 1);
    PunctualLight sun{"sun", PunctualType::directional, Rgb(2, 3, 4)};
    sun.angular_diameter_rad = diameter;
    add_light(scene, sun, Vec3(0, 3, 0));
    const Rendered r = render(scene, 64, small(16, 2));
    // E ρ / π for light from straight above. The irradiance of the disk refers to a facing plane.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(r.mean[c] / (Rgb(2, 3, 4)[c] * 0.5f / kPi), 1.0f, 2e-3f) << diameter;
  }
}

TEST(Path, PointLightFollowsTheInverseSquareAndTheCosine) {
  // The visible area is tiny, so the light is 2 m above all of it: E = I / d².
  Scene scene = plate(matte(Rgb(0.5f)), 5, 1e-3f);
  add_light(scene, {"point", PunctualType::point, Rgb(8)}, Vec3(0, 2, 0));
  EXPECT_NEAR(render(scene, 2, small(4, 2)).mean.r, 2.0f * 0.5f / kPi, 1e-4f);
  Scene slanted = plate(matte(Rgb(0.5f)), 5, 1e-3f);
  add_light(slanted, {"point", PunctualType::point, Rgb(8)}, Vec3(2, 2, 0));
  EXPECT_NEAR(render(slanted, 2, small(4, 2)).mean.r, 8.0f / 8.0f * std::sqrt(0.5f) * 0.5f / kPi, 1e-4f);
}

/// Form factor of a parallel square of half-width a at height h above a point below its centre. Each of four equal
/// corners contributes (1/2π) · 2 · x/√(1 + x²) · atan(x/√(1 + x²)), x = a/h.
double square_factor(double a, double h) {
  const double x = a / h;
  const double s = x / std::sqrt(1.0 + x * x);
  return 4.0 / M_PI * s * std::atan(s);
}

TEST(Path, SquareLightGivesItsFormFactor) {
  for (const bool by_uniform : {false, true}) {
    Scene scene = plate(matte(Rgb(0.5f)), 5, 1e-3f);
    testing::add_square_lamp(scene, Rgb(3));
    RenderSettings settings = small(16, 1);
    settings.lights = by_uniform ? LightSelectionChoice::uniform : LightSelectionChoice::power;
    const Rendered r = render(scene, 512, settings);
    EXPECT_NEAR(r.mean.r / (3.0 * 0.5 * square_factor(1.0, 1.5)), 1.0, 2e-3);
  }
}

TEST(Path, BouncesCountScatteringEvents) {
  Scene scene = plate(matte(Rgb(0.5f)), 5, 1);
  scene.environment.kind = EnvironmentKind::constant;
  RenderSettings settings = small(4, 0);
  settings.path.russian_roulette = false;
  EXPECT_EQ(render(scene, 2, settings).mean.r, 0.0f);  // the plate is visible, its illumination is not
  settings.path.max_bounces = 1;
  EXPECT_NEAR(render(scene, 2, settings).mean.r, 0.5f, 1e-4f);
}

/// Expects equal means of the Cornell box within the error of several seeds, well below one percent.
void expect_equal_means(RenderSettings a, RenderSettings b) {
  constexpr int kSeeds = 16;
  const Scene scene = find_builtin_scene("cornell")->build();
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);
  glm::dvec3 level(0);
  for (int i = 0; i < kSeeds; ++i) {
    a.seed = 1 + i;
    b.seed = 1001 + i;
    const glm::dvec3 mean(render(scene, 96, b).mean);
    const glm::dvec3 difference = glm::dvec3(render(scene, 96, a).mean) - mean;
    sum += difference / static_cast<double>(kSeeds);
    squares += difference * difference / static_cast<double>(kSeeds);
    level += mean / static_cast<double>(kSeeds);
  }
  for (int c = 0; c < 3; ++c) {
    const double error = std::sqrt((squares[c] - sum[c] * sum[c]) / (kSeeds - 1));
    EXPECT_LT(error, 0.005 * level[c]) << "channel " << c;
    EXPECT_LT(std::fabs(sum[c]), 4.5 * error) << "channel " << c;
  }
}

TEST(Path, RussianRouletteKeepsTheMean) {
  const RenderSettings with = small(16, 12);
  RenderSettings without = with;
  without.path.russian_roulette = false;
  expect_equal_means(with, without);
}

TEST(Path, FewerIndirectPathsKeepTheMean) {
  const RenderSettings all = small(16, 6);
  RenderSettings fewer = all;
  fewer.path.indirect_rate = 0.3f;
  expect_equal_means(all, fewer);
}

TEST(Path, SelectorsAgreeInTheMean) {
  const RenderSettings power = small(16, 6);
  RenderSettings uniform = power;
  uniform.lights = LightSelectionChoice::uniform;
  expect_equal_means(power, uniform);
}

const Rgb kAbsorption(0.2f, 0.5f, 1.0f);

void expect_transmitted(const Scene& scene, float metres, const char* what) {
  RenderSettings settings = small(4, 8);
  settings.path.russian_roulette = false;
  const Rgb mean = render(scene, 1, settings).mean;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], std::exp(-kAbsorption[c] * metres), 1e-4f) << what;
}

TEST(Path, MediaAbsorbAlongThePathInside) {
  Scene behind = glowing_plate(5);
  add_slab(behind, tint(kAbsorption), 3, 1);
  expect_transmitted(behind, 2, "a medium before the plate");
  Scene inside = glowing_plate(5);
  add_slab(inside, tint(kAbsorption), 3, -1);
  expect_transmitted(inside, 3, "the plate in a medium");
  Scene sheet = glowing_plate(5);
  add_slab(sheet, tint(kAbsorption), 2, 2);
  expect_transmitted(sheet, 2, "the plate below an open sheet");
  Scene eye_inside = glowing_plate(2);
  add_slab(eye_inside, tint(kAbsorption), 3, 0.5f);
  expect_transmitted(eye_inside, 1.5f, "the camera in a medium");
  Scene all_inside = glowing_plate(2);
  add_slab(all_inside, tint(kAbsorption), 3, -1);
  expect_transmitted(all_inside, 2, "camera and plate in a medium");
  Scene sheet_behind = glowing_plate(2);
  add_slab(sheet_behind, tint(kAbsorption), -1, -1);
  expect_transmitted(sheet_behind, 0, "an open sheet beyond the plate");
  Scene nested = glowing_plate(5);
  add_slab(nested, tint(kAbsorption * 0.5f), 4, -1);
  add_slab(nested, tint(kAbsorption), 3, 2);
  expect_transmitted(nested, 2 + 1, "a medium in a medium");
}

TEST(Path, MediaAbsorbTheLightOfLampsInside) {
  Scene scene = plate(matte(Rgb(0.5f)), 3, 1e-3f);
  scene.nodes[1].transform.translation.y = 5;
  add_slab(scene, tint(kAbsorption), 4, -1);
  add_light(scene, {"lamp", PunctualType::point, Rgb(8)}, Vec3(0, 2, 0));
  const Rgb mean = render(scene, 4, small(4, 2)).mean;
  // 2 m from the lamp to the plate, 4 m from the plate to the surface.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 8.0f / 4.0f * 0.5f / kPi * std::exp(-kAbsorption[c] * 6), 1e-4f);
}

/// E at the origin of a plane from a parallel rectangle of radiance 1 at height h, through an absorbing medium.
/// Midpoint rule for ∫ cos² exp(−σ r) / r² dA.
double absorbed_irradiance(double x0, double x1, double half_z, double h, double absorption) {
  constexpr int kSteps = 400;
  const double dx = (x1 - x0) / kSteps;
  const double dz = 2 * half_z / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = x0 + (i + 0.5) * dx;
      const double z = -half_z + (j + 0.5) * dz;
      const double r2 = x * x + z * z + h * h;
      sum += h * h / r2 * std::exp(-absorption * std::sqrt(r2)) / r2 * dx * dz;
    }
  }
  return sum;
}

TEST(Path, LampInsideAMediumMatchesTheClosedForm) {
  Scene scene = plate(matte(Rgb(0.5f)), 5, 1e-3f);
  scene.nodes[1].transform.translation.y = 5;
  add_slab(scene, tint(kAbsorption), 4, -1);
  // Wide and near enough that both strategies contribute; not above the visible point.
  Material lamp = matte(Rgb(0));
  lamp.emission = Rgb(1);
  Mesh mesh;
  mesh.positions = {{0.1f, 0.5f, -3}, {3, 0.5f, -3}, {3, 0.5f, 3}, {0.1f, 0.5f, 3}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  testing::add_mesh(scene, lamp, mesh);
  // The camera ray passes the surface first, so lighting is the second event.
  const Rgb mean = render(scene, 512, small(16, 2)).mean;
  for (int c = 0; c < 3; ++c) {
    const double expected = absorbed_irradiance(0.1, 3, 3, 0.5, kAbsorption[c]) * 0.5 * kInvPi;
    // 131,072 paths with a standard deviation below twice the mean: three standard errors.
    EXPECT_NEAR(mean[c] / (expected * std::exp(-4.0 * kAbsorption[c])), 1.0, 0.016);
  }
}

TEST(Path, ReportsNanThroughput) {
  Scene scene = plate(matte(Rgb(0.5f)), 5, 1);
  const CompiledScene compiled(scene, {.width = 4, .height = 4});
  PathContext context;
  context.scene = compiled.view();
  Sampler sampler = SampleIndex{.seed = 7}.sampler(0, 0);
  PathState path = start_path(context, 0, 0, sampler);
  SurfacePoint sp;
  make_surface_point(context.scene, path.ray, intersect(context.scene.accel, path.ray, 0), 0, sp);
  BsdfSample s = context.directions.sample(sp, sampler);
  s.weight.g = std::nanf("");
  EXPECT_FALSE(follow(context, sp, s, path, sampler));
  EXPECT_FALSE(is_finite(path.radiance));
}

/// Radiance and rays of one sample per pixel, pixel by pixel or in tiles.
struct Traced {
  std::vector<Rgb> radiance;
  std::vector<uint32_t> rays;
};

Traced trace(const CompiledScene& scene, uint32_t width, uint32_t height, uint32_t tile_size) {
  Traced traced{std::vector<Rgb>(width * height, Rgb(-1)), {}};
  traced.rays = testing::trace_pixels(scene, {.width = width, .height = height, .tile_size = tile_size},
                                      RadianceOutput{mutable_view_of(traced.radiance)});
  return traced;
}

TEST(Path, TilesMatchElements) {
  constexpr uint32_t kWidth = 53;  // not a multiple of tiles or batches
  constexpr uint32_t kHeight = 47;
  for (const char* name : {"cornell", "turntable"}) {
    const CompiledScene scene(find_builtin_scene(name)->build(),
                              CompileOptions{.camera = {}, .width = kWidth, .height = kHeight});
    const Traced elements = trace(scene, kWidth, kHeight, 0);
    for (const uint32_t tile_size : {16u, 40u}) {
      const Traced tiles = trace(scene, kWidth, kHeight, tile_size);
      uint32_t different = 0;
      for (size_t i = 0; i < elements.rays.size(); ++i) {
        ASSERT_EQ(elements.rays[i], tiles.rays[i]) << name << " pixel " << i;
        if (elements.radiance[i] != tiles.radiance[i]) ++different;
      }
      EXPECT_EQ(different, 0u) << name << " in tiles of " << tile_size;
    }
  }
}

}  // namespace
}  // namespace relume
