// Textured emitters and environments are sampled in proportion to their emission, within 1 %.
#include <gtest/gtest.h>

#include <vector>

#include "scene/testing/light_scene.h"
#include "testing/integrate.h"

namespace relume {
namespace {

using testing::LightScene;

constexpr double kProportional = 0.01;

/// Averages midpoints, which lie inside the texels of maps whose size is a power of two. On texel borders, rounding
/// would decide.
template <typename P>
double mean_over_bin(const P& p, int n, int m, int i, int j) {
  constexpr int kPoints = 128;
  double sum = 0;
  for (int y = 0; y < kPoints; ++y) {
    for (int x = 0; x < kPoints; ++x) sum += p((i + (x + 0.5) / kPoints) / n, (j + (y + 0.5) / kPoints) / m);
  }
  return sum / (kPoints * kPoints);
}

/// Largest relative difference between the integrals of two densities, scaled to one, over n × m bins of the unit
/// square. Bins with less than a thousandth are excluded.
template <typename P, typename Q>
double largest_deviation(int n, int m, const P& p, const Q& q) {
  std::vector<double> a;
  std::vector<double> b;
  double sum_a = 0;
  double sum_b = 0;
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      a.push_back(mean_over_bin(p, n, m, i, j));
      b.push_back(mean_over_bin(q, n, m, i, j));
      sum_a += a.back();
      sum_b += b.back();
    }
  }
  double largest = 0;
  for (size_t k = 0; k < a.size(); ++k) {
    if (a[k] > 1e-3 * sum_a) largest = std::max(largest, std::fabs(b[k] / sum_b / (a[k] / sum_a) - 1.0));
  }
  return largest;
}

TEST(Proportional, TexturedTriangles) {
  const LightScene scene = testing::make_light_scene({}, 128);
  const LightsView& view = scene.lights();
  for (const LightId id : {2u, 3u}) {
    const TriangleLight& t = view.lights[id].triangle;
    const auto inside = [](double x, double y, const auto& f) {
      return x + y < 1.0 ? f(Vec2(static_cast<float>(x), static_cast<float>(y))) : 0.0;
    };
    const auto emission = [&](double x, double y) {
      return inside(x, y, [&](const Vec2& b) { return double(luminance(emitted_radiance(t, view.textured, b, 1))); });
    };
    const auto density = [&](double x, double y) {
      return inside(x, y, [&](const Vec2& b) { return double(pdf_area(t, view.textured, b)); });
    };
    EXPECT_LT(largest_deviation(4, 4, emission, density), kProportional) << scene.named[id].name;
  }
}

/// One triangle of 2 m² over half of a texture that is black except for one texel, repeated.
LightScene one_bright_texel(int size, int x, int y, float radiance, float repeats) {
  Scene scene;
  scene.name = "texel";
  std::vector<Vec4> texels(static_cast<size_t>(size) * static_cast<size_t>(size), Vec4(0, 0, 0, 1));
  texels[static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)] = Vec4(radiance);
  scene.textures.push_back(testing::float_texture(size, size, texels));
  Material material;
  material.emission = Rgb(1);
  material.emission_texture.texture = 0;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = {Vec3(0), Vec3(2, 0, 0), Vec3(0, 2, 0)};
  mesh.uv0 = {Vec2(0), Vec2(repeats, 0), Vec2(0, repeats)};
  mesh.triangles = {UVec3(0, 1, 2)};
  mesh.material = 0;
  scene.meshes.push_back(mesh);
  Node node;
  node.meshes = {0};
  scene.add_node(node);
  LightScene result;
  result.compiled = std::make_unique<CompiledScene>(std::move(scene), CompileOptions{});
  return result;
}

TEST(Proportional, NoTexelIsTooSmallToBeFound) {
  constexpr int kSize = 2048;
  for (const IVec2& at : {IVec2(601, 333), IVec2(1200, 70)}) {
    const LightScene scene = one_bright_texel(kSize, at.x, at.y, 1e6f, 1);
    const LightsView& view = scene.lights();
    ASSERT_EQ(view.lights.size, 1u);
    // π A times the mean over half of the texture.
    const float expected = kPi * 2.0f * 1e6f / (0.5f * kSize * kSize);
    EXPECT_NEAR(power(view, 0).r / expected, 1.0f, 0.05f);
    const Vec2 centre = (Vec2(at) + 0.5f) / static_cast<float>(kSize);
    EXPECT_GT(pdf_area(view.lights[0].triangle, view.textured, centre), 100.0f);
  }
}

TEST(Proportional, TinyTexelsAreStillSampled) {
  const LightScene scene = one_bright_texel(64, 20, 30, 1e3f, 500);
  const LightsView& view = scene.lights();
  ASSERT_EQ(view.lights.size, 1u);
  EXPECT_GT(power(view, 0).r, 0.0f);
  for (uint32_t i = 0; i < 1000; ++i) {
    const Vec2 b = triangle_from_square({to_unit_float(hash(i, 1u)), to_unit_float(hash(i, 2u))});
    ASSERT_GT(pdf_area(view.lights[0].triangle, view.textured, b), 1e-3f);
  }
}

void expect_proportional(const EnvironmentView& e, const std::string& name) {
  const auto emission = [&](double x, double y) {
    float sin_theta;
    const Vec3 w = e.direction_from_uv({static_cast<float>(x), static_cast<float>(y)}, &sin_theta);
    return double(luminance(e.radiance(w)) * sin_theta);
  };
  const auto density = [&](double x, double y) {
    float sin_theta;
    const Vec3 w = e.direction_from_uv({static_cast<float>(x), static_cast<float>(y)}, &sin_theta);
    return double(pdf_li(e, w) * sin_theta);
  };
  EXPECT_LT(largest_deviation(16, 8, emission, density), kProportional) << name;
}

TEST(Proportional, EnvironmentMaps) {
  const LightScene scene = testing::make_light_scene(testing::noise_environment(256, 128));
  expect_proportional(scene.lights().environment, "map");
}

TEST(Proportional, SunSky) {
  for (const float elevation : {0.1f, 0.6f, 1.4f}) {
    Environment e;
    e.kind = EnvironmentKind::sun_sky;
    e.sun_sky.sun_elevation_rad = elevation;
    const LightScene scene = testing::make_light_scene(e);
    expect_proportional(scene.lights().environment, "sky " + std::to_string(elevation));
  }
}

TEST(Proportional, MeanOfTheEnvironmentIsItsIntegral) {
  for (const Environment& source : {testing::noise_environment(64, 32), testing::constant_environment()}) {
    const LightScene scene = testing::make_light_scene(source);
    const EnvironmentView& e = scene.lights().environment;
    const auto radiance = [&](double x, double y) {
      float sin_theta;
      const Vec3 w = e.direction_from_uv({static_cast<float>(x), static_cast<float>(y)}, &sin_theta);
      return luminance(e.radiance(w)) * sin_theta * M_PI / 2;  // 2π² sin θ / 4π
    };
    EXPECT_NEAR(testing::integrate_square(radiance, 32, 1e-5, 4) / luminance(e.mean), 1.0, 5e-3);
  }
}

TEST(Environment, LooksWhereTheConventionSays) {
  // 4 × 2 texels of distinct colours; the centre looks along −Z and +X lies to its right.
  Environment e;
  e.kind = EnvironmentKind::map;
  e.width = 4;
  e.height = 2;
  for (int i = 0; i < 8; ++i) e.map.emplace_back(static_cast<float>(i));
  const auto at = [&](const Vec3& w) {
    return testing::make_light_scene(e).lights().environment.radiance(glm::normalize(w)).r;
  };
  const float up = 1.0f;  // 45° above the horizon: the centre of row 0
  EXPECT_NEAR(at({1, std::sqrt(2.0f) * up, -1}), 2.0f, 1e-4f);
  EXPECT_NEAR(at({1, std::sqrt(2.0f) * up, 1}), 3.0f, 1e-4f);
  EXPECT_NEAR(at({-1, std::sqrt(2.0f) * up, 1}), 0.0f, 1e-4f);
  EXPECT_NEAR(at({-1, -std::sqrt(2.0f) * up, -1}), 5.0f, 1e-4f);
}

TEST(Environment, ItsColourMultipliesSkyAndSun) {
  Environment e;
  e.kind = EnvironmentKind::sun_sky;
  const LightScene plain = testing::make_light_scene(e);
  e.color = Rgb(0.5f, 2, 3);
  const LightScene tinted = testing::make_light_scene(e);
  ASSERT_EQ(plain.lights().lights.size, tinted.lights().lights.size);
  for (LightId id = 9; id < plain.lights().lights.size; ++id) {  // the sun and the sky
    const Rgb ratio = power(tinted.lights(), id) / power(plain.lights(), id);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio[c], e.color[c], 1e-4f) << id;
  }
}

TEST(Environment, UvAndDirectionAreInverse) {
  const LightScene scene = testing::make_light_scene(testing::noise_environment(24, 12));
  const EnvironmentView& e = scene.lights().environment;
  for (uint32_t i = 0; i < 2000; ++i) {
    const Vec2 uv(to_unit_float(hash(i, 1u)), 0.01f + 0.98f * to_unit_float(hash(i, 2u)));
    float sin_theta;
    const Vec2 back = e.uv_from_direction(e.direction_from_uv(uv, &sin_theta));
    ASSERT_NEAR(back.x, uv.x, 2e-5f);  // error of φ near a pole
    ASSERT_NEAR(back.y, uv.y, 2e-5f);
  }
}

TEST(Environment, TheSunTurnsWithItsSky) {
  Environment e;
  e.kind = EnvironmentKind::sun_sky;
  e.rotation_rad = 1.1f;
  const LightScene scene = testing::make_light_scene(e);
  const LightsView& view = scene.lights();
  const DirectionalLight& sun = view.lights[view.lights.size - 2].directional;
  // The sky is brightest around the sun.
  const float towards = luminance(view.environment.radiance(sun.to_light));
  for (uint32_t i = 0; i < 200; ++i) {
    const float phi = to_unit_float(hash(i)) * 2.0f * kPi;
    const float r = safe_sqrt(1.0f - sqr(sun.to_light.y));
    const Vec3 w(r * std::cos(phi), sun.to_light.y, r * std::sin(phi));
    EXPECT_LE(luminance(view.environment.radiance(w)), towards * 1.001f);
  }
}

}  // namespace
}  // namespace relume
