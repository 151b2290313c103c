#include "scene_io/mitsuba/mitsuba_texels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/common.hpp>

#include "core/srgb.h"

namespace relume::mitsuba {
namespace {

int wrapped(int i, int size, WrapMode wrap) {
  if (wrap == WrapMode::clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == WrapMode::mirror ? 2 * size : size;
  const int inside = ((i % period) + period) % period;
  return inside < size ? inside : period - 1 - inside;
}

/// Fills a texture of the given size from a value per texel.
void fill(Texture& texture, int width, int height, PixelFormat format, const std::function<Vec4(int, int)>& value) {
  texture.width = width;
  texture.height = height;
  texture.format = format;
  texture.file = nullptr;
  const bool is_float = format == PixelFormat::rgba32_float;
  const bool is_srgb = format == PixelFormat::rgba8_srgb;
  texture.texels.resize(static_cast<size_t>(width) * static_cast<size_t>(height) * (is_float ? sizeof(Vec4) : 4));
  std::byte* out = texture.texels.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec4 v = value(x, y);
      if (is_float) {
        std::memcpy(out, &v, sizeof v);
        out += sizeof v;
        continue;
      }
      for (int c = 0; c < 4; ++c) *out++ = std::byte{quantise_unorm8(is_srgb && c < 3 ? srgb_from_linear(v[c]) : v[c])};
    }
  }
}

bool is_float(const Texels* texels) { return texels && texels->image().format == PixelFormat::rgba32_float; }

int larger(const Texels* a, const Texels* b, int (Texels::*side)() const) {
  return std::max(a ? (a->*side)() : 1, b ? (b->*side)() : 1);
}

/// Fills a texture from the widths at each texel, in [0, 1].
void fill_widths(const Texels& alpha_u, const Texels& alpha_v, Texture& texture,
                 const std::function<Vec4(float, float)>& value) {
  const int width = larger(&alpha_u, &alpha_v, &Texels::width);
  const int height = larger(&alpha_u, &alpha_v, &Texels::height);
  fill(texture, width, height, PixelFormat::rgba8_linear, [&](int x, int y) {
    return value(saturate(alpha_u.luminance_of(x, y, width, height)),
                 saturate(alpha_v.luminance_of(x, y, width, height)));
  });
}

}  // namespace

Vec4 Texels::at(int x, int y) const {
  const int column = wrapped(x, image_.width, image_.wrap_u);
  const int row = wrapped(y, image_.height, image_.wrap_v);
  const size_t i = 4 * (static_cast<size_t>(row) * static_cast<size_t>(image_.width) + static_cast<size_t>(column));
  Vec4 value;
  if (image_.format == PixelFormat::rgba32_float) {
    std::memcpy(&value, &image_.texels[i * sizeof(float)], sizeof value);
    return value;
  }
  for (int c = 0; c < 4; ++c) {
    const float encoded = static_cast<float>(std::to_integer<int>(image_.texels[i + static_cast<size_t>(c)])) / 255.0f;
    value[c] = c < 3 && image_.format == PixelFormat::rgba8_srgb ? linear_from_srgb(encoded) : encoded;
  }
  return value;
}

Vec4 Texels::at(int x, int y, int width, int height) const {
  const auto scaled = [](int i, int to, int from) { return static_cast<int>((2 * int64_t{i} + 1) * to / (2 * from)); };
  return at(scaled(x, image_.width, width), scaled(y, image_.height, height));
}

Rgb Texels::mean() const {
  glm::dvec3 sum(0);
  for (int y = 0; y < image_.height; ++y) {
    for (int x = 0; x < image_.width; ++x) sum += glm::dvec3(Vec3(at(x, y)));
  }
  return Rgb(sum / (static_cast<double>(image_.width) * image_.height));
}

void combine_surface(const Texels* roughness, bool is_alpha, const Texels* metallic, Texture& texture) {
  const int width = larger(roughness, metallic, &Texels::width);
  const int height = larger(roughness, metallic, &Texels::height);
  fill(texture, width, height, PixelFormat::rgba8_linear, [&](int x, int y) {
    const float given = roughness ? roughness->luminance_of(x, y, width, height) : 1.0f;
    return Vec4(1, is_alpha ? safe_sqrt(given) : given, metallic ? metallic->luminance_of(x, y, width, height) : 1.0f,
                1);
  });
}

void combine_color(const Texels* color, const Texels* opacity, Texture& texture) {
  const int width = larger(color, opacity, &Texels::width);
  const int height = larger(color, opacity, &Texels::height);
  const PixelFormat format = is_float(color) ? PixelFormat::rgba32_float : PixelFormat::rgba8_srgb;
  fill(texture, width, height, format, [&](int x, int y) {
    Vec4 value = color ? color->at(x, y, width, height) : Vec4(1);
    value.w = opacity ? saturate(opacity->luminance_of(x, y, width, height)) : 1.0f;
    return value;
  });
}

void combine_narrow_widths(const Texels& alpha_u, const Texels& alpha_v, Texture& texture) {
  fill_widths(alpha_u, alpha_v, texture, [](float u, float v) { return Vec4(1, safe_sqrt(std::min(u, v)), 1, 1); });
}

void combine_anisotropy(const Texels& alpha_u, const Texels& alpha_v, Texture& texture) {
  fill_widths(alpha_u, alpha_v, texture, [](float u, float v) {
    const float narrow = std::min(u, v);
    const float strength = narrow < 1 ? safe_sqrt((std::max(u, v) - narrow) / (1 - narrow)) : 0.0f;
    return u >= v ? Vec4(1, 0.5f, strength, 1) : Vec4(0.5f, 1, strength, 1);
  });
}

void mix(const Texels& weight, const std::array<const Texels*, 2>& images, const std::array<Rgb, 2>& ends,
         bool is_color, Texture& texture) {
  const int width = std::max(weight.width(), larger(images[0], images[1], &Texels::width));
  const int height = std::max(weight.height(), larger(images[0], images[1], &Texels::height));
  const auto end = [&](size_t i, int x, int y) {
    return images[i] ? ends[i] * Rgb(images[i]->at(x, y, width, height)) : ends[i];
  };
  fill(texture, width, height, is_color ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear, [&](int x, int y) {
    const float w = saturate(weight.luminance_of(x, y, width, height));
    return Vec4(glm::mix(end(0, x, y), end(1, x, y), w), 1);
  });
}

void spread_luminance(const Texels& source, Texture& texture) {
  fill(texture, source.width(), source.height(), PixelFormat::rgba8_linear,
       [&](int x, int y) { return Vec4(luminance(Rgb(source.at(x, y)))); });
}

void make_normals(const Texels& heights, const Vec2& slope, Texture& texture) {
  const int width = heights.width();
  const int height = heights.height();
  const bool fits = static_cast<uint64_t>(int64_t{width} * height) <= kMaxFloatTexels;
  const auto h = [&](int x, int y) { return luminance(Rgb(heights.at(x, y))); };
  fill(texture, width, height, fits ? PixelFormat::rgba32_float : PixelFormat::rgba8_linear, [&](int x, int y) {
    const float du = (h(x + 1, y) - h(x - 1, y)) * 0.5f * static_cast<float>(width) * slope.x;
    const float dv = (h(x, y + 1) - h(x, y - 1)) * 0.5f * static_cast<float>(height) * slope.y;
    const Vec3 normal = is_finite(du) && is_finite(dv) ? glm::normalize(Vec3(-du, -dv, 1)) : Vec3(0, 0, 1);
    return Vec4(normal * 0.5f + Vec3(0.5f), 1);
  });
}

Texels with_colors(const Texels& source, const std::function<Rgb(const Rgb&)>& change) {
  Texture texture;
  texture.name = source.image().name;
  texture.wrap_u = source.image().wrap_u;
  texture.wrap_v = source.image().wrap_v;
  texture.filter = source.image().filter;
  fill(texture, source.width(), source.height(), source.image().format, [&](int x, int y) {
    const Vec4 value = source.at(x, y);
    return Vec4(change(Rgb(value)), value.w);
  });
  return Texels(std::move(texture));
}

Texture checkerboard(const Rgb& first, const Rgb& second) {
  Texture texture;
  texture.name = "checkerboard";
  texture.filter = FilterMode::nearest;
  fill(texture, 2, 2, PixelFormat::rgba32_float, [&](int x, int y) { return Vec4(x == y ? first : second, 1); });
  return texture;
}

}  // namespace relume::mitsuba
