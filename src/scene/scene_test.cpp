// Animation and the scene hash.
#include "scene/scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

#include "scene/scene_hash.h"

namespace relume {
namespace {

AnimationChannel channel(AnimatedProperty property, Interpolation interpolation, std::vector<float> times,
                         std::vector<Vec4> values) {
  return {0, property, interpolation, std::move(times), std::move(values)};
}

Scene one_node(AnimationChannel c) {
  Scene scene;
  scene.add_node({});
  scene.animation.push_back(std::move(c));
  return scene;
}

Vec3 position_at(const Scene& scene, float time) { return Vec3(world_matrices(scene, time)[0][3]); }

TEST(Animation, StepsHoldTheirValue) {
  const Scene s = one_node(channel(AnimatedProperty::translation, Interpolation::step, {1, 2}, {Vec4(1), Vec4(5)}));
  EXPECT_EQ(position_at(s, 0).x, 1);
  EXPECT_EQ(position_at(s, 1.9f).x, 1);
  EXPECT_EQ(position_at(s, 2).x, 5);
  EXPECT_EQ(position_at(s, 9).x, 5);
  EXPECT_EQ(animation_end(s), 2);
}

TEST(Animation, LinearInterpolatesAndHoldsOutside) {
  const Scene s = one_node(
      channel(AnimatedProperty::translation, Interpolation::linear, {1, 3}, {Vec4(1, 2, 3, 0), Vec4(5, 2, -1, 0)}));
  EXPECT_EQ(position_at(s, 0), Vec3(1, 2, 3));
  EXPECT_EQ(position_at(s, 1.5f), Vec3(2, 2, 2));
  EXPECT_EQ(position_at(s, 4), Vec3(5, 2, -1));
}

// The search for the next key must not pass the last.
TEST(Animation, NanTimeIsTheStart) {
  const Scene s = one_node(channel(AnimatedProperty::translation, Interpolation::linear, {1, 3}, {Vec4(1), Vec4(5)}));
  EXPECT_EQ(position_at(s, std::numeric_limits<float>::quiet_NaN()), Vec3(1));
}

TEST(Animation, CubicSplineReproducesACubic) {
  // x(t) = t³ − 2t: Hermite splines are exact for cubics at any interval.
  const auto x = [](float t) { return t * t * t - 2 * t; };
  const auto slope = [](float t) { return 3 * t * t - 2; };
  const Scene s =
      one_node(channel(AnimatedProperty::translation, Interpolation::cubic_spline, {0.5f, 2.5f},
                       {Vec4(99), Vec4(x(0.5f)), Vec4(slope(0.5f)), Vec4(slope(2.5f)), Vec4(x(2.5f)), Vec4(99)}));
  for (const float t : {0.5f, 0.9f, 1.7f, 2.5f}) EXPECT_NEAR(position_at(s, t).x, x(t), 1e-5f) << t;
}

TEST(Animation, RotationsTurnAtConstantSpeedTheShortWay) {
  const auto about_y = [](float angle) { return Vec4(0, std::sin(angle / 2), 0, std::cos(angle / 2)); };
  for (const float sign : {1.0f, -1.0f}) {  // q and −q are the same rotation
    const Scene s = one_node(
        channel(AnimatedProperty::rotation, Interpolation::linear, {0, 1}, {about_y(0), about_y(1.2f) * sign}));
    for (const float t : {0.25f, 0.5f, 0.75f}) {
      const Vec3 x(world_matrices(s, t)[0][0]);
      EXPECT_NEAR(x.x, std::cos(1.2f * t), 1e-5f);
      EXPECT_NEAR(x.z, -std::sin(1.2f * t), 1e-5f);
    }
  }
}

TEST(Animation, MovesDescendantsInAnyNodeOrder) {
  Scene scene;
  Node child;
  child.parent = 1;
  child.transform.translation = Vec3(0, 1, 0);
  scene.add_node(child);
  scene.add_node({});
  scene.add_node({});
  AnimationChannel c = channel(AnimatedProperty::scale, Interpolation::linear, {0, 1}, {Vec4(1), Vec4(3)});
  c.node = 1;
  scene.animation.push_back(c);
  EXPECT_EQ(position_at(scene, 1), Vec3(0, 3, 0));
  EXPECT_EQ(moving_nodes(scene), (std::vector<bool>{true, true, false}));
}

TEST(LookAt, PointsTheCameraAtItsTarget) {
  const Transform t = look_at(Vec3(1, 2, 3), Vec3(-2, 0, 1));
  const Vec3 forward = t.rotation * Vec3(0, 0, -1);
  EXPECT_LT(glm::length(forward - glm::normalize(Vec3(-3, -2, -2))), 1e-5f);
  EXPECT_NEAR((t.rotation * Vec3(1, 0, 0)).y, 0, 1e-6f);  // horizontal
}

TEST(Scene, CamerasMayLookStraightDown) {
  const Transform t = look_at(Vec3(1, 2, 3), Vec3(1, 0, 3));
  EXPECT_LT(glm::length(t.rotation * Vec3(0, 0, -1) - Vec3(0, -1, 0)), 1e-6f);
  EXPECT_LT(glm::length(t.rotation * Vec3(1, 0, 0) - Vec3(1, 0, 0)), 1e-6f);
}

/// A scene with every kind of part, so every change below applies to something.
Scene full_scene() {
  Scene s;
  s.textures.push_back({"t",
                        1,
                        1,
                        PixelFormat::rgba8_srgb,
                        WrapMode::repeat,
                        WrapMode::repeat,
                        FilterMode::linear,
                        std::vector<std::byte>(4),
                        {}});
  s.materials.emplace_back();
  Mesh m;
  m.positions = {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  m.normals = {Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(0, 0, 1)};
  m.tangents.resize(3);
  m.uv0.resize(3);
  m.uv1.resize(3);
  m.colors.resize(3);
  m.triangles = {{0, 1, 2}};
  m.material = 0;
  s.meshes.push_back(m);
  s.lights.emplace_back();
  s.cameras.emplace_back();
  s.add_node({});
  s.nodes[0].meshes = {0};
  s.nodes[0].instances = {Mat4(1)};
  s.animation.push_back(channel(AnimatedProperty::translation, Interpolation::linear, {0, 1}, {Vec4(0), Vec4(1)}));
  s.environment.map = {Rgb(1)};
  s.environment.width = s.environment.height = 1;
  return s;
}

#define CHANGE(statement)                      \
  {                                            \
#statement, [](Scene & s) { s.statement; } \
  }

using NamedChange = std::pair<std::string, std::function<void(Scene&)>>;

/// Changes of textures and materials.
std::vector<NamedChange> surface_changes() {
  return {CHANGE(textures[0].width = 2),
          CHANGE(textures[0].height = 2),
          CHANGE(textures[0].format = PixelFormat::rgba8_linear),
          CHANGE(textures[0].wrap_u = WrapMode::clamp),
          CHANGE(textures[0].wrap_v = WrapMode::clamp),
          CHANGE(textures[0].filter = FilterMode::nearest),
          CHANGE(textures[0].texels[3] = std::byte{1}),
          CHANGE(materials[0].base_color.g = 0.5f),
          CHANGE(materials[0].alpha = 0.5f),
          CHANGE(materials[0].base_color_texture.texture = 0),
          CHANGE(materials[0].base_color_texture.uv_set = 1),
          CHANGE(materials[0].base_color_texture.offset.x = 1),
          CHANGE(materials[0].base_color_texture.scale.y = 2),
          CHANGE(materials[0].base_color_texture.rotation_rad = 1),
          CHANGE(materials[0].metallic = 0.5f),
          CHANGE(materials[0].roughness = 0.5f),
          CHANGE(materials[0].metallic_roughness_texture.texture = 0),
          CHANGE(materials[0].normal_texture.texture = 0),
          CHANGE(materials[0].normal_scale = 2),
          CHANGE(materials[0].emission.b = 1),
          CHANGE(materials[0].emission_texture.texture = 0),
          CHANGE(materials[0].alpha_mode = AlphaMode::mask),
          CHANGE(materials[0].alpha_cutoff = 0.7f),
          CHANGE(materials[0].double_sided = true),
          CHANGE(materials[0].unlit = true),
          CHANGE(materials[0].ior = 1.3f),
          CHANGE(materials[0].dispersion = 0.3f),
          CHANGE(materials[0].specular = 0.5f),
          CHANGE(materials[0].specular_texture.texture = 0),
          CHANGE(materials[0].specular_color.r = 0.5f),
          CHANGE(materials[0].specular_color_texture.texture = 0),
          CHANGE(materials[0].transmission = 1),
          CHANGE(materials[0].transmission_texture.texture = 0),
          CHANGE(materials[0].thickness = 1),
          CHANGE(materials[0].attenuation_color.r = 0.5f),
          CHANGE(materials[0].attenuation_distance = 1),
          CHANGE(materials[0].clearcoat = 1),
          CHANGE(materials[0].clearcoat_texture.texture = 0),
          CHANGE(materials[0].clearcoat_roughness = 0.5f),
          CHANGE(materials[0].clearcoat_roughness_texture.texture = 0),
          CHANGE(materials[0].microfacet_model = MicrofacetModel::beckmann)};
}

/// Changes of all other parts.
std::vector<NamedChange> other_changes() {
  return {CHANGE(meshes[0].positions[1].z = 1),
          CHANGE(meshes[0].normals[1].x = 1),
          CHANGE(meshes[0].tangents[1].x = 1),
          CHANGE(meshes[0].uv0[2].x = 1),
          CHANGE(meshes[0].uv1[2].x = 1),
          CHANGE(meshes[0].colors[0].x = 1),
          CHANGE(meshes[0].triangles[0].x = 2),
          CHANGE(meshes[0].material = kNone),
          CHANGE(lights[0].type = PunctualType::spot),
          CHANGE(lights[0].intensity.g = 2),
          CHANGE(lights[0].inner_cone_rad = 0.1f),
          CHANGE(lights[0].outer_cone_rad = 0.2f),
          CHANGE(lights[0].angular_diameter_rad = 0.1f),
          CHANGE(cameras[0].projection = Projection::panoramic),
          CHANGE(cameras[0].fov_y_rad = 1),
          CHANGE(cameras[0].half_height = 2),
          CHANGE(cameras[0].lens_radius = 1),
          CHANGE(cameras[0].focus_distance = 2),
          CHANGE(nodes[0].transform.translation.x = 1),
          CHANGE(nodes[0].transform.rotation.x = 1),
          CHANGE(nodes[0].transform.scale.x = 2),
          CHANGE(nodes[0].matrix = Mat4(1)),
          CHANGE(nodes[0].matrix = Mat4(2)),
          CHANGE(nodes[0].meshes.clear()),
          CHANGE(nodes[0].instances[0][3][0] = 1),
          CHANGE(nodes[0].light = 0),
          CHANGE(nodes[0].camera = 0),
          CHANGE(add_node({})),
          CHANGE(animation[0].property = AnimatedProperty::scale),
          CHANGE(animation[0].interpolation = Interpolation::step),
          CHANGE(animation[0].times[1] = 2),
          CHANGE(animation[0].values[1].y = 3),
          CHANGE(animation.clear()),
          CHANGE(environment.kind = EnvironmentKind::constant),
          CHANGE(environment.color.r = 2),
          CHANGE(environment.map[0].g = 2),
          CHANGE(environment.rotation_rad = 1),
          CHANGE(environment.sun_sky.sun_elevation_rad = 1),
          CHANGE(environment.sun_sky.sun_azimuth_rad = 1),
          CHANGE(environment.sun_sky.turbidity = 4),
          CHANGE(environment.sun_sky.sky_scale = 2),
          CHANGE(environment.sun_sky.sun_scale = 2),
          CHANGE(environment.sun_sky.sun_angular_diameter_rad = 0.1f),
          CHANGE(environment.sun_sky.ground_albedo.r = 1)};
}

#undef CHANGE

TEST(SceneHash, ChangesWithEveryFieldThatMatters) {
  std::set<uint64_t> hashes{scene_hash(full_scene())};
  EXPECT_EQ(scene_hash(full_scene()), *hashes.begin());
  for (const auto& changes : {surface_changes(), other_changes()}) {
    for (const auto& [name, change] : changes) {
      Scene s = full_scene();
      change(s);
      EXPECT_TRUE(hashes.insert(scene_hash(s)).second) << name;
    }
  }
}

TEST(SceneHash, IgnoresNamesOfMeshes) {
  Scene s = full_scene();
  s.meshes[0].name = "other";
  s.materials[0].name = "other";
  EXPECT_EQ(scene_hash(s), scene_hash(full_scene()));
}

}  // namespace
}  // namespace relume
