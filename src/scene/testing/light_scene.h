// A scene with every kind of light, for contract tests.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/hash.h"
#include "scene/compiled_scene.h"
#include "scene/scene.h"

namespace relume::testing {

inline Texture float_texture(int width, int height, const std::vector<Vec4>& texels) {
  Texture t;
  t.width = width;
  t.height = height;
  t.format = PixelFormat::rgba32_float;
  t.texels.resize(texels.size() * sizeof(Vec4));
  std::memcpy(t.texels.data(), texels.data(), t.texels.size());
  return t;
}

/// Noise with a few bright texels; alpha is 0 or 1 in blocks.
inline Texture noise_texture(int size) {
  std::vector<Vec4> texels;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto i = static_cast<uint32_t>(y * size + x);
      const float bright = i % 17 == 0 ? 6.0f : 1.0f;
      const float alpha = (8 * x / size + 8 * y / size) % 2 == 0 ? 1.0f : 0.0f;
      texels.emplace_back(bright * to_unit_float(hash(i, 0u)), bright * to_unit_float(hash(i, 1u)),
                          to_unit_float(hash(i, 2u)), alpha);
    }
  }
  return float_texture(size, size, texels);
}

/// Triangle in the plane y = height that emits downwards (−Y), around (x, height, 0).
inline Mesh emissive_triangle(float x, Index material) {
  Mesh m;
  m.positions = {Vec3(x - 0.4f, 2.0f, -0.5f), Vec3(x + 0.5f, 2.1f, -0.3f), Vec3(x, 1.9f, 0.6f)};
  m.uv0 = {Vec2(0.05f, 0.1f), Vec2(0.95f, 0.2f), Vec2(0.3f, 0.9f)};
  m.triangles = {UVec3(0, 1, 2)};
  m.material = material;
  return m;
}

/// A sheared parallelogram of two triangles that emits downwards.
inline Mesh emissive_parallelogram(float x, Index material) {
  const Vec3 corner(x - 0.4f, 2.0f, -0.5f);
  const Vec3 e1(0.75f, 0.125f, 0.25f);
  const Vec3 e2(-0.125f, 0.0f, 0.5f);
  Mesh m;
  m.positions = {corner, corner + e1, corner + e1 + e2, corner + e2};
  m.triangles = {UVec3(0, 1, 2), UVec3(0, 2, 3)};
  m.material = material;
  return m;
}

/// An environment map with a bright spot, linear in between.
inline Environment noise_environment(int width, int height) {
  Environment e;
  e.kind = EnvironmentKind::map;
  e.color = Rgb(0.8f, 1.0f, 1.2f);
  e.rotation_rad = 0.7f;
  e.width = width;
  e.height = height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<uint32_t>(y * width + x);
      const float spot = 20.0f * std::exp(-0.15f * (sqr(static_cast<float>(x) - 0.3f * static_cast<float>(width)) +
                                                    sqr(static_cast<float>(y) - 0.3f * static_cast<float>(height))));
      e.map.push_back(Rgb(0.2f + to_unit_float(hash(i, 5u)), 0.4f, to_unit_float(hash(i, 6u))) + spot);
    }
  }
  return e;
}

struct NamedLight {
  std::string name;
  LightId id;
};

/// Owns the compiled scene; `named` lists its lights.
struct LightScene {
  std::unique_ptr<CompiledScene> compiled;
  std::vector<NamedLight> named;

  const LightsView& lights() const { return compiled->view().lights; }
};

inline Index add_light_node(Scene& scene, const PunctualLight& light, const Vec3& from, const Vec3& target) {
  scene.lights.push_back(light);
  Node node;
  node.transform = look_at(from, target);
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  return scene.add_node(node);
}

/// Emissive triangles: plain, two-sided, textured, masked. A parallelogram of two. Then point, spot, delta and wide
/// directional lights, and `environment`.
inline LightScene make_light_scene(const Environment& environment, int texture_size = 16) {
  Scene scene;
  scene.name = "lights";
  scene.textures.push_back(noise_texture(texture_size));
  for (int i = 0; i < 4; ++i) {
    Material m;
    m.emission = Rgb(3, 2, 1);
    m.double_sided = i == 1;
    if (i == 2) m.emission_texture.texture = 0;
    if (i == 3) {
      m.base_color_texture.texture = 0;
      m.alpha_mode = AlphaMode::mask;
    }
    scene.materials.push_back(m);
    scene.meshes.push_back(emissive_triangle(static_cast<float>(i) * 1.2f - 1.8f, i));
    Node node;
    node.meshes = {i};
    scene.add_node(node);
  }
  scene.meshes.push_back(emissive_parallelogram(2.9f, 0));
  Node quadrilateral;
  quadrilateral.meshes = {4};
  scene.add_node(quadrilateral);
  PunctualLight point{"point", PunctualType::point, Rgb(5, 4, 3)};
  PunctualLight spot{"spot", PunctualType::spot, Rgb(5, 4, 3), 0.3f, 0.6f};
  PunctualLight delta{"delta", PunctualType::directional, Rgb(2, 3, 4)};
  PunctualLight disk{"disk", PunctualType::directional, Rgb(2, 3, 4)};
  disk.angular_diameter_rad = 0.00925f;
  add_light_node(scene, point, Vec3(0.3f, 1.0f, 0.8f), Vec3(0));
  add_light_node(scene, spot, Vec3(-0.6f, 1.5f, 0.4f), Vec3(0.2f, 0.0f, 0.1f));
  add_light_node(scene, delta, Vec3(1, 2, 3), Vec3(0));
  add_light_node(scene, disk, Vec3(-2, 3, 1), Vec3(0));
  scene.environment = environment;
  LightScene result;
  result.compiled =
      std::make_unique<CompiledScene>(std::move(scene), CompileOptions{.camera = {}, .width = 16, .height = 16});
  const char* names[] = {
      "triangle", "two-sided triangle", "textured triangle", "masked triangle", "parallelogram", "point",
      "spot",     "directional",        "sun disk"};
  for (LightId i = 0; i < result.lights().lights.size; ++i) {
    const bool is_environment = result.lights().lights[i].kind == LightKind::environment;
    result.named.push_back({is_environment ? "environment" : (i < 9 ? names[i] : "the sky's sun"), i});
  }
  return result;
}

/// A point light above the origin and, far below, a textured quad that faces away. Its power overflows a float.
inline Scene make_overpowered_scene() {
  Scene scene;
  scene.name = "overpowered";
  scene.textures.push_back(float_texture(2, 2, std::vector<Vec4>(4, Vec4(1e23f))));
  Material glow;
  glow.emission = Rgb(1e14f);
  glow.emission_texture.texture = 0;
  scene.materials.push_back(glow);
  Mesh quad;
  quad.positions = {Vec3(-9, -50, -9), Vec3(9, -50, -9), Vec3(9, -50, 9), Vec3(-9, -50, 9)};
  quad.uv0 = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  quad.triangles = {UVec3(0, 1, 2), UVec3(0, 2, 3)};  // downwards
  quad.material = 0;
  scene.meshes.push_back(quad);
  Node node;
  node.meshes = {0};
  scene.add_node(node);
  add_light_node(scene, {"point", PunctualType::point, Rgb(5, 4, 3)}, Vec3(0.3f, 1, 0.2f), Vec3(0));
  return scene;
}

inline Environment constant_environment() {
  Environment e;
  e.kind = EnvironmentKind::constant;
  e.color = Rgb(0.5f, 1, 2);
  return e;
}

}  // namespace relume::testing
