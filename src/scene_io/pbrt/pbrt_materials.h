// Converts pbrt's materials, with the alpha, emission and medium of a shape.
#pragma once

#include <map>
#include <string>

#include "scene_io/pbrt/pbrt_surface.h"

namespace relume::pbrt {

class Materials {
 public:
  Materials(const Description& description, Scene& scene, Colors& colors, ImageFiles& images, Warnings& warnings)
      : description_(description),
        scene_(scene),
        colors_(colors),
        images_(images),
        warnings_(warnings),
        textures_(description, colors, images, warnings),
        baker_(scene, images, warnings) {}

  /// Material of a shape, made once for each look. `area` and `faces`, of the shape, count for area lights that give
  /// their power. Returns kNone if the shape is invisible: the boundary of a medium. Throws Error.
  Index of(const Look& look, float area, size_t faces);

 private:
  Index reserve(const std::string& key);
  Material make(const MaterialEntity& entity, const Look& look, Index index, int depth);
  Index part(const MaterialEntity& entity, const Look& look, int depth);
  void add_parts(const MaterialEntity& entity, const Look& look, const TextureNode& amount, int depth,
                 Material& material);
  SurfaceModel model(const MaterialEntity& entity, int depth);
  SurfaceModel diffuse(const Parameters& parameters);
  SurfaceModel conductor(const Parameters& parameters);
  SurfaceModel coated_diffuse(const Parameters& parameters);
  SurfaceModel coated_conductor(const Parameters& parameters);
  SurfaceModel dielectric(const Parameters& parameters);
  SurfaceModel thin_dielectric(const Parameters& parameters);
  SurfaceModel diffuse_transmission(const Parameters& parameters);
  SurfaceModel subsurface(const Parameters& parameters);
  SurfaceModel mix(const Parameters& parameters, int depth);

  /// Function of the perceptual roughness of `prefix`, and the anisotropy if it is constant.
  std::function<float(const Vec2&)> roughness(const Parameters& parameters, const std::string& prefix,
                                              SurfaceModel& model);
  const TextureNode* color_or(const Parameters& parameters, std::string_view name, float otherwise);
  std::function<Rgb(const Vec2&)> metal_color(const Parameters& parameters, const std::string& prefix, float outside,
                                              SurfaceModel& model);
  void add_alpha(const Look& look, SurfaceModel& model);
  void add_medium(const std::string& name, Material& material);
  void add_emission(const AreaLightEntity& light, float area, size_t faces, Material& material);
  const MaterialEntity& entity_of(const Look& look) const;
  const MaterialEntity& named(const std::string& name, const Location& where) const;

  const Description& description_;
  Scene& scene_;
  Colors& colors_;
  ImageFiles& images_;
  Warnings& warnings_;
  Textures textures_;
  SurfaceBaker baker_;
  std::map<std::string, Index> known_;
};

}  // namespace relume::pbrt
