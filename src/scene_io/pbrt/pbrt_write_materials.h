// Writes materials as the nearest of pbrt's.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene_io/pbrt/pbrt_output.h"

namespace relume::pbrt {

/// What a shape of a material needs besides its name.
struct WrittenMaterial {
  std::string name;        ///< in quotes
  std::string area_light;  ///< directive; empty: none
  bool has_emission_map = false;
  std::string alpha;   ///< parameter of the shape; empty: opaque
  std::string medium;  ///< name in quotes; empty: none
};

class MaterialWriter {
 public:
  MaterialWriter(const Scene& scene, Output& output) : scene_(scene), output_(output) {}

  /// Writes textures and named materials; one per material of the scene, and at the end glTF's default
  /// material if a mesh needs it.
  std::vector<WrittenMaterial> write();

 private:
  void write_after_parts(size_t index);
  WrittenMaterial material(const Material& m, size_t index);
  /// Writes the material "NAME.part" or, without a part, "NAME". Returns its name in quotes.
  std::string define(const std::string& part, const std::string& parameters);
  std::string body(const Material& m);
  std::string glass(const Material& m);
  std::string metal(const Material& m);
  std::string plastic(const Material& m);
  std::string dielectric(const Material& m);
  /// Mix of two defined materials; `amount` of the texel of `ref` is the share of the second.
  std::string mixture(const std::string& first, const std::string& second, const TextureRef& ref,
                      const std::function<float(const Vec4&)>& amount);
  std::string transmitting(const Material& m);
  std::string roughness(const Material& m, const std::string& prefix);
  std::string normal_map(const Material& m);
  std::string area_light(const Material& m);
  std::string alpha(const Material& m);
  std::string medium(const Material& m);
  std::string medium_of(const Material& m);
  /// Parameter `name` of type rgb, or of a baked texture: `color` of the texel of `ref`, linear.
  std::string color(const std::string& name, const TextureRef& ref, const std::function<Rgb(const Vec4&)>& color);
  /// Parameter `name` of type float, or of a baked texture.
  std::string value(const std::string& name, const TextureRef& ref, const std::function<float(const Vec4&)>& value);
  /// Writes a texture directive with the mapping of `ref`. Returns its name in quotes.
  std::string texture(const std::string& type, const TextureRef& ref, std::span<const uint8_t> rgb,
                      const char* encoding);
  void note_parts(const Material& m);

  const Scene& scene_;
  Output& output_;
  std::vector<WrittenMaterial> written_;
  std::string name_;        ///< of the material that is written, unique
  std::string normal_map_;  ///< parameter of its parts; empty: none
  int textures_ = 0;
};

}  // namespace relume::pbrt
