// Tests irradiance under area lights against form factors.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "analytic/irradiance.h"

namespace relume::support {
namespace {

class AreaLight : public IrradianceTest {};
INSTANTIATE_TEST_SUITE_P(Lights, AreaLight, kWays, way_name);
INSTANTIATE_TEST_SUITE_P(SlowLights, AreaLight, kOtherWays, way_name);

/// One lamp and nine thousand samples per pixel or more. Quick tests have both estimators, and a guide and a selection
/// of lights that learn.
class NoisyAreaLight : public IrradianceTest {};
INSTANTIATE_TEST_SUITE_P(Lights, NoisyAreaLight, kWaysOfOneLight, way_name);
INSTANTIATE_TEST_SUITE_P(SlowSelections, NoisyAreaLight, kOtherSelections, way_name);
INSTANTIATE_TEST_SUITE_P(SlowLights, NoisyAreaLight, kOtherWays, way_name);

/// Configuration factor of a parallel rectangle [0, x] × [0, y] at distance 1 above its corner (Howell's catalogue,
/// B-4).
double corner_factor(double x, double y) {
  const double rx = std::sqrt(1 + x * x);
  const double ry = std::sqrt(1 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * M_PI);
}

/// Rectangle of 2·half_x by 2·half_y at `height` that emits down towards the origin.
Mesh ceiling(float half_x, float half_y, float height) {
  return quad({-half_x, half_y, height}, {2 * half_x, 0, 0}, {0, -2 * half_y, 0});
}

TEST(PolygonFormula, AgreesWithTheClosedForm) {
  const Mesh mesh = ceiling(0.8f, 0.5f, 1);
  EXPECT_NEAR(mesh_irradiance(mesh, Vec3(0), {0, 0, 1}), 4 * M_PI * corner_factor(0.8, 0.5), 1e-6);
}

TEST_P(AreaLight, Rectangle) {
  Scene scene = irradiance_meter();
  add(scene, ceiling(0.8f, 0.5f, 1), emitter("lamp", {3, 2, 1}));
  expect_irradiance(std::move(scene), Vec3(3, 2, 1) * static_cast<float>(4 * M_PI * corner_factor(0.8, 0.5)), kOneLamp);
}

TEST_P(AreaLight, LargeNearRectangle) {  // sampled mostly by the BSDF
  Scene scene = irradiance_meter();
  add(scene, ceiling(5, 5, 0.6f), emitter("lamp", Rgb(1)));
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(4 * M_PI * corner_factor(5 / 0.6, 5 / 0.6))), kOneLamp);
}

TEST_P(AreaLight, Sphere) {
  Scene scene = irradiance_meter();
  const Vec3 center(0.3f, 0.2f, 1.5f);
  add(scene, transformed(icosphere(0.5f, 4), translation(center)), emitter("lamp", Rgb(2)));
  // Sphere entirely above the horizon: E = π L sin²σ cos θ with angular radius σ. The inscribed polyhedron has 0.1 %
  // less.
  const double d2 = static_cast<double>(glm::dot(center, center));
  const double sphere = 2 * M_PI * 0.25 / d2 * static_cast<double>(center.z) / std::sqrt(d2);
  const double polyhedron =
      2 * mesh_irradiance(transformed(icosphere(0.5f, 4), translation(center)), Vec3(0), {0, 0, 1});
  EXPECT_NEAR(polyhedron / sphere, 1, 0.0015);
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(polyhedron)));
}

TEST_P(AreaLight, ManyUnequalLightsAddUp) {
  Scene scene = irradiance_meter();
  Rgb expected(0);
  for (int i = 0; i < 6; ++i) {
    const float angle = static_cast<float>(i);
    const Rgb radiance = Rgb(i % 3 == 0 ? 30.0f : 0.5f, i % 3 == 1 ? 8.0f : 1.0f, 2.0f);
    const Mesh lamp = transformed(ceiling(0.1f, 0.2f, 0.7f),
                                  translation({0.8f * std::cos(angle), 0.8f * std::sin(angle), 0.1f * angle}));
    expected += radiance * static_cast<float>(mesh_irradiance(lamp, Vec3(0), {0, 0, 1}));
    add(scene, lamp, emitter("lamp", radiance));
  }
  expect_irradiance(std::move(scene), expected);
}

TEST_P(AreaLight, ShinesFromItsFrontOnly) {
  Scene scene = irradiance_meter();
  add(scene, flipped(ceiling(0.8f, 0.5f, 1)), emitter("lamp", Rgb(1)));
  expect_black(std::move(scene));
}

TEST_P(AreaLight, ShinesFromBothSidesIfDoubleSided) {
  Scene scene = irradiance_meter();
  Material lamp = emitter("lamp", Rgb(1));
  lamp.double_sided = true;
  add(scene, flipped(ceiling(0.8f, 0.5f, 1)), lamp);
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(4 * M_PI * corner_factor(0.8, 0.5))), kOneLamp);
}

TEST_P(AreaLight, InstancedMirroredAndStretched) {
  const Mesh mesh = ceiling(0.8f, 0.5f, 1);
  const Mat4 matrix = translation({0.2f, 0.1f, 0.3f}) * rotation(20, {0, 1, 0}) * scaling({-0.5f, 1.5f, 1});
  Scene scene = irradiance_meter();
  add(scene, mesh, emitter("lamp", Rgb(1)));
  Node& node = scene.nodes.back();
  node.transform.translation = {0.2f, 0.1f, 0.3f};
  node.transform.rotation = glm::angleAxis(glm::radians(20.0f), Vec3(0, 1, 0));
  node.transform.scale = {-0.5f, 1.5f, 1};
  // An animated node is a separate instance in the acceleration structure.
  const Vec3& t = node.transform.translation;
  scene.animation.push_back({static_cast<Index>(scene.nodes.size()) - 1,
                             AnimatedProperty::translation,
                             Interpolation::linear,
                             {0, 1},
                             {Vec4(t, 0), Vec4(t, 0)}});
  expect_irradiance(std::move(scene),
                    Rgb(static_cast<float>(mesh_irradiance(transformed(mesh, matrix), Vec3(0), {0, 0, 1}))), kOneLamp);
}

TEST_P(NoisyAreaLight, BlendedOccluderTransmitsItsShare) {
  Scene scene = irradiance_meter();
  add(scene, ceiling(0.8f, 0.5f, 1), emitter("lamp", Rgb(1)));
  Material veil = matte("veil", Rgb(0));
  veil.alpha_mode = AlphaMode::blend;
  veil.alpha = 0.3f;
  add(scene, ceiling(2, 2, 0.8f), veil);
  // A shadow ray passes or not. n samples therefore leave a relative error of sqrt(0.3 / 0.7 / n) with any sampler:
  // 5.7e-4 for these on 144 pixels, where expect_near requires 6.7e-4.
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(0.7 * 4 * M_PI * corner_factor(0.8, 0.5))), 9216);
}

TEST_P(AreaLight, BlendedLampEmitsItsShare) {
  Scene scene = irradiance_meter();
  Material lamp = emitter("lamp", Rgb(2));
  lamp.alpha_mode = AlphaMode::blend;
  lamp.alpha = 0.3f;
  add(scene, ceiling(0.8f, 0.5f, 1), lamp);
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(0.3 * 2 * 4 * M_PI * corner_factor(0.8, 0.5))), 4096);
}

TEST_P(AreaLight, VertexAlphaDimsLamps) {
  Scene scene = irradiance_meter();
  Material lamp = emitter("lamp", Rgb(2));
  lamp.alpha_mode = AlphaMode::blend;
  Mesh mesh = ceiling(0.8f, 0.5f, 1);
  mesh.colors.assign(mesh.positions.size(), Vec4(1, 1, 1, 0.3f));
  add(scene, mesh, lamp);
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(0.3 * 2 * 4 * M_PI * corner_factor(0.8, 0.5))), 4096);
}

/// Sum of the irradiance of each texel.
double textured_irradiance(int texels, float half, float height, double (*radiance)(int x, int y)) {
  double sum = 0;
  const float size = 2 * half / static_cast<float>(texels);
  for (int i = 0; i < texels * texels; ++i) {
    const float x = -half + size * static_cast<float>(i % texels);
    const float y = -half + size * static_cast<float>(i / texels);
    sum +=
        radiance(i % texels, i / texels) *
        polygon_irradiance({{x, y, height}, {x + size, y, height}, {x + size, y + size, height}, {x, y + size, height}},
                           Vec3(0), {0, 0, 1});
  }
  return sum;
}

TEST_P(AreaLight, Textured) {
  Scene scene = irradiance_meter();
  Material lamp = emitter("lamp", Rgb(5));
  lamp.emission_texture.texture =
      add_texture(scene, make_texture(8, 8, PixelFormat::rgba8_linear, [](int x, int y) {
                    return std::array<int, 4>{x * y % 3 == 0 ? 255 : 0, 51 * (x / 2), 0, 255};
                  }));
  const Mesh mesh = ceiling(0.8f, 0.8f, 1);
  ASSERT_EQ(mesh.uv0[3], Vec2(0));  // the first texel is at the lowest x and y
  ASSERT_EQ(mesh.positions[3], Vec3(-0.8f, -0.8f, 1));
  add(scene, mesh, lamp);
  const double red = textured_irradiance(8, 0.8f, 1, [](int x, int y) { return x * y % 3 == 0 ? 5.0 : 0.0; });
  const double green = textured_irradiance(8, 0.8f, 1, [](int x, int) { return x / 2 * 1.0; });
  expect_irradiance(std::move(scene), {red, green, 0});
}

TEST_P(NoisyAreaLight, FinelyTextured) {  // finer than the ray cones of diffuse paths: filtering must keep the mean
  Scene scene = irradiance_meter();
  Material lamp = emitter("lamp", Rgb(1));
  lamp.emission_texture.texture = add_texture(scene, make_texture(64, 64, PixelFormat::rgba8_linear, [](int x, int y) {
                                                return std::array<int, 4>{(x + y) % 2 == 0 ? 255 : 0, 255, 0, 255};
                                              }));
  add(scene, ceiling(0.8f, 0.8f, 1), lamp);
  const double full = 4 * M_PI * corner_factor(0.8, 0.8);
  const double red = textured_irradiance(64, 0.8f, 1, [](int x, int y) { return (x + y) % 2 == 0 ? 1.0 : 0.0; });
  EXPECT_NEAR(red / full, 0.5, 1e-3);
  expect_irradiance(std::move(scene), {red, full, 0}, 10240);
}

TEST_P(AreaLight, CutOutByItsAlphaMask) {
  Scene scene = irradiance_meter();
  Material lamp = emitter("lamp", Rgb(1));
  lamp.alpha_mode = AlphaMode::mask;
  lamp.base_color_texture.texture = add_texture(scene, make_texture(4, 4, PixelFormat::rgba8_srgb, [](int x, int) {
                                                  return std::array<int, 4>{255, 255, 255, x < 2 ? 255 : 0};
                                                }));
  add(scene, ceiling(0.8f, 0.5f, 1), lamp);
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(2 * M_PI * corner_factor(0.8, 0.5))));
}

}  // namespace
}  // namespace relume::support
