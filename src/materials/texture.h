// Texture look-up: tiled texels, mip levels, stochastic choice between the two nearest levels.
#pragma once

#include <cstddef>

#include "core/hash.h"
#include "core/vec.h"
#include "core/view.h"
#include "relume/material_types.h"

namespace relume {

/// Interpolation of textures. `linear`: after decoding, as in glTF, with mip levels. `encoded`: as in Cycles, between
/// sRGB codes and at full resolution; it darkens textures with fine detail.
enum class TextureFilter : int { linear, encoded };

inline constexpr uint32_t kMaxMipLevels = 16;

/// Affine map of texture coordinates (KHR_texture_transform): uv' = m · uv + offset, row by row.
struct UvTransform {
  float m00 = 1, m01 = 0, m10 = 0, m11 = 1;
  Vec2 offset{0};

  RELUME_HD Vec2 operator()(const Vec2& uv) const { return vector(uv) + offset; }
  RELUME_HD Vec2 vector(const Vec2& duv) const { return {m00 * duv.x + m01 * duv.y, m10 * duv.x + m11 * duv.y}; }
  RELUME_HD float area_scale() const { return std::fabs(m00 * m11 - m01 * m10); }
};

/// 16 bytes of texels: one of PixelFormat::rgba32_float, or four of 8 bits per channel.
struct alignas(16) TexelBytes {
  std::byte bytes[16];
};

/// Size and layout of one texture. Texels are stored in 4 × 4 blocks, to keep most bilinear look-ups within one cache
/// line.
struct TextureRecord {
  uint32_t first = 0;                         ///< its first element of TexturesView::texels
  uint32_t level_offset[kMaxMipLevels] = {};  ///< first texel of each level
  int width = 0;
  int height = 0;
  int level_count = 0;
  PixelFormat format = PixelFormat::rgba8_srgb;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  bool nearest = false;
  bool encoded = false;  ///< whether TextureFilter::encoded applies

  RELUME_HD int level_width(int level) const { return width >> level > 1 ? width >> level : 1; }
  RELUME_HD int level_height(int level) const { return height >> level > 1 ? height >> level : 1; }

  /// Level for a look-up at `uv` with a footprint of `lod` = log2(texels) at level 0. A hash of the coordinates dithers
  /// it, with the trilinear value as expectation.
  RELUME_HD int level_at(const Vec2& uv, float lod) const {
    if (!(lod > 0.0f)) return 0;
    const float dither = to_unit_float(hash(float_bits(uv.x), float_bits(uv.y)));
    const float last = static_cast<float>(level_count - 1);
    return static_cast<int>(clamp(lod + dither, 0.0f, last));
  }
};

/// Looks up one texture. Lives within one call of a kernel.
class TextureSampler {
 public:
  /// `texels`: of all textures.
  RELUME_HD_INLINE TextureSampler(const TextureRecord& record, const View<const TexelBytes>& texels,
                                  const View<const float>& srgb_table)
      : record_(record), texels_{texels.data + record.first, texels.size - record.first}, srgb_table_(srgb_table) {}

  RELUME_HD const TextureRecord& record() const { return record_; }

  /// Texel of a level, linear RGBA. Coordinates must be in range.
  RELUME_HD Vec4 texel(int level, int x, int y) const {
    const Vec4 stored = stored_texel(level, x, y);
    return record_.encoded ? decode(stored) : stored;
  }

  /// Bilinear (or nearest) look-up in one level. Inlined, so that a device's thread keeps this object in registers.
  RELUME_HD_INLINE Vec4 sample_level(const Vec2& uv, int level) const {
    const int w = record_.level_width(level);
    const int h = record_.level_height(level);
    const float x = wrap_coordinate(uv.x, record_.wrap_u) * static_cast<float>(w);
    const float y = wrap_coordinate(uv.y, record_.wrap_v) * static_cast<float>(h);
    if (record_.nearest) return texel(level, clamp_index(static_cast<int>(x), w), clamp_index(static_cast<int>(y), h));
    const float fx = std::floor(x - 0.5f);
    const float fy = std::floor(y - 0.5f);
    const float tx = x - 0.5f - fx;
    const float ty = y - 0.5f - fy;
    const int x0 = wrap_index(static_cast<int>(fx), w, record_.wrap_u);
    const int x1 = wrap_index(static_cast<int>(fx) + 1, w, record_.wrap_u);
    const int y0 = wrap_index(static_cast<int>(fy), h, record_.wrap_v);
    const int y1 = wrap_index(static_cast<int>(fy) + 1, h, record_.wrap_v);
    const Vec4 top = stored_texel(level, x0, y0) * (1.0f - tx) + stored_texel(level, x1, y0) * tx;
    const Vec4 bottom = stored_texel(level, x0, y1) * (1.0f - tx) + stored_texel(level, x1, y1) * tx;
    const Vec4 value = top * (1.0f - ty) + bottom * ty;
    return record_.encoded ? decode(value) : value;
  }

 private:
  /// Texel as used by interpolation: linear, or sRGB codes in [0, 1] if `encoded`.
  RELUME_HD Vec4 stored_texel(int level, int x, int y) const {
    const uint32_t blocks = (static_cast<uint32_t>(record_.level_width(level)) + 3) / 4;
    const uint32_t block = (static_cast<uint32_t>(y) / 4) * blocks + static_cast<uint32_t>(x) / 4;
    const uint32_t index =
        record_.level_offset[level] + block * 16 + (static_cast<uint32_t>(y) % 4) * 4 + static_cast<uint32_t>(x) % 4;
    if (record_.format == PixelFormat::rgba32_float) return reinterpret_cast<const Vec4*>(texels_.data)[index];
    const uint8_t* c = reinterpret_cast<const uint8_t*>(texels_.data) + static_cast<size_t>(index) * 4;
    constexpr float kScale = 1.0f / 255.0f;
    const float alpha = static_cast<float>(c[3]) * kScale;
    if (record_.format == PixelFormat::rgba8_srgb && !record_.encoded)
      return {srgb_table_[c[0]], srgb_table_[c[1]], srgb_table_[c[2]], alpha};
    return {static_cast<float>(c[0]) * kScale, static_cast<float>(c[1]) * kScale, static_cast<float>(c[2]) * kScale,
            alpha};
  }

  /// Linear value of a colour given as sRGB codes; interpolates the table between codes.
  RELUME_HD Vec4 decode(const Vec4& c) const {
    Vec4 linear = c;
    for (int k = 0; k < 3; ++k) {
      const float scaled = c[k] * 255.0f;
      const uint32_t code = scaled < 254.0f ? static_cast<uint32_t>(scaled) : 254u;
      linear[k] = lerp(srgb_table_[code], srgb_table_[code + 1], scaled - static_cast<float>(code));
    }
    return linear;
  }

  /// Maps a coordinate to [0, 1]; mirror mode folds it.
  RELUME_HD static float wrap_coordinate(float x, WrapMode wrap) {
    if (!is_finite(x)) return 0.0f;
    if (wrap == WrapMode::clamp) return saturate(x);
    if (wrap == WrapMode::repeat) return x - std::floor(x);
    const float t = std::fabs(x - 2.0f * std::floor(0.5f * x + 0.5f));
    return t;
  }
  RELUME_HD static int clamp_index(int i, int count) { return i < 0 ? 0 : (i < count ? i : count - 1); }
  /// Wraps the index of a neighbour across the border; i in [-1, count].
  RELUME_HD static int wrap_index(int i, int count, WrapMode wrap) {
    if (wrap != WrapMode::repeat) return clamp_index(i, count);
    return i < 0 ? count - 1 : (i >= count ? (i == count ? 0 : count - 1) : i);
  }

  const TextureRecord& record_;
  View<const TexelBytes> texels_;  ///< of this texture and those after it
  View<const float> srgb_table_;
};

/// All textures of a scene. Their texels share one array, and records refer to it by index.
struct TexturesView {
  View<const TextureRecord> records;
  View<const TexelBytes> texels;
  View<const float> srgb_table;  ///< linear value of each 8-bit sRGB code

  RELUME_HD_INLINE TextureSampler operator[](uint32_t i) const { return {records[i], texels, srgb_table}; }

  /// TextureSampler::sample_level() for texture i. Kernels call this: a sampler would take memory of a device's thread
  /// at every call.
  RELUME_HD_NOINLINE Vec4 sample_level(uint32_t i, const Vec2& uv, int level) const {
    return (*this)[i].sample_level(uv, level);
  }
  /// Look-up in texture i with a footprint of `lod` = log2(texels) at level 0.
  RELUME_HD Vec4 sample(uint32_t i, const Vec2& uv, float lod) const {
    return sample_level(i, uv, records[i].level_at(uv, lod));
  }
};

/// A material's use of a texture.
struct TextureUse {
  int32_t texture = -1;
  uint32_t uv_set = 0;
  UvTransform transform;

  RELUME_HD bool used() const { return texture >= 0; }
};

}  // namespace relume
