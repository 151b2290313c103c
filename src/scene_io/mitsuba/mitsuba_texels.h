// Texels of Mitsuba's textures, and images made of them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "core/vec.h"
#include "scene/scene.h"

namespace relume::mitsuba {

/// Bump maps of more texels become normal maps of 8 bits per channel instead of 32.
inline constexpr uint64_t kMaxFloatTexels = uint64_t{1} << 22;

/// A decoded image as linear values.
class Texels {
 public:
  explicit Texels(Texture image) : image_(std::move(image)) {}

  int width() const { return image_.width; }
  int height() const { return image_.height; }
  /// Linear value of a texel; coordinates outside the image follow its wrap mode.
  Vec4 at(int x, int y) const;
  /// Value of the texel nearest to the centre of texel (x, y) of an image of another size.
  Vec4 at(int x, int y, int width, int height) const;
  /// Its luminance.
  float luminance_of(int x, int y, int width, int height) const { return luminance(Rgb(at(x, y, width, height))); }
  Rgb mean() const;
  const Texture& image() const { return image_; }

 private:
  Texture image_;
};

/// Luminances of two images in one of the size of the larger: G the first, or its square root, and B the second. 1
/// where an image is absent.
void combine_surface(const Texels* roughness, bool is_alpha, const Texels* metallic, Texture& texture);
/// RGB of the first, white if absent, and the luminance of the second as alpha.
void combine_color(const Texels* color, const Texels* opacity, Texture& texture);
/// For microfacets of the widths `alpha_u` and `alpha_v`: G the roughness of the narrower direction.
void combine_narrow_widths(const Texels& alpha_u, const Texels& alpha_v, Texture& texture);
/// The same: RG the wider direction, B the strength of anisotropy, as in KHR_materials_anisotropy.
void combine_anisotropy(const Texels& alpha_u, const Texels& alpha_v, Texture& texture);
/// Values between two ends at the luminance of `weight`; images multiply the ends where present. Stored as sRGB, or
/// linear for data.
void mix(const Texels& weight, const std::array<const Texels*, 2>& images, const std::array<Rgb, 2>& ends,
         bool is_color, Texture& texture);
/// The luminance in all channels.
void spread_luminance(const Texels& source, Texture& texture);
/// Normal map of a height field: normals (-slope.x ∂h/∂u, -slope.y ∂h/∂v, 1) from central differences.
void make_normals(const Texels& heights, const Vec2& slope, Texture& texture);
/// The same image, whose colours become those that `change` gives for them.
Texels with_colors(const Texels& source, const std::function<Rgb(const Rgb&)>& change);
/// Two cells by two of a checkerboard, the first colour at the origin.
Texture checkerboard(const Rgb& first, const Rgb& second);

}  // namespace relume::mitsuba
