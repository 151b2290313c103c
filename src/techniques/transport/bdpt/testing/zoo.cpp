#include "techniques/transport/bdpt/testing/zoo.h"

#include <cstring>
#include <string>
#include <utility>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "core/hash.h"

namespace relume::testing {
namespace {

/// Adds a texture of four floats per texel from `value(x, y)`.
template <typename Value>
Index add_zoo_texture(SceneBuilder& b, int size, const Value& value) {
  Texture t;
  t.width = t.height = size;
  t.format = PixelFormat::rgba32_float;
  t.texels.resize(static_cast<size_t>(size * size) * sizeof(Vec4));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const Vec4 texel = value(x, y);
      std::memcpy(t.texels.data() + static_cast<size_t>(y * size + x) * sizeof(Vec4), &texel, sizeof texel);
    }
  }
  return b.add_texture(std::move(t));
}

void add_zoo_surfaces(SceneBuilder& b, bool smooth, bool bent) {
  const auto at = [](const Vec3& p) {
    Transform t;
    t.translation = p;
    return t;
  };
  // Steep bumps and a coarse sphere with interpolated normals put many directions below the shading horizon.
  const Index bumps = add_zoo_texture(b, 4, [](int x, int y) {
    const auto i = static_cast<uint32_t>(4 * y + x);
    return Vec4(to_unit_float(hash(i, 1u)), to_unit_float(hash(i, 2u)), 0.75f, 1);
  });
  // Texels exceed the footprints of cones: both kinds of subpath see the same bumps.
  const auto use_bumps = [&](Material& m) {
    if (!bent) return;
    m.normal_texture.texture = bumps;
    m.normal_texture.scale = Vec2(0.5f);
  };
  const auto sphere = [&](float radius, int levels) {
    const Mesh mesh = icosphere(radius, levels);
    return bent ? mesh : flat_shaded(mesh);
  };
  Material floor = glossy("floor", {0.7f, 0.6f, 0.5f}, 0.4f);
  use_bumps(floor);
  b.add("floor", quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), b.add_material(floor));
  Material wall = matte("wall", {0.4f, 0.6f, 0.7f});
  use_bumps(wall);
  b.add("wall", quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}), b.add_material(wall));
  b.add("ball", sphere(0.45f, 1), b.add_material(matte("ball", {0.8f, 0.5f, 0.4f})), at({-1.1f, 0.5f, 0.3f}));
  b.add("metal", sphere(0.4f, 3), b.add_material(metal("metal", {0.9f, 0.8f, 0.5f}, 0.5f)), at({0, 0.4f, -0.7f}));

  Material rough = glass("rough glass", 1.5f, {0.7f, 0.9f, 0.6f}, 0.5f);
  rough.roughness = 0.5f;
  b.add("rough glass", sphere(0.35f, 3), b.add_material(rough), at({1.1f, 0.36f, 0.4f}));

  Material pane = matte("pane", {0.9f, 0.7f, 0.4f});
  pane.specular = 1;
  pane.transmission = 0.8f;
  pane.roughness = 0.6f;
  b.add("pane", quad({-0.5f, 0.02f, 0.9f}, {0.7f, 0, 0.3f}, {0, 0.8f, 0}), b.add_material(pane));

  Material veil = matte("veil", {0.5f, 0.8f, 0.5f});
  veil.alpha = 0.5f;
  veil.alpha_mode = AlphaMode::blend;
  b.add("veil", quad({0.6f, 0.3f, 0.9f}, {0.8f, 0, 0}, {0, 0.8f, 0}), b.add_material(veil));

  Material coated = matte("coated", {0.6f, 0.2f, 0.3f});
  coated.clearcoat = 0.8f;
  coated.clearcoat_roughness = 0.4f;
  b.add("coated", box({-1.9f, 0.01f, -1.4f}, {-1.3f, 0.9f, -0.8f}), b.add_material(coated));
  if (!smooth) return;
  b.add("glass", icosphere(0.3f, 3), b.add_material(glass("glass", 1.5f, {0.9f, 0.5f, 0.4f}, 0.4f)),
        at({-0.3f, 0.31f, 0.5f}));
  // A half mirror, half diffuse; and a smooth coat over smooth glass with diffuse scattering.
  b.add("varnish", box({1.3f, 0.01f, -1.5f}, {1.9f, 1.0f, -0.9f}), b.add_material(glossy("varnish", Rgb(0.6f), 0)));
  Material mixed = glass("milky", 1.4f);
  mixed.transmission = 0.6f;
  mixed.base_color = {0.8f, 0.8f, 0.9f};
  mixed.clearcoat = 0.5f;
  b.add("milky", icosphere(0.25f, 3), b.add_material(mixed), at({0.45f, 0.26f, 0.2f}));
}

void add_zoo_punctual(Scene& scene, PunctualLight light, const Vec3& from) {
  scene.lights.push_back(std::move(light));
  Node node;
  node.transform = look_at(from, Vec3(0.1f, 0, 0));
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  scene.add_node(std::move(node));
}

Environment zoo_environment(ZooLight light) {
  Environment e;
  if (light == ZooLight::environment_map || light == ZooLight::mixed) {
    e.kind = EnvironmentKind::map;
    e.width = 16;
    e.height = 8;
    e.rotation_rad = 0.7f;
    for (uint32_t i = 0; i < 128; ++i)
      e.map.push_back(Rgb(0.1f, 0.15f, 0.2f) + (i == 2 * 16 + 9 ? Rgb(12, 10, 8) : Rgb(0.1f * to_unit_float(hash(i)))));
  } else if (light == ZooLight::sun_sky) {
    e.kind = EnvironmentKind::sun_sky;
  } else if (light == ZooLight::constant) {
    e.kind = EnvironmentKind::constant;
    e.color = {0.5f, 0.7f, 1};
  }
  return e;
}

void add_zoo_lamp(SceneBuilder& b, ZooLight light) {
  Material lamp = emitter("lamp", {9, 8, 6});
  Vec3 corner(-0.6f, 2.4f, -0.2f);
  if (light == ZooLight::two_sided) {
    lamp.double_sided = true;
    lamp.base_color = Rgb(0.5f);
    corner.y = 1.7f;
  }
  if (light == ZooLight::textured) {
    lamp.emission_texture.texture = add_zoo_texture(b, 8, [](int x, int y) {
      return Vec4(to_unit_float(hash(static_cast<uint32_t>(x), static_cast<uint32_t>(y))) * 3.0f,
                  0.2f * static_cast<float>(x), 1, 1);
    });
  }
  b.add("lamp", quad(corner, {0.5f, 0.2f, 0}, {0, 0, 0.6f}), b.add_material(lamp));
}

Camera zoo_camera(ZooCamera kind) {
  Camera camera;
  camera.fov_y_rad = 0.8f;
  switch (kind) {
    case ZooCamera::pinhole: break;
    case ZooCamera::thin_lens:
      camera.lens_radius = 0.35f;  // large enough to be hit by light subpaths
      camera.focus_distance = 3.2f;
      break;
    case ZooCamera::orthographic:
      camera.projection = Projection::orthographic;
      camera.half_height = 1.3f;
      break;
    case ZooCamera::panoramic: camera.projection = Projection::panoramic; break;
  }
  return camera;
}

}  // namespace

Scene make_zoo(ZooLight light, ZooCamera camera, bool smooth, bool bent) {
  SceneBuilder b("zoo");
  add_zoo_surfaces(b, smooth, bent);
  if (light == ZooLight::triangles || light == ZooLight::two_sided || light == ZooLight::textured ||
      light == ZooLight::mixed)
    add_zoo_lamp(b, light);
  Scene scene = b.take();
  const Vec3 above(-0.4f, 2.3f, 1.0f);
  if (light == ZooLight::point || light == ZooLight::mixed)
    add_zoo_punctual(scene, {"", PunctualType::point, Rgb(6, 5, 4)}, above);
  if (light == ZooLight::spot) add_zoo_punctual(scene, {"", PunctualType::spot, Rgb(12, 10, 8), 0.4f, 0.7f}, above);
  PunctualLight sun{"", PunctualType::directional, Rgb(3, 2.5f, 2)};
  if (light == ZooLight::sun_disk) sun.angular_diameter_rad = 0.2f;
  if (light == ZooLight::directional || light == ZooLight::sun_disk || light == ZooLight::mixed)
    add_zoo_punctual(scene, sun, {1, 3, 2});
  scene.environment = zoo_environment(light);
  scene.cameras.push_back(zoo_camera(camera));
  Node eye;
  eye.camera = 0;
  eye.transform = look_at({0.2f, 1.2f, 3.4f}, {0, 0.6f, 0});
  scene.add_node(std::move(eye));
  return scene;
}

Scene dispersive(Scene scene, float dispersion) {
  for (Material& m : scene.materials) {
    if (m.thickness > 0.0f) m.dispersion = dispersion;
  }
  return scene;
}

Scene make_closed_sphere(float albedo) {
  SceneBuilder b("closed sphere");
  Material wall = matte("wall", Rgb(albedo));
  wall.emission = Rgb(1);
  b.add("wall", flat_shaded(flipped(icosphere(1, 3))), b.add_material(wall));
  Scene scene = b.take();
  scene.cameras.push_back(zoo_camera(ZooCamera::panoramic));
  Node eye;
  eye.camera = 0;
  eye.transform = look_at({0.2f, 0.1f, 0.3f}, {0, 0, -1});
  scene.add_node(std::move(eye));
  return scene;
}

namespace {

Scene make_block_of_glass(Mesh lamp, bool from_within) {
  SceneBuilder b("lamp in glass");
  const Index dark = b.add_material(glass("dark", 1.3f, {0.3f, 0.4f, 0.5f}, 1.0f));
  const Index white = b.add_material(matte("white", Rgb(0.8f)));
  b.add("block", box({-2, -2, -2}, {2, 2, 2}), dark);
  b.add("floor", quad({-1.8f, -1.5f, 1.8f}, {3.6f, 0, 0}, {0, 0, -3.6f}), white);
  b.add("back", quad({-1.8f, -1.5f, -1.8f}, {3.6f, 0, 0}, {0, 3.3f, 0}), white);
  b.add("lamp", std::move(lamp), b.add_material(emitter("lamp", Rgb(20))));
  b.add_camera({0, 0, from_within ? 1.7f : 7.0f}, {0, -0.4f, 0}, from_within ? 60.0f : 30.0f);
  return b.take();
}

}  // namespace

Scene make_lamp_in_glass(bool from_within) {
  return make_block_of_glass(quad({-0.4f, 1.5f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}), from_within);
}

Scene make_lamp_half_in_glass() {
  return make_block_of_glass(quad({-0.4f, 1.2f, -1.5f}, {0.8f, 0, 0}, {0, 1.6f, 0}), true);
}

}  // namespace relume::testing
