// BSDFs of Mitsuba scenes as glTF materials with layers.
#pragma once

#include <map>

#include "scene_io/mitsuba/mitsuba_textures.h"

namespace relume::mitsuba {

/// A blend whose weight is a texture: two ends and the weight of the second one.
struct TexturedBlend {
  TextureSource weight;
  std::array<std::optional<TextureSource>, 2> images;  ///< of the colours
  std::array<Rgb, 2> colors{};
  std::array<Rgb, 2> surfaces{};  ///< G roughness, B metalness
};

struct Surface;

/// Two surfaces; each hit shows one of them.
struct Mixture {
  std::array<const Surface*, 2> parts{};
  float share = 0.5f;                   ///< of the second
  std::optional<TextureSource> weight;  ///< multiplies the share
  int depth = 1;                        ///< of mixtures in mixtures
};

/// A BSDF: a material, and textures that multiply its factors.
struct Surface {
  Material material;  ///< without textures
  std::optional<TextureSource> color;
  std::optional<TextureSource> opacity;
  std::optional<TextureSource> roughness;
  std::optional<TextureSource> roughness_v;  ///< width along v, if `roughness` is that along u
  std::optional<TextureSource> metallic;
  std::optional<TextureSource> transmission;
  std::optional<TextureSource> normals;
  std::optional<TextureSource> bumps;  ///< heights
  std::optional<TexturedBlend> blend;  ///< replaces colour, roughness and metalness
  std::optional<Mixture> mixture;      ///< what the material and its textures approximate
  bool roughness_is_alpha = false;     ///< whether `roughness` holds the width α of microfacets
  float bump_scale = 1;
  bool has_bumps = false;  ///< of its own, or of a part of its mixture
  bool is_null = false;    ///< lets all light pass
  bool is_two_sided = false;
  bool has_black_back = false;  ///< in Mitsuba; relume's materials reflect on both sides
  bool uses_vertex_colors = false;
  bool is_inverted = false;  ///< the denser medium is on the side of the normal

  bool needs_tangents() const { return normals || bumps || mixture || material.anisotropy > 0; }
};

class Surfaces {
 public:
  Surfaces(Import& import, Textures& textures) : import_(import), textures_(textures) {}

  /// Surface of a BSDF plugin; grey and diffuse, with a warning, if its type is not supported.
  const Surface& of(const Object& bsdf);

 private:
  Surface convert(const Parameters& p);
  Surface diffuse(const Parameters& p);
  Surface conductor(const Parameters& p);
  Surface dielectric(const Parameters& p);
  Surface plastic(const Parameters& p);
  Surface principled(const Parameters& p);
  Surface nested(const Parameters& p);
  Surface mask(const Parameters& p);
  Surface bumped(const Parameters& p);
  Surface blend(const Parameters& p);
  void blend_textures(const TextureSource& weight, const Surface& a, const Surface& b, Surface& mixed);

  Rgb conductor_reflectance(const Parameters& p);
  void read_color(const Parameters& p, const std::string& name, const Rgb& fallback, Surface& surface);
  bool is_texture(const Parameters& p, const std::string& name);
  float read_scalar(const Parameters& p, const std::string& name, float fallback,
                    std::optional<TextureSource>* texture);
  void read_alpha(const Parameters& p, Surface& surface);
  void read_specular(const Parameters& p, Surface& surface);
  void read_principled_layers(const Parameters& p, Surface& surface);

  Import& import_;
  Textures& textures_;
  std::map<const Object*, Surface> known_;
};

/// Surface between `a` (weight 0) and `b` (weight 1), whose factors are interpolated.
Surface mixture(const Surface& a, const Surface& b, float weight);

/// Sets roughness and anisotropy of microfacets with these widths along u and v.
void set_widths(float alpha_u, float alpha_v, Material& material);

}  // namespace relume::mitsuba
