// Appearance of a point of a surface, in relume's terms.
#pragma once

#include <functional>
#include <vector>

#include "scene/scene.h"
#include "scene_io/pbrt/pbrt_textures.h"

namespace relume::pbrt {

/// The members of Material that textures can vary.
struct Surface {
  Rgb base_color{1};
  float alpha = 1;
  float metallic = 0;
  float roughness = 0;
  float specular = 1;
  Rgb specular_color{1};
  float transmission = 0;
  float clearcoat = 0;
  float clearcoat_roughness = 0;
  float diffuse_transmission = 0;
  Rgb diffuse_transmission_color{1};
};

/// A material as a function of texture coordinates.
struct SurfaceModel {
  Material uniform;  ///< name, and the members that textures do not vary
  std::function<Surface(const Vec2& uv)> at;
  std::vector<const TextureNode*> nodes;     ///< on which `at` depends
  const TextureNode* plain_color = nullptr;  ///< node whose value is the base colour, if nothing else varies
  std::string normal_map;                    ///< image file; empty: none
  Location where;                            ///< of `normal_map`
  const TextureNode* amount = nullptr;       ///< share of the second part of a mixture whose means are not exact
};

/// Perceptual roughness of pbrt's roughness, which is squared first unless `remap`.
float perceptual_roughness(float pbrt_roughness, bool remap);

/// Reflectance inside a medium of index `ior` of the conductor that pbrt takes for `reflectance`: η = 1 and
/// κ² = 4 R / (1 - R).
Rgb reflectance_in_coat(const Rgb& reflectance, float ior);
/// The inverse; 0 where no such conductor reflects so little.
Rgb reflectance_without_coat(const Rgb& color, float ior);

/// Index whose reflectance at normal incidence is that of both sides of a thin wall of index `ior`: 2 R / (1 + R).
float thin_wall_index(float ior);
/// The inverse.
float index_of_thin_wall(float wall_ior);

/// Sets the anisotropy for the widths along u and v. Returns the perceptual roughness of the base width.
float set_anisotropy(float alpha_u, float alpha_v, Material& material);

/// Means of the members of pbrt's mix of two surfaces, a share `amount` of which is `b`.
Surface mixed(const Surface& a, const Surface& b, float amount);

/// Whether base colour and roughness of two surfaces are equal in the mean up to the rounding of textures, as those of
/// the parts of glTF's metals are.
bool have_equal_colors(const SurfaceModel& a, const SurfaceModel& b);

/// pbrt's mix of a metal and an opaque base that reflects `base_f0` at normal incidence: a base below a layer of index
/// kMixedIndex that reflects what both reflect. Where `share` of the metal is 1, the metal itself.
Surface covered(const Surface& base, float base_f0, const Surface& metal, float share);
inline constexpr float kMixedIndex = 1000;

/// Makes materials of models: constants, or textures that it bakes.
class SurfaceBaker {
 public:
  SurfaceBaker(Scene& scene, ImageFiles& images, Warnings& warnings)
      : scene_(scene), images_(images), warnings_(warnings) {}

  Material bake(const SurfaceModel& model);

 private:
  struct Domain;

  Domain domain_of(const SurfaceModel& model);
  void add_textures(const SurfaceModel& model, const Domain& domain, Material& material);
  TextureRef add(Texture texture, const SurfaceModel& model, const Domain& domain, bool is_color);
  bool keeps_image(const SurfaceModel& model) const;
  void add_normal_map(const SurfaceModel& model, Material& material);

  Scene& scene_;
  ImageFiles& images_;
  Warnings& warnings_;
  uint64_t texels_ = 0;   ///< of all baked textures
  uint64_t allowed_ = 0;  ///< texels of baked textures, because of the sizes of images
  std::map<std::string, Index> normal_maps_;
};

}  // namespace relume::pbrt
