// A square with a texture, for tests of surface points.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "scene/compiled_scene.h"
#include "scene/surface_point.h"
#include "scene/testing/plate.h"

namespace relume::testing {

/// A square of 2 m in z = 0 with one texture; each test sets the texture coordinates.
struct TexturedSquare {
  Scene scene = plate();

  explicit TexturedSquare(Texture texture) {
    scene.textures.push_back(std::move(texture));
    scene.materials[0].metallic = 0;
  }

  /// Coordinates that cover the square once, v downwards, multiplied by `scale`.
  static std::vector<Vec2> uv(float scale) { return {Vec2(0, scale), Vec2(scale), Vec2(scale, 0), Vec2(0)}; }
  Mesh& mesh() { return scene.meshes[0]; }
  Material& material() { return scene.materials[0]; }

  /// The surface point at `p`; valid as long as the square, whose scene may change.
  SurfacePoint seen_at(const Vec2& p, float cone_width) const {
    compiled_scenes.push_back(
        std::make_unique<CompiledScene>(scene, CompileOptions{.camera = {}, .width = 16, .height = 16}));
    const CompiledScene& compiled = *compiled_scenes.back();
    const Ray ray{Vec3(p, 1), Vec3(0, 0, -1), kInfinity};
    SurfacePoint sp;
    make_surface_point(compiled.view(), ray, intersect(compiled.view().accel, ray, 0), cone_width, sp);
    return sp;
  }

  mutable std::vector<std::unique_ptr<CompiledScene>> compiled_scenes;  ///< whose tables the points of seen_at() use
};

/// A checkerboard of black and white quarters.
inline Texture checkered(int size) {
  Texture t;
  t.name = "checkered";
  t.width = t.height = size;
  t.format = PixelFormat::rgba8_linear;
  for (int i = 0; i < size * size; ++i) {
    const auto code = static_cast<std::byte>((i % size < size / 2) == (i / size < size / 2) ? 255 : 0);
    for (const std::byte value : {code, code, code, std::byte{255}}) t.texels.push_back(value);
  }
  return t;
}

inline Texture one_texel(const std::array<int, 4>& codes) {
  Texture t;
  t.name = "one texel";
  t.width = t.height = 1;
  t.format = PixelFormat::rgba8_linear;
  for (const int code : codes) t.texels.push_back(static_cast<std::byte>(code));
  return t;
}

}  // namespace relume::testing
