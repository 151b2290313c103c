// pbrt's textures as expressions over texture coordinates.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "scene_io/pbrt/pbrt_colors.h"
#include "scene_io/pbrt/pbrt_description.h"
#include "scene_io/pbrt/pbrt_image.h"

namespace relume::pbrt {

/// (s, t) = scale ⊙ (u, v) + offset, with v upwards as in pbrt.
struct UvMapping {
  Vec2 scale{1};
  Vec2 offset{0};

  friend bool operator==(const UvMapping&, const UvMapping&) = default;
};

/// A texture, or a constant value.
struct TextureNode {
  enum class Kind { constant, image, checkerboard, product, mix };

  Kind kind = Kind::constant;
  bool is_float = false;
  Rgb value{0};  ///< constant
  std::shared_ptr<const ImageFile> image;
  Encoding encoding;
  float scale = 1;
  bool invert = false;
  bool nearest = false;
  WrapMode wrap = WrapMode::repeat;
  UvMapping mapping;
  std::array<const TextureNode*, 3> inputs{};  ///< product: two factors; others: two textures, and mix: the amount
  int cost = 1;                                ///< number of nodes that an evaluation visits

  bool is_constant() const { return kind == Kind::constant; }
};

/// Value at (u, v), with v upwards. Float textures have three equal components.
Rgb value_at(const TextureNode& node, const Vec2& uv);

/// Makes nodes of parameters and of the textures that they name.
class Textures {
 public:
  Textures(const Description& description, Colors& colors, ImageFiles& images, Warnings& warnings)
      : description_(description), colors_(colors), images_(images), warnings_(warnings) {}

  /// Node of a spectrum parameter, a reflectance; nullptr without the parameter. Throws Error for missing textures.
  const TextureNode* color(const Parameters& parameters, std::string_view name);
  /// Node of a float parameter; nullptr without it.
  const TextureNode* number(const Parameters& parameters, std::string_view name);
  const TextureNode* constant(const Rgb& value);
  /// Node of a float texture. Throws Error if there is none of that name.
  const TextureNode* float_texture(const std::string& name, const Location& where);

 private:
  const TextureNode* named(const std::string& name, bool is_float, const Location& where);
  TextureNode make(const TextureEntity& entity);
  void make_image(const Parameters& parameters, TextureNode& node);
  /// `name` of a texture entity's own inputs.
  const TextureNode* input(const TextureEntity& entity, std::string_view name, float otherwise);
  UvMapping mapping(const Parameters& parameters);
  TextureNode checkerboard(const TextureEntity& entity);

  const Description& description_;
  Colors& colors_;
  ImageFiles& images_;
  Warnings& warnings_;
  std::deque<TextureNode> nodes_;
  std::map<std::pair<std::string, bool>, const TextureNode*> known_;  ///< nullptr while a node is made
  int depth_ = 0;                                                     ///< textures that are being made
};

}  // namespace relume::pbrt
