#include "scene_io/gltf/gltf_image_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "core/parallel.h"
#include "image/image_size.h"
#include "scene_io/gltf/gltf_textures.h"
#include "scene_io/gltf/gltf_value.h"
#include "scene_io/texture_decode.h"

namespace relume::gltf {
namespace {

constexpr const char* kExtension = "EXT_lights_image_based";
constexpr int kLargestFace = 2048;

/// A cube face: linear radiance, row 0 at the top.
struct Face {
  int size = 0;
  std::vector<Rgb> texels;

  const Rgb& at(int x, int y) const {
    const int column = std::clamp(x, 0, size - 1);
    return texels[static_cast<size_t>(std::clamp(y, 0, size - 1) * size + column)];
  }
  /// Bilinear lookup at `uv` in [0, 1]².
  Rgb look_up(const Vec2& uv) const {
    const Vec2 p = uv * static_cast<float>(size) - Vec2(0.5f);
    const Vec2 corner = glm::floor(p);
    const Vec2 f = p - corner;
    const int x = static_cast<int>(corner.x);
    const int y = static_cast<int>(corner.y);
    return glm::mix(glm::mix(at(x, y), at(x + 1, y), f.x), glm::mix(at(x, y + 1), at(x + 1, y + 1), f.x), f.y);
  }
};

/// Faces in the extension's order: +X, −X, +Y, −Y, +Z, −Z.
using Cube = std::array<Face, 6>;

bool is_png(const Bytes& file) { return file.size() > 4 && std::memcmp(file.data(), "\x89PNG", 4) == 0; }

/// Reads a face. PNG files store RGBD: radiance is RGB / A. Other files store radiance directly.
Face read_face(const Document& document, int image) {
  const Bytes file = read_image_file(document, image);
  const std::string name = image_name(document, image);
  const detail::ImageSize size = detail::read_image_size(file, name);
  if (size.width != size.height || size.width > kLargestFace)
    throw Error(fmt::format("{}: {}x{} pixels are not a square of at most {}; scale it down", name, size.width,
                            size.height, kLargestFace));
  const Texture texture = decode_texture(file, name, PixelFormat::rgba32_float);
  Face face{texture.width, std::vector<Rgb>(texture.texels.size() / sizeof(Vec4))};
  const bool is_rgbd = is_png(file);
  for (size_t i = 0; i < face.texels.size(); ++i) {
    Vec4 texel;
    std::memcpy(&texel, texture.texels.data() + i * sizeof texel, sizeof texel);
    const Rgb radiance = Rgb(texel) / (is_rgbd ? std::max(texel.w, 1.0f / 255) : 1.0f);
    for (int c = 0; c < 3; ++c) face.texels[i][c] = radiance[c] > 0 ? std::min(radiance[c], kMaxRadiance) : 0.0f;
  }
  return face;
}

Cube read_cube(const Document& document, const tinygltf::Value& light) {
  if (!light.Has("specularImages") || !light.Get("specularImages").IsArray() ||
      light.Get("specularImages").ArrayLen() == 0)
    throw Error("it has no specular images");
  const tinygltf::Value& level = light.Get("specularImages").Get(0);
  if (!level.IsArray() || level.ArrayLen() != 6) throw Error("its first level does not have six images");
  Cube cube;
  std::array<std::string, 6> problems;
  parallel_for(cube.size(), [&](size_t i) {
    try {
      const tinygltf::Value& image = level.Get(i);
      if (!image.IsInt()) throw Error("an entry of its specularImages is not the index of an image");
      cube[i] = read_face(document, image.GetNumberAsInt());
    } catch (const std::exception& error) {
      problems[i] = error.what();
    }
  });
  for (const std::string& problem : problems) {
    if (!problem.empty()) throw Error(problem);
  }
  for (const Face& face : cube) {
    if (face.size != cube[0].size) throw Error("its six images differ in size");
  }
  return cube;
}

/// Radiance in direction `w`. Faces are viewed from inside: the extension mirrors OpenGL's faces, whose S points left
/// there.
Rgb look_up(const Cube& cube, const Vec3& w) {
  const Vec3 size = glm::abs(w);
  if (size.x >= size.y && size.x >= size.z) {
    const Vec2 across = Vec2(w.x > 0 ? w.z : -w.z, -w.y) / size.x;
    return cube[w.x > 0 ? 0 : 1].look_up(across * 0.5f + Vec2(0.5f));
  }
  if (size.y >= size.z) {
    const Vec2 across = Vec2(-w.x, w.y > 0 ? w.z : -w.z) / size.y;
    return cube[w.y > 0 ? 2 : 3].look_up(across * 0.5f + Vec2(0.5f));
  }
  const Vec2 across = Vec2(w.z > 0 ? -w.x : w.x, -w.y) / size.z;
  return cube[w.z > 0 ? 4 : 5].look_up(across * 0.5f + Vec2(0.5f));
}

glm::quat rotation_of(const tinygltf::Value& light) {
  if (!light.Has("rotation") || !light.Get("rotation").IsArray() || light.Get("rotation").ArrayLen() != 4)
    return {1, 0, 0, 0};
  const tinygltf::Value& xyzw = light.Get("rotation");
  float q[4];
  for (size_t i = 0; i < 4; ++i) q[i] = xyzw.Get(i).IsNumber() ? to_float(xyzw.Get(i).GetNumberAsDouble()) : 0.0f;
  const glm::quat rotation(q[3], q[0], q[1], q[2]);
  const float length = glm::length(rotation);
  return length > 0 && is_finite(length) ? rotation / length : glm::quat(1, 0, 0, 0);
}

/// Resamples the cube to Environment::map with about as many texels.
void make_map(const Cube& cube, const glm::quat& rotation, Environment& environment) {
  environment.kind = EnvironmentKind::map;
  environment.height = 2 * cube[0].size;
  environment.width = 2 * environment.height;
  environment.map.resize(static_cast<size_t>(environment.width) * static_cast<size_t>(environment.height));
  const glm::quat to_cube = glm::conjugate(rotation);
  parallel_for(static_cast<size_t>(environment.height), [&](size_t y) {
    const float theta = (static_cast<float>(y) + 0.5f) / static_cast<float>(environment.height) * kPi;
    for (int x = 0; x < environment.width; ++x) {
      const float phi = ((static_cast<float>(x) + 0.5f) / static_cast<float>(environment.width) - 0.5f) * 2 * kPi;
      const Vec3 w(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
      environment.map[y * static_cast<size_t>(environment.width) + static_cast<size_t>(x)] = look_up(cube, to_cube * w);
    }
  });
}

/// Index of the loaded scene's image-based light; −1: none.
int light_of_scene(const tinygltf::Model& model) {
  if (model.scenes.empty()) return -1;
  const bool exists = model.defaultScene >= 0 && static_cast<size_t>(model.defaultScene) < model.scenes.size();
  const auto& extensions = model.scenes[exists ? static_cast<size_t>(model.defaultScene) : 0].extensions;
  const auto extension = extensions.find(kExtension);
  return extension == extensions.end() ? -1 : integer_member(extension->second, "light", -1);
}

}  // namespace

void import_image_light(Document& document, Scene& scene) {
  const int index = light_of_scene(document.model);
  if (index < 0) return;
  try {
    const auto extension = document.model.extensions.find(kExtension);
    if (extension == document.model.extensions.end() || !extension->second.Has("lights") ||
        !extension->second.Get("lights").IsArray() ||
        static_cast<size_t>(index) >= extension->second.Get("lights").ArrayLen())
      throw Error("it does not exist");
    const tinygltf::Value& light = extension->second.Get("lights").Get(static_cast<size_t>(index));
    if (!light.IsObject()) throw Error("it is not an object");
    make_map(read_cube(document, light), rotation_of(light), scene.environment);
    scene.environment.color = Rgb(std::clamp(to_float(number_member(light, "intensity", 1)), 0.0f, kMaxRadiance));
  } catch (const std::exception& error) {
    document.warnings.add(fmt::format("image-based light {}: {}; the light is ignored", index, error.what()));
  }
}

}  // namespace relume::gltf
