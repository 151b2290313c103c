#include "scene_io/mitsuba/mitsuba_textures.h"

#include <cmath>
#include <exception>
#include <set>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "core/activity.h"
#include "core/parallel.h"
#include "core/srgb.h"
#include "image/image_size.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "scene_io/coated_albedo.h"
#include "scene_io/mitsuba/mitsuba_texels.h"
#include "scene_io/texture_decode.h"

namespace relume::mitsuba {
namespace {

PixelFormat format_of(const TextureSource& source) {
  return source.is_raw ? PixelFormat::rgba8_linear : PixelFormat::rgba8_srgb;
}

Texels changed(const TextureSource& source, Texels texels) {
  if (!source.changes_colors()) return texels;
  return with_colors(texels, [&](const Rgb& color) {
    const Rgb scaled = color * source.factor;
    return source.inner_reflectance > 0
               ? albedo_below_coat(glm::clamp(scaled, Rgb(0), Rgb(1)), source.inner_reflectance)
               : scaled;
  });
}

/// Repairs images of heights and colours to values that are not negative, and of normals to [0, 1].
Texels decode(const TextureSource& source, std::span<const std::byte> bytes, PixelFormat format, Warnings& warnings) {
  if (source.file.empty()) {
    Texture checkers = checkerboard(source.checkers[0], source.checkers[1]);
    checkers.wrap_u = checkers.wrap_v = WrapMode::repeat;
    return changed(source, Texels(std::move(checkers)));
  }
  const std::string name = source.file.filename().string();
  Texture texture = decode_texture(bytes, name, format);
  if (const std::string repair = repair_texels(texture, name, PixelFormat::rgba8_srgb); !repair.empty())
    warnings.add(repair);
  texture.wrap_u = texture.wrap_v = source.wrap;
  texture.filter = source.filter;
  return changed(source, Texels(std::move(texture)));
}

/// Placement of glTF for the matrix of to_uv: a rotation after a scale. Shear is lost.
TextureRef placement_of(const glm::dmat4& to_uv, Warnings& warnings) {
  const glm::dvec2 u(to_uv[0]);
  const glm::dvec2 v(to_uv[1]);
  TextureRef ref;
  ref.offset = Vec2(static_cast<float>(to_uv[3].x), static_cast<float>(to_uv[3].y));
  const double length = glm::length(u);
  const double determinant = u.x * v.y - u.y * v.x;
  ref.scale = Vec2(static_cast<float>(length), static_cast<float>(length > 0 ? determinant / length : glm::length(v)));
  ref.rotation_rad = static_cast<float>(length > 0 ? std::atan2(-u.y, u.x) : 0.0);
  if (std::fabs(glm::dot(u, v)) > 1e-4 * length * glm::length(v))
    warnings.add("a to_uv transform shears, which is not supported; its nearest rotation and scale are used");
  const bool is_usable =
      is_finite(ref.offset.x) && is_finite(ref.offset.y) && is_finite(ref.scale.x) && is_finite(ref.scale.y);
  return is_usable ? ref : TextureRef{};
}

Texture constant_texture(bool is_normal) {
  Texture texture;
  texture.width = texture.height = 1;
  texture.format = PixelFormat::rgba8_linear;
  const auto byte = [](int value) { return static_cast<std::byte>(value); };
  texture.texels = is_normal ? std::vector{byte(128), byte(128), byte(255), byte(255)} : std::vector(4, byte(255));
  return texture;
}

std::string key_of(const std::optional<TextureSource>& source) {
  if (!source) return "-";
  const std::array<Rgb, 2>& c = source->checkers;
  const Rgb& f = source->factor;
  return fmt::format("{}|{}|{}|{}|{}:{}:{}|{}:{}:{}|{}:{}:{}|{}", source->file.string(), source->is_raw,
                     static_cast<int>(source->wrap), static_cast<int>(source->filter), c[0].r, c[0].g, c[0].b, c[1].r,
                     c[1].g, c[1].b, f.r, f.g, f.b, source->inner_reflectance);
}

}  // namespace

bool same_placement(const TextureSource& a, const TextureSource& b) {
  return a.wrap == b.wrap && a.placement.offset == b.placement.offset && a.placement.scale == b.placement.scale &&
         a.placement.rotation_rad == b.placement.rotation_rad;
}

std::optional<TextureSource> Textures::source(const Object& texture) {
  const Parameters p(import_, texture);
  TextureSource source;
  if (texture.type == "bitmap") {
    const std::string reference = p.text("filename", "");
    const std::optional<std::filesystem::path> file = import_.files.find(reference);
    if (!file) p.fail(fmt::format("its filename '{}' names no file; correct it", reference.substr(0, 80)));
    source.file = *file;
    source.is_raw = p.boolean("raw", false);
    const std::string wrap = p.text("wrap_mode", "repeat");
    source.wrap = wrap == "clamp" ? WrapMode::clamp : wrap == "mirror" ? WrapMode::mirror : WrapMode::repeat;
    source.filter = p.text("filter_type", "bilinear") == "nearest" ? FilterMode::nearest : FilterMode::linear;
    p.ignore({"format", "accel"});
  } else if ((texture.type == "d65" || texture.type == "scale") && !p.children({"texture"}).empty()) {
    std::optional<TextureSource> inner = this->source(*p.children({"texture"})[0]);
    if (inner) inner->factor *= color_parameter(import_, p, "scale", Rgb(1), SpectrumUse::reflectance);
    return inner;
  } else if (texture.type == "checkerboard") {
    source.checkers = {color_parameter(import_, p, "color0", Rgb(0.4f), SpectrumUse::reflectance),
                       color_parameter(import_, p, "color1", Rgb(0.2f), SpectrumUse::reflectance)};
    source.filter = FilterMode::nearest;
  } else {
    import_.warnings.add(
        fmt::format("{} is not supported; the default of its parameter replaces it", name_of(texture)));
    return std::nullopt;
  }
  source.placement = placement_of(p.transform("to_uv").value_or(glm::dmat4(1)), import_.warnings);
  return source;
}

TextureRef Textures::request(Request request) {
  const TextureSource& lead = request.sources[0] ? *request.sources[0] : *request.sources[1];
  std::string key =
      fmt::format("{}|{}|{}:{}", static_cast<int>(request.recipe), request.is_alpha, request.slope.x, request.slope.y);
  for (const std::optional<TextureSource>& source : request.sources) key += "|" + key_of(source);
  for (const Rgb& end : request.ends) key += fmt::format("|{}:{}:{}", end.r, end.g, end.b);
  const auto [known, is_new] = known_.try_emplace(key, static_cast<Index>(requests_.size()));
  TextureRef ref = lead.placement;
  ref.texture = known->second;
  if (!is_new) return ref;
  Texture& texture = import_.scene.textures.emplace_back();
  texture.name = lead.file.empty() ? "checkerboard" : lead.file.filename().string();
  texture.wrap_u = texture.wrap_v = lead.wrap;
  texture.filter = lead.filter;
  requests_.push_back(std::move(request));
  return ref;
}

TextureRef Textures::color(const std::optional<TextureSource>& color, const std::optional<TextureSource>& opacity) {
  if (!color && !opacity) return {};
  return request({.recipe = Recipe::color, .sources = {color, opacity, {}}});
}

TextureRef Textures::surface(const std::optional<TextureSource>& roughness, bool is_alpha,
                             const std::optional<TextureSource>& metallic) {
  if (!roughness && !metallic) return {};
  return request({.recipe = Recipe::surface, .sources = {roughness, metallic, {}}, .is_alpha = is_alpha});
}

TextureRef Textures::narrow_widths(const TextureSource& alpha_u, const TextureSource& alpha_v) {
  return request({.recipe = Recipe::narrow_widths, .sources = {alpha_u, alpha_v, {}}});
}

TextureRef Textures::anisotropy(const TextureSource& alpha_u, const TextureSource& alpha_v) {
  return request({.recipe = Recipe::anisotropy, .sources = {alpha_u, alpha_v, {}}});
}

TextureRef Textures::mixed_color(const TextureSource& weight, const std::array<std::optional<TextureSource>, 2>& images,
                                 const std::array<Rgb, 2>& ends) {
  return request({.recipe = Recipe::mixed_color, .sources = {weight, images[0], images[1]}, .ends = ends});
}

TextureRef Textures::mixed_surface(const TextureSource& weight, const std::array<Rgb, 2>& ends) {
  return request({.recipe = Recipe::mixed_surface, .sources = {weight, {}, {}}, .ends = ends});
}

TextureRef Textures::scalar(const TextureSource& source) {
  return request({.recipe = Recipe::scalar, .sources = {source, {}, {}}});
}

TextureRef Textures::normals(const TextureSource& source) {
  return request({.recipe = Recipe::normals, .sources = {source, {}, {}}});
}

TextureRef Textures::bumps(const TextureSource& heights, const Vec2& slope) {
  return request({.recipe = Recipe::bumps, .sources = {heights, {}, {}}, .slope = slope});
}

Rgb Textures::mean(const TextureSource& source) {
  const auto [known, is_new] = means_.try_emplace(key_of(source), Rgb(0.5f));
  if (!is_new) return known->second;
  const ImageFile file = source.file.empty() ? ImageFile{} : read(source.file);
  DecodeBudget budget;
  if (!source.file.empty() && (!file.bytes || !budget.take(file.texels, file.bytes->size()))) return known->second;
  try {
    known->second = decode(source, file.bytes ? std::span<const std::byte>(*file.bytes) : std::span<const std::byte>(),
                           format_of(source), import_.warnings)
                        .mean();
  } catch (const std::exception& error) {
    import_.warnings.add(fmt::format("{}; grey replaces the texture", error.what()));
  }
  return known->second;
}

Textures::ImageFile Textures::read(const std::filesystem::path& path) {
  ImageFile file;
  try {
    file.bytes = std::make_shared<const Bytes>(read_file_bytes(path));
    const detail::ImageSize size = detail::read_image_size(*file.bytes, path.filename().string());
    const bool is_valid = std::min(size.width, size.height) > 0 && std::max(size.width, size.height) <= kMaxImageSide;
    if (is_valid) file.texels = static_cast<uint64_t>(size.width * size.height);
  } catch (const std::exception& error) {
    file.problem = error.what();
  }
  return file;
}

std::vector<Textures::ImageFiles> Textures::read_all() const {
  std::map<std::filesystem::path, ImageFile> distinct;
  for (const Request& request : requests_) {
    for (const std::optional<TextureSource>& source : request.sources) {
      if (source && !source->file.empty()) distinct.try_emplace(source->file);
    }
  }
  std::vector<std::pair<const std::filesystem::path, ImageFile>*> list;
  for (auto& file : distinct) list.push_back(&file);
  parallel_for(list.size(), [&](size_t i) { list[i]->second = read(list[i]->first); });
  std::vector<ImageFiles> files(requests_.size());
  for (size_t i = 0; i < files.size(); ++i) {
    for (size_t k = 0; k < files[i].size(); ++k) {
      const std::optional<TextureSource>& source = requests_[i].sources[k];
      if (source && !source->file.empty()) files[i][k] = distinct.at(source->file);
    }
  }
  return files;
}

void Textures::limit(std::vector<ImageFiles>& files) const {
  DecodeBudget budget;
  std::set<const Bytes*> counted;
  for (size_t i = 0; i < files.size(); ++i) {
    for (ImageFile& file : files[i]) {
      const bool is_float = requests_[i].recipe == Recipe::bumps && file.texels <= kMaxFloatTexels;
      if (!file.bytes) continue;
      const uint64_t bytes = counted.insert(file.bytes.get()).second ? file.bytes->size() : 0;
      if (budget.take(is_float ? 4 * file.texels : file.texels, bytes)) continue;
      file.bytes = nullptr;
      file.problem = fmt::format(
          "{}: {} texels exceed the limit for the images of a scene, 2^29 texels and {} per byte of their files; scale "
          "it down",
          import_.scene.textures[i].name, file.texels, DecodeBudget::kTexelsPerByte);
    }
  }
}

Texture Textures::made(const Request& request, const std::array<const Texels*, 3>& images) {
  const Texels* first = images[0];
  const Texels* second = images[1];
  const bool is_bumpy = request.recipe == Recipe::normals || request.recipe == Recipe::bumps;
  const bool is_plain = request.recipe == Recipe::normals || (request.recipe == Recipe::color && !request.sources[1]);
  if (first && is_plain) return first->image();
  Texture texture = constant_texture(is_bumpy);
  switch (request.recipe) {
    case Recipe::color:
      if (request.sources[1]) combine_color(first, second, texture);
      break;
    case Recipe::surface: combine_surface(first, request.is_alpha, second, texture); break;
    case Recipe::narrow_widths:
      if (first && second) combine_narrow_widths(*first, *second, texture);
      break;
    case Recipe::anisotropy:
      if (first && second) combine_anisotropy(*first, *second, texture);
      break;
    case Recipe::mixed_color:
    case Recipe::mixed_surface:
      if (first) mix(*first, {images[1], images[2]}, request.ends, request.recipe == Recipe::mixed_color, texture);
      break;
    case Recipe::scalar:
      if (first) spread_luminance(*first, texture);
      break;
    case Recipe::bumps:
      if (first) make_normals(*first, request.slope, texture);
      break;
    case Recipe::normals: break;
  }
  return texture;
}

void Textures::make(const Request& request, const ImageFiles& files, Texture& texture, Warnings& warnings) const {
  std::array<std::optional<Texels>, 3> images;
  std::array<const Texels*, 3> usable{};
  for (size_t i = 0; i < images.size(); ++i) {
    const std::optional<TextureSource>& source = request.sources[i];
    if (!source) continue;
    try {
      if (!source->file.empty() && !files[i].bytes) throw Error(files[i].problem);
      const std::span<const std::byte> bytes =
          files[i].bytes ? std::span<const std::byte>(*files[i].bytes) : std::span<const std::byte>();
      const bool is_normal = request.recipe == Recipe::normals;
      images[i] = decode(*source, bytes, is_normal ? PixelFormat::rgba8_linear : format_of(*source), warnings);
      usable[i] = &*images[i];
    } catch (const std::exception& error) {
      warnings.add(fmt::format("{}; one texel of a constant value replaces the texture", error.what()));
    }
  }
  Texture result = made(request, usable);
  const bool is_unchanged =
      usable[0] && (request.recipe == Recipe::normals || (request.recipe == Recipe::color && !request.sources[1])) &&
      !request.sources[0]->changes_colors();
  texture.width = result.width;
  texture.height = result.height;
  texture.format = result.format;
  texture.texels = std::move(result.texels);
  texture.file = is_unchanged ? files[0].bytes : nullptr;
}

void Textures::finish() {
  Activity activity("decoding textures", requests_.size());
  std::vector<ImageFiles> files = read_all();
  limit(files);
  std::vector<Warnings> warnings(requests_.size(), Warnings(""));
  parallel_for(requests_.size(), [&](size_t i) {
    make(requests_[i], files[i], import_.scene.textures[i], warnings[i]);
    activity.part_done();
  });
  for (const Warnings& part : warnings) import_.warnings.add(part);
}

}  // namespace relume::mitsuba
