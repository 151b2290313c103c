// Lamps and environments of Mitsuba scenes.
#include <cmath>

#include <gtest/gtest.h>

#include "relume/image_io.h"
#include "scene/scene_view.h"
#include "scene/sun_sky.h"
#include "scene_io/mitsuba/mitsuba_emitters.h"
#include "scene_io/testing/mitsuba_scene.h"

namespace relume {
namespace {

using testing::load_mitsuba_text;
using testing::mentions;
using testing::SceneFolder;

/// Direction in which a node's lamp shines.
Vec3 direction_of(const Scene& scene, size_t node) {
  return Vec3(world_matrices(scene, 0).at(node) * Vec4(0, 0, -1, 0));
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

TEST(MitsubaEmitters, PunctualLamps) {
  const Scene scene = load_mitsuba_text(
      "<emitter type=\"point\"><point name=\"position\" value=\"1, 2, 3\"/><rgb name=\"intensity\" value=\"4, 5, "
      "6\"/></emitter>"
      "<emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0, 5, 0\" target=\"2, 4, 0\" up=\"0, 0, "
      "1\"/></transform>"
      "<float name=\"cutoff_angle\" value=\"40\"/></emitter>"
      "<emitter type=\"directional\"><vector name=\"direction\" value=\"0, -2, 0\"/><rgb name=\"irradiance\" "
      "value=\"3\"/></emitter>");
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].intensity, Rgb(4, 5, 6));
  EXPECT_EQ(scene.nodes[0].transform.translation, Vec3(1, 2, 3));
  EXPECT_FLOAT_EQ(scene.lights[1].outer_cone_rad, 40 * kPi / 180);
  // Of the same power as with a linear fall from 30° to 40°, by numerical integration.
  EXPECT_NEAR(scene.lights[1].inner_cone_rad, 32.41935 * kPi / 180, 1e-5);
  EXPECT_TRUE(mentions(scene.warnings, "spot lamps fade as in glTF, with the same power"));
  expect_near(direction_of(scene, 1), glm::normalize(Vec3(2, -1, 0)));
  EXPECT_EQ(scene.lights[2].type, PunctualType::directional);
  EXPECT_EQ(scene.lights[2].intensity, Rgb(3));
  expect_near(direction_of(scene, 2), Vec3(0, -1, 0));
}

Rgb radiance(const std::string& spectrum) {
  return load_mitsuba_text("<emitter type=\"constant\">" + spectrum + "</emitter>").environment.color;
}

TEST(MitsubaEmitters, SpectraBecomeColoursAsInMitsubasRgbModes) {
  EXPECT_EQ(radiance("<rgb name=\"radiance\" value=\"1, 2, 3\"/>"), Rgb(1, 2, 3));
  EXPECT_EQ(radiance("<float name=\"radiance\" value=\"2\"/>"), Rgb(2));
  // XYZ (1, 1, 1) in Rec. 709.
  expect_near(radiance("<spectrum name=\"radiance\" value=\"1\"/>"), Rgb(1.2048f, 0.9484f, 0.9089f), 5e-3f);
  EXPECT_EQ(radiance("<spectrum type=\"d65\" name=\"radiance\"><float name=\"scale\" value=\"3\"/></spectrum>"),
            Rgb(3));
  // Planck's law at 560 nm and 5000 K is 12.7 kW/(sr·m²·nm)·1e-3; luminance is close to this value.
  const Rgb black = radiance(
      "<spectrum type=\"blackbody\" name=\"radiance\"><float name=\"temperature\" value=\"5000\"/></spectrum>");
  EXPECT_NEAR(luminance(black), 12690, 200);
  EXPECT_GT(black.r, black.b);
  const Rgb table = radiance("<spectrum name=\"radiance\" value=\"360:2, 830:2\"/>");
  expect_near(table, 2.0f * Rgb(1.2048f, 0.9484f, 0.9089f), 1e-2f);
}

/// Folder with an environment map whose texels store their column and row.
struct Mapped : SceneFolder {
  static constexpr int kWidth = 64;
  static constexpr int kHeight = 32;
  Mapped() {
    Image image(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) image.at(x, y) = Rgb(static_cast<float>(x), static_cast<float>(y), 1);
    }
    write_image(path() / "map.exr", image);
  }
  Environment load(const std::string& to_world) const {
    return load_mitsuba_text(
               "<emitter type=\"envmap\"><string name=\"filename\" value=\"map.exr\"/><float name=\"scale\" "
               "value=\"2\"/>" +
                   to_world + "</emitter>",
               path())
        .environment;
  }
};

/// Column and row at which Mitsuba looks for `world`: uv = (atan2(x, -z) / 2π, acos(y) / π) of the local direction.
Vec2 mitsuba_texel(const glm::dmat3& to_world, const glm::dvec3& world) {
  const glm::dvec3 d = glm::inverse(to_world) * world;
  double u = std::atan2(d.x, -d.z) / (2 * std::acos(-1.0));
  u -= std::floor(u);
  return {static_cast<float>(u * Mapped::kWidth - 0.5),
          static_cast<float>(std::acos(d.y) / std::acos(-1.0) * Mapped::kHeight - 0.5)};
}

/// Column and row that the environment shows in direction `world`, by the definition of Environment.
Vec2 relume_texel(const Environment& e, const glm::dvec3& world) {
  const double c = std::cos(e.rotation_rad);
  const double s = std::sin(e.rotation_rad);
  const glm::dvec3 d(c * world.x - s * world.z, world.y, s * world.x + c * world.z);  // rotated back about +Y
  const double u = (0.5 + std::atan2(d.x, -d.z) / (2 * std::acos(-1.0))) * e.width;
  const double v = std::acos(d.y) / std::acos(-1.0) * e.height;
  const Rgb texel = e.map[static_cast<size_t>(v) * static_cast<size_t>(e.width) +
                          static_cast<size_t>(u) % static_cast<size_t>(e.width)];
  return {texel.x, texel.y};
}

TEST(MitsubaEnvironment, DirectionsAreMitsubas) {
  const Mapped folder;
  const struct {
    std::string xml;
    glm::dvec3 axis;
    double degrees;
  } kRotations[] = {
      {"", {0, 1, 0}, 0},
      {"<transform name=\"to_world\"><rotate y=\"1\" angle=\"50\"/></transform>", {0, 1, 0}, 50},
      {"<transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform>", {1, 0, 0}, 90},
      {"<transform name=\"to_world\"><rotate x=\"1\" y=\"2\" z=\"-1\" angle=\"70\"/></transform>", {1, 2, -1}, 70}};
  for (const auto& rotation : kRotations) {
    const Environment e = folder.load(rotation.xml);
    EXPECT_EQ(e.color, Rgb(2));
    const glm::dmat3 to_world(
        glm::mat3_cast(glm::angleAxis(rotation.degrees * std::acos(-1.0) / 180, glm::normalize(rotation.axis))));
    for (const glm::dvec3 direction :
         {glm::dvec3(0.3, 0.2, -1), glm::dvec3(1, 0.1, 0.2), glm::dvec3(-0.4, -0.5, 0.6), glm::dvec3(-1, 0.3, -0.1)}) {
      const Vec2 expected = mitsuba_texel(to_world, glm::normalize(direction));
      const Vec2 actual = relume_texel(e, glm::normalize(direction));
      EXPECT_NEAR(std::remainder(actual.x - expected.x, Mapped::kWidth), 0, 1.5f) << rotation.xml;
      EXPECT_NEAR(actual.y, expected.y, 1.5f) << rotation.xml;
    }
  }
}

TEST(MitsubaEnvironment, IsMirroredWithTheScene) {
  const Mapped folder;
  const Environment e = load_mitsuba_text(
                            "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><transform "
                            "name=\"to_world\"><scale x=\"-1\"/></transform></sensor>"
                            "<emitter type=\"envmap\"><string name=\"filename\" value=\"map.exr\"/></emitter>",
                            folder.path())
                            .environment;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, 0.2, -1));
  const Vec2 actual = relume_texel(e, direction * glm::dvec3(-1, 1, 1));
  EXPECT_NEAR(actual.x, mitsuba_texel(glm::dmat3(1), direction).x, 1.5f);
}

TEST(MitsubaEnvironment, OnlyTheFirstCounts) {
  const Scene scene = load_mitsuba_text(
      "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"2\"/></emitter><emitter type=\"sunsky\"/>");
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::constant);
  EXPECT_TRUE(mentions(scene.warnings, "a second environment, emitter 'sunsky', is ignored"));
  EXPECT_EQ(load_mitsuba_text("").environment.kind, EnvironmentKind::automatic);
  const Scene missing =
      load_mitsuba_text("<emitter type=\"envmap\"><string name=\"filename\" value=\"gone.exr\"/></emitter>");
  EXPECT_TRUE(mentions(missing.warnings, "the environment map is left out"));
}

TEST(MitsubaDaylight, TheSunIsWhereMitsubasIs) {
  // The emitter's frame has +Z up, so the scene is turned: world +Z becomes +Y.
  const Scene scene = load_mitsuba_text(
      "<emitter type=\"sunsky\"><vector name=\"sun_direction\" x=\"1\" y=\"2\" z=\"3\"/><float name=\"turbidity\" "
      "value=\"5\"/></emitter>"
      "<emitter type=\"directional\"><vector name=\"direction\" x=\"-1\" y=\"-2\" z=\"-3\"/></emitter>"
      "<shape type=\"cube\"/>");
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::sun_sky);
  EXPECT_EQ(scene.environment.sun_sky.turbidity, 5);
  EXPECT_NEAR(scene.environment.sun_sky.sun_elevation_rad, std::asin(3 / std::sqrt(14.0)), 1e-6);
  size_t lamp = 0;
  while (scene.nodes[lamp].light == kNone) ++lamp;
  expect_near(sun_direction(scene.environment.sun_sky), -direction_of(scene, lamp));
  expect_near(
      Vec3(world_matrices(scene, 0).back() * Vec4(0, 0, 1, 0)) + Vec3(world_matrices(scene, 0)[1] * Vec4(0, 0, 1, 0)),
      Vec3(0, 2, 0), 2.1f);
}

TEST(MitsubaDaylight, ScenesWithYUpAreNotTurned) {
  const Scene scene = load_mitsuba_text(
      "<emitter type=\"sunsky\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/></transform>"
      "<vector name=\"sun_direction\" x=\"0\" y=\"1\" z=\"1\"/><float name=\"sky_scale\" value=\"0\"/></emitter><shape "
      "type=\"cube\"/>");
  ASSERT_EQ(scene.nodes.size(), 1u);
  expect_near(sun_direction(scene.environment.sun_sky), glm::normalize(Vec3(0, 1, 1)));
  EXPECT_EQ(scene.environment.sun_sky.sky_scale, 0);
  // 1 W/(sr·m²·nm) in all of ȳ, whose integral is 106.86 nm, is 683 · 106.86 cd/m².
  EXPECT_NEAR(scene.environment.sun_sky.sun_scale, 1000 / (683 * 106.86), 2e-5);
}

TEST(MitsubaDaylight, UntilVersionTwoYIsUp) {
  const auto load = [](const std::string& elements) {
    return load_mitsuba_from_memory(
        testing::to_bytes("<scene version=\"0.6.0\">" + elements + "<shape type=\"cube\"/></scene>"), "/nonexistent",
        "a.xml");
  };
  // 46.08° above the horizon, 265.75° from the north (−Z) by the east (+X).
  const Scene sky = load("<emitter type=\"sky\"><float name=\"scale\" value=\"2\"/></emitter>");
  EXPECT_EQ(sky.nodes.size(), 1u);  // not turned
  const SunSky& s = sky.environment.sun_sky;
  EXPECT_NEAR(s.sun_elevation_rad * 180 / kPi, 46.08, 0.1);
  const Vec3 sun = sun_direction(s);
  EXPECT_NEAR(std::remainder(std::atan2(sun.x, -sun.z) * 180 / kPi - 265.75, 360.0), 0, 0.1);
  EXPECT_NEAR(s.sky_scale, 2000 / (683 * 106.86), 4e-5);
  EXPECT_EQ(s.sun_scale, 0);
  const Scene both = load(
      "<emitter type=\"sunsky\"><vector name=\"sunDirection\" x=\"0\" y=\"1\" z=\"1\"/><float name=\"sunRadiusScale\" "
      "value=\"3\"/></emitter>");
  EXPECT_EQ(both.nodes.size(), 1u);
  expect_near(sun_direction(both.environment.sun_sky), glm::normalize(Vec3(0, 1, 1)));
  EXPECT_NEAR(both.environment.sun_sky.sun_angular_diameter_rad, 3 * 0.5358 * kPi / 180, 1e-6);
}

TEST(MitsubaDaylight, DateAndPlaceGiveTheSun) {
  // Elevation and azimuth (from the north by the east) by the algorithm of NOAA's solar calculator, degrees.
  const struct {
    std::string xml;
    double elevation, azimuth;
  } kCases[] = {{"", 46.08, 265.75},
                {"<integer name=\"year\" value=\"2023\"/><integer name=\"month\" value=\"12\"/><integer name=\"day\" "
                 "value=\"1\"/><float "
                 "name=\"hour\" value=\"9\"/><float name=\"minute\" value=\"30\"/><float name=\"timezone\" "
                 "value=\"1\"/><float name=\"latitude\" "
                 "value=\"52.52\"/><float name=\"longitude\" value=\"13.405\"/>",
                 9.26, 146.14}};
  for (const auto& c : kCases) {
    const Scene scene = load_mitsuba_text("<emitter type=\"sunsky\">" + c.xml + "</emitter>");
    const Vec3 turned = sun_direction(scene.environment.sun_sky);
    const glm::mat3 upright(scene.nodes.empty() ? glm::mat3(1) : glm::mat3(world_matrices(scene, 0)[0]));
    const Vec3 d = glm::transpose(upright) * turned;  // +X south, +Y west, +Z up
    EXPECT_NEAR(std::asin(d.z) * 180 / kPi, c.elevation, 0.1) << c.xml;
    EXPECT_NEAR(std::remainder(std::atan2(-d.y, -d.x) * 180 / kPi - c.azimuth, 360.0), 0, 0.1) << c.xml;
  }
}

}  // namespace
}  // namespace relume
