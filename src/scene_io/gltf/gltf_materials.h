// Imports glTF materials with the KHR extensions that Material supports.
#pragma once

#include <map>

#include "scene/material_parameters.h"
#include "scene_io/gltf/gltf_textures.h"

namespace relume::gltf {

class MaterialImporter {
 public:
  MaterialImporter(Document& document, Scene& scene) : document_(document), scene_(scene), textures_(document, scene) {}

  /// Index in Scene::materials of glTF material `material`, imported at its first use; kNone for -1 and, with a
  /// warning, for a missing material.
  Index import(int material);

  /// Index of an imported material; kNone for others.
  Index find(int material) const;

  /// Decodes the textures of all imported materials.
  void finish() { textures_.decode_all(); }

 private:
  Material convert(const tinygltf::Material& source);
  void convert_core(const tinygltf::Material& source, Material& material);
  void convert_extensions(const tinygltf::Material& source, Material& material);
  void convert_emission_strength(const tinygltf::Material& source, Material& material);
  /// Reads one extension parameter of the material; `value` holds the default.
  void read(const tinygltf::Value& extension, const MaterialParameter& p, const Material& material, float& value);
  void read(const tinygltf::Value& extension, const MaterialParameter& p, const Material& material, Rgb& value);
  void read(const tinygltf::Value& extension, const MaterialParameter& p, const Material& material, TextureRef& value);
  void read_mixture(const tinygltf::Value& extras, Material& material);
  void read_texture_scales(const tinygltf::Material& source, Material& material);
  TextureRef reference(int texture, int uv_set, const tinygltf::Value* transform, TextureUse use);
  template <typename Info>
  TextureRef reference(const Info& info, TextureUse use);
  TextureRef reference(const tinygltf::Value& extension, const char* key, TextureUse use);
  float limited(double value, double low, double high, const char* what, const std::string& material);
  Vec3 limited(const Vec3& value, float high, const char* what, const std::string& material);

  Document& document_;
  Scene& scene_;
  TextureImporter textures_;
  std::map<int, Index> known_;
  int mix_depth_ = 0;  ///< of the mixtures that are being imported
};

}  // namespace relume::gltf
