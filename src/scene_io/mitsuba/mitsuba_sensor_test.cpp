// Cameras of Mitsuba scenes: projected points agree with Mitsuba's matrices.
#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "scene/camera_view.h"
#include "scene/compiled_scene.h"
#include "scene_io/testing/mitsuba_scene.h"

namespace relume {
namespace {

using nlohmann::json;
using testing::error_of;
using testing::load_mitsuba_text;
using testing::mentions;

constexpr const char* kToWorld =
    "<transform name=\"to_world\"><lookat origin=\"1, 2, 3\" target=\"-2, 1, 4\" up=\"0.1, 0.2, 1\"/></transform>";

std::string film(int width, int height, const std::string& more = "") {
  return "<film type=\"hdrfilm\"><integer name=\"width\" value=\"" + std::to_string(width) +
         "\"/><integer name=\"height\" value=\"" + std::to_string(height) + "\"/>" + more + "</film>";
}

/// Matrix of kToWorld by Mitsuba's definition: the columns left, up, direction and origin.
glm::dmat4 to_world() {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(-3, -1, 1));
  const glm::dvec3 left = glm::normalize(glm::cross(glm::dvec3(0.1, 0.2, 1), direction));
  return {glm::dvec4(left, 0), glm::dvec4(glm::cross(direction, left), 0), glm::dvec4(direction, 0),
          glm::dvec4(1, 2, 3, 1)};
}

/// Pixel of a point by Mitsuba's perspective_projection(): a projection with this horizontal angle, then
/// translate(-1, -1 / aspect), then scale(-0.5, -0.5 aspect).
glm::dvec2 mitsuba_pixel(const glm::dvec3& point, double fov_x_rad, double width, double height) {
  const glm::dvec3 local = glm::inverse(to_world()) * glm::dvec4(point, 1);
  const double cotangent = 1 / std::tan(fov_x_rad / 2);
  const glm::dvec2 clip = glm::dvec2(local) * cotangent / local.z;
  const double aspect = width / height;
  return {(clip.x - 1) * -0.5 * width, (clip.y - 1 / aspect) * -0.5 * aspect * height};
}

CameraView view_of(Scene scene, int width, int height) {
  scene.meshes.push_back({.name = "m",
                          .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .normals = {},
                          .tangents = {},
                          .uv0 = {},
                          .uv1 = {},
                          .colors = {},
                          .triangles = {{0, 1, 2}}});
  CompileOptions options;
  options.width = width;
  options.height = height;
  return CompiledScene(std::move(scene), options).view().camera;
}

/// Pixel at which relume sees a point.
glm::dvec2 relume_pixel(const CameraView& camera, const glm::dvec3& point) {
  Ray ray;
  ray.origin = camera.position;
  ray.direction = glm::normalize(Vec3(point) - camera.position);
  Vec2 raster(-1);
  EXPECT_TRUE(raster_position(camera, ray, &raster));
  return raster;
}

/// Points in front of the camera, without symmetry.
const glm::dvec3 kPoints[] = {{-2, 1, 4}, {-2.3, 1.4, 4.1}, {-5, -0.5, 6.2}, {-1, 1.6, 3.3}};

void expect_same_pixels(const std::string& parameters, int width, int height, double fov_x_rad) {
  const Scene scene =
      load_mitsuba_text("<sensor type=\"perspective\">" + parameters + kToWorld + film(width, height) + "</sensor>");
  const CameraView camera = view_of(scene, width, height);
  for (const glm::dvec3& point : kPoints) {
    const glm::dvec2 expected = mitsuba_pixel(point, fov_x_rad, width, height);
    const glm::dvec2 actual = relume_pixel(camera, point);
    EXPECT_NEAR(actual.x, expected.x, 0.01) << parameters;
    EXPECT_NEAR(actual.y, expected.y, 0.01) << parameters;
  }
}

std::string fov(double degrees, const std::string& axis) {
  return "<float name=\"fov\" value=\"" + std::to_string(degrees) + "\"/><string name=\"fov_axis\" value=\"" + axis +
         "\"/>";
}

TEST(MitsubaSensor, PointsLieAtMitsubasPixels) {
  const double degree = std::acos(-1.0) / 180;
  const double x_of_y = 2 * std::atan(std::tan(25 * degree) * 1.5);
  expect_same_pixels(fov(70, "x"), 300, 200, 70 * degree);
  expect_same_pixels(fov(50, "y"), 300, 200, x_of_y);
  expect_same_pixels(fov(50, "Y"), 300, 200, x_of_y);
  expect_same_pixels(fov(50, "smaller"), 300, 200, x_of_y);
  expect_same_pixels(fov(70, "larger"), 300, 200, 70 * degree);
  expect_same_pixels(fov(70, "smaller"), 200, 300, 70 * degree);
  expect_same_pixels(fov(80, "diagonal"), 300, 200, 2 * std::atan(std::tan(40 * degree) * 1.5 / std::sqrt(3.25)));
  // 28 mm on a frame with a diagonal of 43.27 mm
  expect_same_pixels("<string name=\"focal_length\" value=\"28mm\"/>", 300, 200,
                     2 * std::atan(43.2666 / 56 * 1.5 / std::sqrt(3.25)));
}

TEST(MitsubaSensor, RightOfTheImageIsRightOfTheScene) {
  const Scene scene = load_mitsuba_text(
      "<sensor type=\"perspective\"><float name=\"fov\" value=\"60\"/><transform name=\"to_world\"><lookat origin=\"0, "
      "0, 5\" "
      "target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform></sensor>");
  const glm::dvec2 pixel = relume_pixel(view_of(scene, 768, 576), {1, 0.5, 0});
  EXPECT_GT(pixel.x, 384);
  EXPECT_LT(pixel.y, 288);
}

TEST(MitsubaSensor, AMirroredSensorMirrorsTheScene) {
  const Scene scene = load_mitsuba_text(
      "<sensor type=\"perspective\"><float name=\"fov\" value=\"60\"/><transform name=\"to_world\"><scale "
      "x=\"-1\"/><lookat "
      "origin=\"2, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform></sensor><shape type=\"sphere\"><point "
      "name=\"center\" x=\"1\" y=\"0.5\" z=\"-1\"/></shape>");
  size_t sphere = 0;
  while (scene.nodes[sphere].meshes.empty()) ++sphere;
  // Mitsuba's local x grows to the left; the mirror reverses it.
  const glm::dvec3 to_sphere(-1, 0.5, -6);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(-2, 0, -5));
  const double left = -glm::dot(glm::normalize(glm::cross(glm::dvec3(0, 1, 0), direction)), to_sphere);
  const double slope = left / glm::dot(direction, to_sphere) / std::tan(std::acos(-1.0) / 6);
  const Vec3 position(world_matrices(scene, 0)[sphere] * Vec4(0, 0, 0, 1));
  EXPECT_NEAR(relume_pixel(view_of(scene, 768, 576), position).x, 384 - 384 * slope, 0.01);
}

TEST(MitsubaSensor, OrthographicFilmsAreScaledByTheSensor) {
  const Scene scene = load_mitsuba_text(
      "<sensor type=\"orthographic\"><transform name=\"to_world\"><scale x=\"4\" y=\"4\"/><translate x=\"1\" "
      "z=\"-5\"/></transform>" +
      film(200, 100) + "</sensor>");
  EXPECT_EQ(scene.cameras.at(0).projection, Projection::orthographic);
  EXPECT_FLOAT_EQ(scene.cameras.at(0).half_height, 2);  // [-4, 4] across, half of it up
  const CameraView camera = view_of(scene, 200, 100);
  Ray ray;
  ray.origin = Vec3(4, 1, 0);  // 3 of 4 to the left: +X of the sensor is to the left
  ray.direction = Vec3(0, 0, 1);
  Vec2 raster;
  ASSERT_TRUE(raster_position(camera, ray, &raster));
  EXPECT_NEAR(raster.x, 25, 1e-3);
  EXPECT_NEAR(raster.y, 25, 1e-3);
}

TEST(MitsubaSensor, ThinLens) {
  const Scene scene = load_mitsuba_text(
      "<sensor type=\"thinlens\"><float name=\"fov\" value=\"40\"/><float name=\"aperture_radius\" value=\"0.2\"/>"
      "<float name=\"focus_distance\" value=\"6\"/></sensor>");
  EXPECT_FLOAT_EQ(scene.cameras.at(0).lens_radius, 0.2f);
  EXPECT_FLOAT_EQ(scene.cameras.at(0).focus_distance, 6);
}

TEST(MitsubaSensor, FilmSamplerAndIntegratorBecomeSettings) {
  const Scene scene = load_mitsuba_text(
      "<integrator type=\"path\"><integer name=\"max_depth\" value=\"5\"/></integrator><sensor "
      "type=\"perspective\"><float "
      "name=\"fov\" value=\"40\"/>" +
      film(640, 400) +
      "<sampler type=\"independent\"><integer name=\"sample_count\" value=\"32\"/></sampler></sensor>");
  EXPECT_EQ(json::parse(scene.settings_json), json({{"width", 640}, {"height", 400}, {"spp", 32}, {"max-bounces", 4}}));
  EXPECT_FLOAT_EQ(scene.cameras.at(0).aspect_ratio, 1.6f);
  const Scene endless =
      load_mitsuba_text("<integrator type=\"path\"><integer name=\"max_depth\" value=\"-1\"/></integrator>");
  EXPECT_EQ(json::parse(endless.settings_json), json({{"max-bounces", 1024}}));
  const Scene direct = load_mitsuba_text("<integrator type=\"direct\"/>");
  EXPECT_EQ(json::parse(direct.settings_json), json({{"max-bounces", 1}}));
  EXPECT_NE(
      error_of([] { load_mitsuba_text("<sensor type=\"perspective\">" + film(0, 10) + "</sensor>"); }).find("0 pixels"),
      std::string::npos);
}

TEST(MitsubaSensor, CentredCropsNarrowTheViewOthersAreRequested) {
  const std::string crop =
      "<integer name=\"crop_width\" value=\"100\"/><integer name=\"crop_height\" value=\"50\"/><integer "
      "name=\"crop_offset_x\" "
      "value=\"100\"/><integer name=\"crop_offset_y\" value=\"";
  const auto load = [&](const std::string& y) {
    return load_mitsuba_text("<sensor type=\"perspective\">" + fov(70, "x") + kToWorld +
                             film(300, 200, crop + y + "\"/>") + "</sensor>");
  };
  const Scene scene = load("75");
  EXPECT_EQ(json::parse(scene.settings_json), json({{"width", 100}, {"height", 50}, {"max-bounces", 1024}}));
  const CameraView camera = view_of(scene, 100, 50);
  const glm::dvec2 expected = mitsuba_pixel(kPoints[1], 70 * std::acos(-1.0) / 180, 300, 200) - glm::dvec2(100, 75);
  const glm::dvec2 actual = relume_pixel(camera, kPoints[1]);
  EXPECT_NEAR(actual.x, expected.x, 0.01);
  EXPECT_NEAR(actual.y, expected.y, 0.01);
  EXPECT_EQ(scene.crop, ImagePart{});
  const Scene off_centre = load("10");
  EXPECT_EQ(off_centre.crop, (ImagePart{1.0f / 3, 0.05f, 2.0f / 3, 0.3f}));
  EXPECT_EQ(json::parse(off_centre.settings_json)["width"], 300);
  for (const std::string y : {"151", "-9223372036854775808", "9223372036854775807"}) {
    EXPECT_NE(error_of([&] { load(y); }).find("the crop 100," + y + ",100,50 is not within the film of 300x200 pixels"),
              std::string::npos);
  }
}

TEST(MitsubaTransform, StepsApplyInTheirOrder) {
  const auto at = [](const std::string& steps) {
    const Scene scene =
        load_mitsuba_text("<shape type=\"cube\"><transform name=\"to_world\">" + steps + "</transform></shape>");
    return Vec3(*scene.nodes.at(0).matrix * Vec4(1, 0, 0, 1));
  };
  const auto near = [](const Vec3& a, const Vec3& b) { return glm::length(a - b) < 1e-5f; };
  EXPECT_TRUE(near(at("<translate x=\"1\"/><rotate z=\"1\" angle=\"90\"/><scale value=\"2\"/>"), {0, 4, 0}));
  EXPECT_TRUE(near(at("<scale x=\"2\" y=\"3\"/><translate value=\"1, 2, 3\"/>"), {3, 2, 3}));
  EXPECT_TRUE(near(at("<rotate y=\"1\" angle=\"90\"/>"), {0, 0, -1}));
  EXPECT_TRUE(near(at("<matrix value=\"0 0 1 5  0 1 0 6  -1 0 0 7  0 0 0 1\"/>"), {5, 6, 6}));
  EXPECT_TRUE(near(at("<lookat origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"/>"), {-1, 0, 5}));
  EXPECT_NE(error_of([&] { at("<rotate angle=\"3\"/>"); }).find("a.xml:2: the axis of a rotation is zero"),
            std::string::npos);
  EXPECT_NE(error_of([&] { at("<lookat origin=\"1 1 1\" target=\"1 1 1\"/>"); }).find("are equal"), std::string::npos);
}

TEST(MitsubaSensor, IntegratorsOfOtherQuantitiesGiveAWarning) {
  EXPECT_TRUE(load_mitsuba_text("<integrator type=\"volpath\"/>").warnings.empty());
  EXPECT_TRUE(mentions(load_mitsuba_text("<integrator type=\"depth\"/>").warnings,
                       "integrator 'depth' is not supported; light is traced along paths"));
}

}  // namespace
}  // namespace relume
