// What a pbrt file describes, in the order of its directives.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene_io/pbrt/pbrt_parameters.h"
#include "scene_io/pbrt/pbrt_transform.h"

namespace relume::pbrt {

struct TextureEntity {
  std::string kind;  ///< "imagemap", …
  bool is_float = false;
  Parameters parameters;
};

struct MaterialEntity {
  std::string name;  ///< empty: not named
  std::string kind;  ///< "diffuse", …
  Parameters parameters;
};

struct MediumEntity {
  std::string kind;
  Parameters parameters;
};

struct AreaLightEntity {
  std::string kind;
  Parameters parameters;
};

/// What gives a shape its look, apart from its geometry.
struct Look {
  std::shared_ptr<const MaterialEntity> material;
  std::string material_name;  ///< of a named material, instead of `material`; empty: none
  std::shared_ptr<const AreaLightEntity> area_light;
  std::string inside_medium;
  std::string alpha_texture;  ///< empty: none
  float alpha = 1;
  Location where;
};

struct ShapeEntity {
  Index mesh = kNone;  ///< index in the scene; its material is set at the end
  float scale = 1;     ///< of the mesh, before `to_world`
  size_t faces = 1;    ///< pbrt's shapes in this mesh; each has the power of an area light
  Look look;
  TransformSet to_world;
  std::array<double, 2> times{0, 1};
};

struct ObjectEntity {
  std::vector<ShapeEntity> shapes;  ///< with their transforms in the meshes
  std::vector<Mat4> instances;
  std::vector<std::pair<TransformSet, std::array<double, 2>>> moving;  ///< with times
};

struct LightEntity {
  std::string kind;
  Parameters parameters;
  TransformSet to_world;
};

struct CameraEntity {
  std::string kind = "perspective";
  Parameters parameters;
  TransformSet from_world;
  std::array<double, 2> times{0, 1};
  std::optional<glm::dvec3> up;  ///< of the last LookAt
};

struct Description {
  CameraEntity camera;
  bool has_camera = false;
  Parameters film;
  Parameters integrator;
  Parameters sampler;
  bool has_sampler = false;
  std::map<std::string, TextureEntity> float_textures;
  std::map<std::string, TextureEntity> color_textures;
  std::map<std::string, std::shared_ptr<const MaterialEntity>> materials;
  std::map<std::string, MediumEntity> media;
  std::vector<ShapeEntity> shapes;
  std::map<std::string, ObjectEntity> objects;
  std::vector<LightEntity> lights;
};

}  // namespace relume::pbrt
