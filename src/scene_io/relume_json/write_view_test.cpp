// Checks that the reader recovers the writer's output.
#include "scene_io/relume_json/write_view.h"

#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene_io/look_rotation.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::GltfBuilder;
using testing::json;
using testing::SceneFolder;

/// Scene of a file that contains `parts` and references a triangle with material "paint" in node "part".
Scene read_back(json parts) {
  GltfBuilder file;
  file.add("materials", {{"name", "paint"}});
  file.add_root({{"name", "part"}, {"mesh", file.add_triangle({{"material", 0}})}});
  const SceneFolder folder;
  folder.write("base.gltf", file.text());
  parts["scene"] = "base.gltf";
  return load_scene(folder.write("view.json", parts.dump()));
}

Mat4 placed(const Vec3& eye, const glm::quat& rotation) {
  Mat4 to_world = glm::mat4_cast(rotation);
  to_world[3] = Vec4(eye, 1);
  return to_world;
}

void expect_near(const Mat4& a, const Mat4& b) {
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(glm::distance(Vec3(a[c]), Vec3(b[c])), 0, 1e-5) << c;
}

TEST(WriteView, CamerasRoundTrip) {
  const Mat4 to_world = placed({4, 5, 6}, look_rotation({1, -2, 3}, {1, 1, 0}));
  for (const Projection projection : {Projection::perspective, Projection::orthographic, Projection::panoramic}) {
    Camera camera;
    camera.name = "view";
    camera.projection = projection;
    camera.fov_y_rad = 0.5f;
    camera.half_height = 3;
    camera.aspect_ratio = 1.25f;
    camera.lens_radius = 0.125f;
    camera.focus_distance = 7;
    json file;
    file["camera"] = camera_to_json(camera, to_world);
    const Scene scene = read_back(file);
    const Camera& loaded = scene.cameras.front();
    EXPECT_EQ(loaded.name, "view");
    EXPECT_EQ(loaded.projection, projection);
    EXPECT_FLOAT_EQ(loaded.fov_y_rad, 0.5f);
    EXPECT_EQ(loaded.half_height, 3);
    EXPECT_EQ(loaded.aspect_ratio, 1.25f);
    EXPECT_EQ(loaded.lens_radius, 0.125f);
    EXPECT_EQ(loaded.focus_distance, 7);
    expect_near(world_matrices(scene, 0).back(), to_world);
  }
}

TEST(WriteView, CamerasFarFromTheOriginKeepTheirDirection) {
  const Mat4 to_world = placed({5e6f, 2, -5e8f}, look_rotation({1, 0, 3}));
  json file;
  file["camera"] = camera_to_json({}, to_world);
  EXPECT_LT(glm::distance(Vec3(world_matrices(read_back(file), 0).back()[2]), Vec3(to_world[2])), 1e-6f);
}

TEST(WriteView, KeysMoveTheCamera) {
  const glm::quat from = look_rotation({0, 0, -1});
  const glm::quat to = look_rotation({1, -0.5f, 0});
  json file;
  file["camera"] = camera_to_json({}, placed({9, 9, 9}, from));
  file["camera_keys"] = {camera_key_to_json(1, {0, 1, 5}, from), camera_key_to_json(3, {2, 1, 5}, to)};
  const Scene scene = read_back(file);
  EXPECT_EQ(animation_end(scene), 3);
  expect_near(world_matrices(scene, 1).back(), placed({0, 1, 5}, from));
  expect_near(world_matrices(scene, 3).back(), placed({2, 1, 5}, to));
}

TEST(WriteView, MaterialsRoundTrip) {
  Material material;
  material.base_color = {0.1f, 0.2f, 0.3f};
  material.metallic = 0.125f;
  material.roughness = 0.3f;
  material.emission = {4, 5, 6};
  material.transmission = 0.7f;
  material.ior = 1.25f;
  material.specular = 0.6f;
  material.clearcoat = 0.9f;
  material.clearcoat_roughness = 0.05f;
  json file;
  file["materials"]["paint"] = material_to_json(material);
  const Scene scene = read_back(file);
  const Material& loaded = scene.materials[0];
  EXPECT_EQ(loaded.base_color, material.base_color);
  EXPECT_EQ(loaded.metallic, material.metallic);
  EXPECT_EQ(loaded.roughness, material.roughness);
  EXPECT_EQ(loaded.emission, material.emission);
  EXPECT_EQ(loaded.transmission, material.transmission);
  EXPECT_EQ(loaded.ior, material.ior);
  EXPECT_EQ(loaded.specular, material.specular);
  EXPECT_EQ(loaded.clearcoat, material.clearcoat);
  EXPECT_EQ(loaded.clearcoat_roughness, material.clearcoat_roughness);
}

TEST(WriteView, TransformsRoundTrip) {
  // The second is one rounding from gimbal lock, where X and Z rotate about the same axis.
  for (const glm::quat& rotation :
       {look_rotation({0.3f, 0.2f, -0.9f}, {1, 2, 0}), glm::quat(0.70710677f, 0, 0.70710683f, 0)}) {
    Transform transform;
    transform.translation = {1, -2, 3};
    transform.rotation = rotation;
    transform.scale = {1, 2, 0.5f};
    json file;
    file["nodes"]["part"] = transform_to_json(transform);
    const Scene scene = read_back(file);
    Mat4 expected = placed(transform.translation, transform.rotation);
    for (int axis = 0; axis < 3; ++axis) expected[axis] *= transform.scale[axis];
    expect_near(world_matrices(scene, 0)[0], expected);
  }
}

TEST(WriteView, EnvironmentsRoundTrip) {
  const auto loaded = [](const Environment& environment) {
    json file;
    file["environment"] = environment_to_json(environment);
    return read_back(file).environment;
  };
  Environment e;
  for (const EnvironmentKind kind : {EnvironmentKind::none, EnvironmentKind::studio, EnvironmentKind::automatic}) {
    e.kind = kind;
    EXPECT_EQ(loaded(e).kind, kind);
  }

  e.kind = EnvironmentKind::constant;
  e.color = {0.5f, 0.25f, 2};
  EXPECT_EQ(loaded(e).kind, EnvironmentKind::constant);
  EXPECT_EQ(loaded(e).color, e.color);

  e.kind = EnvironmentKind::sun_sky;
  e.rotation_rad = 0.75f;
  e.sun_sky = {0.3f, -1.5f, 4, 0.5f, 2, 0.02f, {0.1f, 0.2f, 0.3f}};
  const Environment sky = loaded(e);
  EXPECT_EQ(sky.kind, EnvironmentKind::sun_sky);
  EXPECT_EQ(sky.color, e.color);
  EXPECT_FLOAT_EQ(sky.rotation_rad, e.rotation_rad);
  EXPECT_FLOAT_EQ(sky.sun_sky.sun_elevation_rad, e.sun_sky.sun_elevation_rad);
  EXPECT_FLOAT_EQ(sky.sun_sky.sun_azimuth_rad, e.sun_sky.sun_azimuth_rad);
  EXPECT_EQ(sky.sun_sky.turbidity, e.sun_sky.turbidity);
  EXPECT_EQ(sky.sun_sky.sky_scale, e.sun_sky.sky_scale);
  EXPECT_EQ(sky.sun_sky.sun_scale, e.sun_sky.sun_scale);
  EXPECT_FLOAT_EQ(sky.sun_sky.sun_angular_diameter_rad, e.sun_sky.sun_angular_diameter_rad);
  EXPECT_EQ(sky.sun_sky.ground_albedo, e.sun_sky.ground_albedo);
}

TEST(WriteView, MapsLeaveTheirFileToTheCaller) {
  Environment e;
  e.kind = EnvironmentKind::map;
  e.color = {1, 2, 3};
  EXPECT_EQ(environment_to_json(e), (json{{"rotation_deg", 0.0}, {"scale", {1.0, 2.0, 3.0}}}));
}

}  // namespace
}  // namespace relume
