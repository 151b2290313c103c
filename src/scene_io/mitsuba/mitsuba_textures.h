// Textures of Mitsuba scenes. Images are decoded and combined into glTF's channels at the end, in parallel.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/bytes.h"
#include "scene_io/mitsuba/mitsuba_parameters.h"
#include "scene_io/mitsuba/mitsuba_texels.h"

namespace relume::mitsuba {

/// An image file or a checkerboard, and its placement on a surface. Mitsuba's v = 0 is the top row, as in glTF.
struct TextureSource {
  std::filesystem::path file;     ///< empty: a checkerboard
  bool is_raw = false;            ///< without decoding from sRGB
  std::array<Rgb, 2> checkers{};  ///< colours of the cell at the origin and of the next one
  WrapMode wrap = WrapMode::repeat;
  FilterMode filter = FilterMode::linear;
  TextureRef placement;         ///< without `texture`
  Rgb factor{1};                ///< of the values, which are not negative
  float inner_reflectance = 0;  ///< of a coat, below which the colours are albedos; 0: none

  bool changes_colors() const { return factor != Rgb(1) || inner_reflectance > 0; }
};

/// Whether two sources can share one texture.
bool same_placement(const TextureSource& a, const TextureSource& b);

class Textures {
 public:
  explicit Textures(Import& import) : import_(import) {}

  /// Source of a texture plugin. std::nullopt with a warning if its type is not supported.
  std::optional<TextureSource> source(const Object& texture);

  /// Uses of sources, whose texels finish() fills. RGB of the first and, as alpha, the luminance of the second; either
  /// may be absent.
  TextureRef color(const std::optional<TextureSource>& color, const std::optional<TextureSource>& opacity = {});
  /// G the roughness and B the metalness. `is_alpha`: the first holds the width α, whose square root is the roughness.
  TextureRef surface(const std::optional<TextureSource>& roughness, bool is_alpha,
                     const std::optional<TextureSource>& metallic);
  /// glTF's textures of roughness and of anisotropy for microfacets of these widths along u and v.
  TextureRef narrow_widths(const TextureSource& alpha_u, const TextureSource& alpha_v);
  TextureRef anisotropy(const TextureSource& alpha_u, const TextureSource& alpha_v);
  /// Colours between `ends`, which images multiply, at the luminance of `weight`: 0 gives the first. The images must
  /// have the placement of `weight`.
  TextureRef mixed_color(const TextureSource& weight, const std::array<std::optional<TextureSource>, 2>& images,
                         const std::array<Rgb, 2>& ends);
  /// The same for G the roughness and B the metalness.
  TextureRef mixed_surface(const TextureSource& weight, const std::array<Rgb, 2>& ends);
  /// The luminance in all channels.
  TextureRef scalar(const TextureSource& source);
  TextureRef normals(const TextureSource& source);
  /// Normal map of heights, whose derivatives by u and v are multiplied by `slope`.
  TextureRef bumps(const TextureSource& heights, const Vec2& slope);

  /// Mean colour, which replaces a texture that has no equivalent. Decodes the image.
  Rgb mean(const TextureSource& source);

  /// Decodes all images within a DecodeBudget. A missing or broken one becomes one texel, with a warning.
  void finish();

 private:
  enum class Recipe : uint8_t {
    color,
    surface,
    narrow_widths,
    anisotropy,
    mixed_color,
    mixed_surface,
    scalar,
    normals,
    bumps
  };

  struct ImageFile {
    std::shared_ptr<const Bytes> bytes;
    uint64_t texels = 0;
    std::string problem;
  };

  struct Request {
    Recipe recipe = Recipe::color;
    std::array<std::optional<TextureSource>, 3> sources{};
    bool is_alpha = false;
    Vec2 slope{0};
    std::array<Rgb, 2> ends{};  ///< factors of the second and third source, or their values if absent
  };
  using ImageFiles = std::array<ImageFile, 3>;

  TextureRef request(Request request);
  static ImageFile read(const std::filesystem::path& path);
  /// Files of all requests; equal ones share their bytes.
  std::vector<ImageFiles> read_all() const;
  void limit(std::vector<ImageFiles>& files) const;
  /// Texture of a recipe; constant if an image is missing.
  static Texture made(const Request& request, const std::array<const Texels*, 3>& images);
  void make(const Request& request, const ImageFiles& files, Texture& texture, Warnings& warnings) const;

  Import& import_;
  std::map<std::string, Index> known_;  ///< by a text of the request
  std::map<std::string, Rgb> means_;
  std::vector<Request> requests_;  ///< parallel to Scene::textures
};

}  // namespace relume::mitsuba
