#include "scene_io/pbrt/pbrt_textures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "core/vec.h"
#include "files/extension.h"

namespace relume::pbrt {
namespace {

constexpr int kMaxCost = 64;  // nodes of one texture, with repetitions

/// Index of a texel outside of an image of `size`.
int wrapped(int64_t i, int size, WrapMode mode) {
  if (mode == WrapMode::clamp) return static_cast<int>(std::clamp<int64_t>(i, 0, size - 1));
  const int64_t rest = i % size;
  return static_cast<int>(rest < 0 ? rest + size : rest);
}

Rgb texel(const TextureNode& node, int64_t x, int64_t y) {
  const ImageFile& image = *node.image;
  const Vec4 value =
      image.at(wrapped(x, image.texels.width, node.wrap), wrapped(y, image.texels.height, node.wrap), node.encoding);
  if (!node.is_float) return Rgb(value);
  return Rgb(image.has_alpha ? value.w : (value.x + value.y + value.z) / 3);
}

Rgb image_value(const TextureNode& node, const Vec2& st) {
  constexpr float kFarthest = 1e9f;  // in texels
  const Vec2 size(static_cast<float>(node.image->texels.width), static_cast<float>(node.image->texels.height));
  const Vec2 p = glm::clamp(Vec2(st.x, 1 - st.y) * size - (node.nearest ? 0.0f : 0.5f), -kFarthest, kFarthest);
  const Vec2 low = glm::floor(p);
  const auto x = static_cast<int64_t>(low.x);
  const auto y = static_cast<int64_t>(low.y);
  Rgb value = texel(node, x, y);
  if (!node.nearest) {
    const Vec2 part = p - low;
    if (part.x > 1e-3f) value = glm::mix(value, texel(node, x + 1, y), part.x);
    if (part.y > 1e-3f) {
      const Rgb below = glm::mix(texel(node, x, y + 1), texel(node, x + 1, y + 1), part.x);
      value = glm::mix(value, below, part.y);
    }
  }
  value *= node.scale;
  return node.invert ? glm::max(Rgb(1) - value, Rgb(0)) : value;
}

bool is_odd_cell(const Vec2& st) {
  const float cells = std::floor(st.x) + std::floor(st.y);
  return cells - 2 * std::floor(cells / 2) != 0;
}

}  // namespace

Rgb value_at(const TextureNode& node, const Vec2& uv) {
  const Vec2 st = node.mapping.scale * uv + node.mapping.offset;
  switch (node.kind) {
    case TextureNode::Kind::constant: return node.value;
    case TextureNode::Kind::image: return image_value(node, st);
    case TextureNode::Kind::checkerboard: return value_at(*node.inputs[is_odd_cell(st) ? 1 : 0], uv);
    case TextureNode::Kind::product: return value_at(*node.inputs[0], uv) * value_at(*node.inputs[1], uv);
    case TextureNode::Kind::mix: break;
  }
  const Rgb amount = glm::clamp(value_at(*node.inputs[2], uv), Rgb(0), Rgb(1));
  return glm::mix(value_at(*node.inputs[0], uv), value_at(*node.inputs[1], uv), amount);
}

const TextureNode* Textures::constant(const Rgb& value) {
  TextureNode& node = nodes_.emplace_back();
  node.value = value;
  return &node;
}

const TextureNode* Textures::color(const Parameters& parameters, std::string_view name) {
  if (const Parameter* p = parameters.find(name, {"texture"}); p && !p->strings.empty())
    return named(p->strings[0], false, p->where);
  const auto value = colors_.reflectance(parameters, name);
  return value ? constant(*value) : nullptr;
}

const TextureNode* Textures::number(const Parameters& parameters, std::string_view name) {
  if (const Parameter* p = parameters.find(name, {"texture"}); p && !p->strings.empty())
    return named(p->strings[0], true, p->where);
  const float value = parameters.number(name, -kInfinity);
  return is_finite(value) ? constant(Rgb(value)) : nullptr;
}

const TextureNode* Textures::float_texture(const std::string& name, const Location& where) {
  return named(name, true, where);
}

const TextureNode* Textures::named(const std::string& name, bool is_float, const Location& where) {
  const auto [known, is_new] = known_.try_emplace({name, is_float}, nullptr);
  if (!is_new) {
    if (!known->second) fail(where, fmt::format("the texture '{}' refers to itself; correct it", name));
    return known->second;
  }
  const auto& textures = is_float ? description_.float_textures : description_.color_textures;
  const auto entity = textures.find(name);
  if (entity == textures.end())
    fail(where, fmt::format("there is no {} texture '{}'; define it", is_float ? "float" : "spectrum", name));
  if (known_.size() > 100000) fail(where, "the scene has more than 100000 textures; merge some");
  if (++depth_ > kMaxCost)
    fail(where, fmt::format("more than {} textures are nested; bake '{}' to an image", kMaxCost, name));
  TextureNode node = make(entity->second);
  --depth_;
  node.is_float = is_float;
  for (const TextureNode* input : node.inputs) node.cost += input ? input->cost : 0;
  if (node.cost > kMaxCost)
    fail(where, fmt::format("the texture '{}' combines more than {} textures; bake it to an image", name, kMaxCost));
  entity->second.parameters.warn_of_unused(fmt::format("texture '{}'", entity->second.kind), warnings_);
  nodes_.push_back(std::move(node));
  return known_[{name, is_float}] = &nodes_.back();
}

const TextureNode* Textures::input(const TextureEntity& entity, std::string_view name, float otherwise) {
  const TextureNode* node = entity.is_float ? number(entity.parameters, name) : color(entity.parameters, name);
  return node ? node : constant(Rgb(otherwise));
}

UvMapping Textures::mapping(const Parameters& parameters) {
  if (const std::string kind = parameters.string("mapping", "uv"); kind != "uv")
    warnings_.add(fmt::format("the texture mapping '{}' is not supported; the shape's coordinates are used", kind));
  const auto finite = [&](std::string_view name, float otherwise) {
    const float value = parameters.number(name, otherwise);
    return std::fabs(value) <= 1e6f ? value : otherwise;
  };
  return {{finite("uscale", 1), finite("vscale", 1)}, {finite("udelta", 0), finite("vdelta", 0)}};
}

void Textures::make_image(const Parameters& parameters, TextureNode& node) {
  const std::string name = parameters.string("filename");
  if (name.empty()) fail(parameters.where(), "an imagemap has no file; give it 'string filename'");
  const std::string given = parameters.string("encoding", "sRGB");
  const std::string encoding = lower_extension(name) == ".png" ? given : "sRGB";  // others ignore it, as in pbrt
  node.encoding.srgb = encoding == "sRGB";
  if (encoding.starts_with("gamma ")) node.encoding.gamma = std::clamp(std::strtof(&encoding[6], nullptr), 0.1f, 10.0f);
  const std::string wrap = parameters.string("wrap", "repeat");
  node.wrap = wrap == "clamp" || wrap == "black" ? WrapMode::clamp : WrapMode::repeat;
  if (wrap == "black") warnings_.add("the wrap mode 'black' of textures is not supported; their edges are continued");
  node.nearest = parameters.string("filter") == "point";
  parameters.number("maxanisotropy", 8);
  node.scale = std::clamp(parameters.number("scale", 1), 0.0f, 1e9f);
  node.invert = parameters.boolean("invert", false);
  node.mapping = mapping(parameters);
  node.image = images_.read(name, parameters.where());
  node.kind = node.image ? TextureNode::Kind::image : TextureNode::Kind::constant;
  node.value = Rgb(0.5f);
}

TextureNode Textures::checkerboard(const TextureEntity& entity) {
  TextureNode node;
  node.kind = TextureNode::Kind::checkerboard;
  node.inputs = {input(entity, "tex1", 1), input(entity, "tex2", 0), nullptr};
  if (entity.parameters.integer("dimension", 2) != 2)
    warnings_.add("three-dimensional checkerboards are not supported; two-dimensional ones are used");
  node.mapping = mapping(entity.parameters);
  return node;
}

TextureNode Textures::make(const TextureEntity& entity) {
  const Parameters& parameters = entity.parameters;
  TextureNode node;
  if (entity.kind == "constant") {
    node = *input(entity, "value", 1);
  } else if (entity.kind == "imagemap") {
    make_image(parameters, node);
  } else if (entity.kind == "checkerboard") {
    node = checkerboard(entity);
  } else if (entity.kind == "scale") {
    node.kind = TextureNode::Kind::product;
    const TextureNode* scale = number(parameters, "scale");
    node.inputs = {input(entity, "tex", 1), scale ? scale : constant(Rgb(1)), nullptr};
  } else if (entity.kind == "mix" || entity.kind == "directionmix") {
    if (entity.kind == "directionmix")
      warnings_.add("textures of type directionmix are not supported; the mean of both textures is used");
    node.kind = TextureNode::Kind::mix;
    const TextureNode* amount = number(parameters, "amount");
    node.inputs = {input(entity, "tex1", 0), input(entity, "tex2", 1), amount ? amount : constant(Rgb(0.5f))};
  } else {
    warnings_.add(fmt::format("textures of type '{}' are not supported; the value 0.5 is used", entity.kind));
    node.value = Rgb(0.5f);
  }
  return node;
}

}  // namespace relume::pbrt
