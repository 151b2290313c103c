// Tests irradiance under punctual lights, directional lights and environments.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "analytic/irradiance.h"

namespace relume::support {
namespace {

class OtherLight : public IrradianceTest {};
INSTANTIATE_TEST_SUITE_P(Lights, OtherLight, kWays, way_name);
INSTANTIATE_TEST_SUITE_P(SlowLights, OtherLight, kOtherWays, way_name);

/// Transform of a node whose -Z points along `direction`.
Transform shining(const Vec3& from, const Vec3& direction) { return look_at(from, from + direction); }

TEST_P(OtherLight, Point) {
  Scene scene = irradiance_meter();
  add_light(scene, {.name = "", .type = PunctualType::point, .intensity = {5, 3, 1}}, {.translation = {0.6f, 0, 0.8f}});
  expect_irradiance(std::move(scene), Vec3(5, 3, 1) * 0.8f, 64);  // I cos θ / d², d = 1
}

TEST_P(OtherLight, PointBehindTheSurface) {
  Scene scene = irradiance_meter();
  add_light(scene, {.name = "", .type = PunctualType::point, .intensity = Rgb(5)}, {.translation = {0, 0, -0.8f}});
  expect_irradiance(std::move(scene), Rgb(0), 4);
}

TEST_P(OtherLight, SpotInsideItsConeAndInItsRamp) {
  const PunctualLight spot{
      .name = "", .type = PunctualType::spot, .intensity = Rgb(4), .inner_cone_rad = 0.2f, .outer_cone_rad = 0.5f};
  for (const float angle : {0.0f, 0.1f, 0.3f, 0.4f, 0.6f}) {
    Scene scene = irradiance_meter();
    const Vec3 from(0, 0, 2);
    add_light(scene, spot, shining(from, {std::sin(angle), 0, -std::cos(angle)}));
    // KHR_lights_punctual: the square of a ramp that is linear in the cosine.
    const double ramp = (std::cos(angle) - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5));
    const double clamped = std::fmin(std::fmax(ramp, 0), 1);
    expect_irradiance(std::move(scene), Rgb(static_cast<float>(4.0 / 4.0 * clamped * clamped)), 64);
  }
}

TEST_P(OtherLight, DirectionalWithAndWithoutSize) {
  // Without a visible size, all samples have nearly the same value.
  for (const auto& [diameter, spp] : {std::pair(0.0f, Samples{64, 64}), {0.01f, {256, 256}}, {0.6f, kOneLamp}}) {
    for (const float tilt : {0.0f, 0.7f}) {
      Scene scene = irradiance_meter();
      PunctualLight sun{.name = "", .type = PunctualType::directional, .intensity = {3, 2, 1}};
      sun.angular_diameter_rad = diameter;
      add_light(scene, sun, shining(Vec3(0), {std::sin(tilt), 0, -std::cos(tilt)}));
      // A disk of uniform radiance above the horizon illuminates a tilted plane by the cosine of its centre, at any
      // size.
      expect_irradiance(std::move(scene), Vec3(3, 2, 1) * std::cos(tilt), spp);
    }
  }
}

TEST_P(OtherLight, NormalMapTurnsTheSurface) {
  Scene scene = irradiance_meter();
  const Vec3 n = glm::normalize(Vec3(2 * 204 / 255.0f - 1, 2 * 102 / 255.0f - 1, 2 * 230 / 255.0f - 1));
  scene.materials[0].normal_texture.texture =
      add_texture(scene, make_texture(1, 1, PixelFormat::rgba8_linear, [](int, int) {
                    return std::array<int, 4>{204, 102, 230, 255};
                  }));
  const Vec3 to_light = glm::normalize(Vec3(0.5f, -0.3f, 1));
  add_light(scene, {.name = "", .type = PunctualType::directional, .intensity = Rgb(1)}, shining(Vec3(0), -to_light));
  // The patch's u increases along +X. glTF's green points up the texture, against increasing v.
  const Mesh& patch = scene.meshes[0];
  float v_along_y = 0;
  for (size_t i = 0; i < patch.positions.size(); ++i) v_along_y += patch.uv0[i].y * patch.positions[i].y;
  const Vec3 world(n.x, v_along_y < 0 ? n.y : -n.y, n.z);
  expect_irradiance(std::move(scene), Rgb(glm::dot(world, to_light)), 64);
}

TEST_P(OtherLight, ConstantEnvironment) {
  Scene scene = irradiance_meter();
  set_constant_environment(scene, {1, 2, 3});
  expect_irradiance(std::move(scene), Vec3(1, 2, 3) * kPi, 256);
}

TEST_P(OtherLight, ConstantEnvironmentBehindAnOccluder) {
  Scene scene = irradiance_meter();
  set_constant_environment(scene, Rgb(1));
  const Mesh occluder = quad({-0.5f, -0.3f, 0.7f}, {1, 0, 0}, {0, 0.9f, 0});
  add(scene, occluder, matte("black", Rgb(0)));
  const double hidden = polygon_irradiance(
      {occluder.positions[0], occluder.positions[1], occluder.positions[2], occluder.positions[3]}, Vec3(0), {0, 0, 1});
  expect_irradiance(std::move(scene), Rgb(static_cast<float>(M_PI - hidden)), kOneLamp);
}

TEST_P(OtherLight, ConstantEnvironmentBesideAWall) {  // hides half of the environment
  Scene scene = irradiance_meter();
  set_constant_environment(scene, Rgb(1));
  add(scene, quad({0.002f, -400, -400}, {0, 800, 0}, {0, 0, 800}), matte("black", Rgb(0)));
  expect_irradiance(std::move(scene), Rgb(kPi / 2), 4096);
}

/// A map lit in the columns right of the centre, and brighter towards the top.
Environment half_lit(int width, int height) {
  Environment environment;
  environment.kind = EnvironmentKind::map;
  environment.width = width;
  environment.height = height;
  for (int i = 0; i < width * height; ++i) {
    const float y = (static_cast<float>(i / width) + 0.5f) / static_cast<float>(height);
    environment.map.push_back(i % width >= width / 2 ? Rgb(1, 1 - y, 4 * std::fmax(0.2f - y, 0.0f)) : Rgb(0));
  }
  return environment;
}

/// Irradiance on a plane with normal n by the midpoint rule over the bilinearly interpolated map. Row 0 is +Y, the
/// centre looks along -Z, and +X is to its right.
Rgb map_irradiance(const Environment& e, const Vec3& n) {
  constexpr int kColumns = 1024;
  constexpr int kRows = 512;
  glm::dvec3 sum(0);
  const auto texel = [&](int x, int y) {
    return glm::dvec3(
        e.map[static_cast<size_t>(int64_t{std::clamp(y, 0, e.height - 1)} * e.width + (x + e.width) % e.width)]);
  };
  for (int i = 0; i < kColumns * kRows; ++i) {
    const double u = (i % kColumns + 0.5) / kColumns;
    const double v = (i / kColumns + 0.5) / kRows;
    const double phi = (u - 0.5) * 2 * M_PI;
    const glm::dvec3 w(std::sin(v * M_PI) * std::sin(phi), std::cos(v * M_PI), -std::sin(v * M_PI) * std::cos(phi));
    const double cosine = glm::dot(w, glm::dvec3(n));
    if (cosine <= 0) continue;
    const double x = u * e.width - 0.5;
    const double y = v * e.height - 0.5;
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    const glm::dvec3 radiance = glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), x - x0),
                                         glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), x - x0), y - y0);
    sum += radiance * (cosine * std::sin(v * M_PI) * (2 * M_PI / kColumns) * (M_PI / kRows));
  }
  return Rgb(sum);
}

TEST_P(OtherLight, EnvironmentMap) {
  const Environment environment = half_lit(32, 16);
  Scene scene = irradiance_meter();
  scene.environment = environment;
  scene.environment.color = Rgb(2);
  expect_irradiance(std::move(scene), 2.0f * map_irradiance(environment, {0, 0, 1}), 3072);
}

TEST_P(OtherLight, EnvironmentMapTurned) {
  const Environment environment = half_lit(32, 16);
  Scene scene = irradiance_meter();
  scene.environment = environment;
  scene.environment.rotation_rad = -0.7f;
  // Rotates the patch in the opposite direction instead of the map about +Y.
  expect_irradiance(std::move(scene), map_irradiance(environment, {std::sin(0.7f), 0, std::cos(0.7f)}));
}

}  // namespace
}  // namespace relume::support
