#include "scene/texture_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/activity.h"
#include "core/parallel.h"
#include "core/srgb.h"

namespace relume {
namespace {

/// sRGB code of a linear value, from a table precise enough for 8 bits.
uint8_t srgb_code(float linear) {
  static const auto table = [] {
    std::array<uint8_t, 4096> t;
    // Square-root spacing keeps the dark end precise.
    for (size_t i = 0; i < t.size(); ++i)
      t[i] = quantise_unorm8(srgb_from_linear(sqr((static_cast<float>(i) + 0.5f) / 4096.0f)));
    return t;
  }();
  return table[static_cast<size_t>(std::sqrt(saturate(linear)) * 4095.99f)];
}

size_t texel_size(PixelFormat format) { return format == PixelFormat::rgba32_float ? 16 : 4; }

/// Number of texels of a level with its blocks padded to full size.
uint32_t padded_texels(int width, int height) {
  return static_cast<uint32_t>((width + 3) / 4) * static_cast<uint32_t>((height + 3) / 4) * 16;
}

void store(std::byte* level, PixelFormat format, int width, int x, int y, const Vec4& value) {
  const uint32_t blocks = static_cast<uint32_t>(width + 3) / 4;
  const size_t index = (static_cast<uint32_t>(y) / 4 * blocks + static_cast<uint32_t>(x) / 4) * 16 +
                       static_cast<uint32_t>(y) % 4 * 4 + static_cast<uint32_t>(x) % 4;
  if (format == PixelFormat::rgba32_float) {
    std::memcpy(level + index * 16, &value, 16);
    return;
  }
  const bool srgb = format == PixelFormat::rgba8_srgb;
  const auto code = [&](float c) { return srgb ? srgb_code(c) : quantise_unorm8(c); };
  const uint8_t bytes[4] = {code(value.x), code(value.y), code(value.z), quantise_unorm8(value.w)};
  std::memcpy(level + index * 4, bytes, 4);
}

/// Copies level 0 into blocks without changing the values.
void copy_base(const Texture& texture, std::byte* level) {
  const size_t bytes = texel_size(texture.format);
  const uint32_t blocks = static_cast<uint32_t>(texture.width + 3) / 4;
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) {
      const size_t index = (static_cast<uint32_t>(y) / 4 * blocks + static_cast<uint32_t>(x) / 4) * 16 +
                           static_cast<uint32_t>(y) % 4 * 4 + static_cast<uint32_t>(x) % 4;
      const size_t source = static_cast<size_t>(y) * static_cast<size_t>(texture.width) + static_cast<size_t>(x);
      std::memcpy(level + index * bytes, texture.texels.data() + source * bytes, bytes);
    }
  }
}

/// Texels of the finer level covered by one texel of the coarser; the outer ones partially, if the size is odd.
struct Footprint {
  double start;
  double end;

  Footprint(int i, int coarse, int fine) : start(double(i) * fine / coarse), end(double(i + 1) * fine / coarse) {}
  int first() const { return static_cast<int>(start); }
  int last() const { return static_cast<int>(std::ceil(end)); }
  float weight(int texel) const {
    return static_cast<float>((std::min(end, texel + 1.0) - std::max(start, double(texel))) / (end - start));
  }
};

/// Computes the mean of the covered texels in linear space, weighted by area only, so every level has the same mean.
void filter_level(const TextureView& view, int level, std::byte* texels) {
  const int w = view.level_width(level);
  const int h = view.level_height(level);
  std::byte* target = texels + static_cast<size_t>(view.level_offset[level]) * texel_size(view.format);
  for (int y = 0; y < h; ++y) {
    const Footprint rows(y, h, view.level_height(level - 1));
    for (int x = 0; x < w; ++x) {
      const Footprint columns(x, w, view.level_width(level - 1));
      Vec4 sum(0);
      for (int j = rows.first(); j < rows.last(); ++j) {
        for (int i = columns.first(); i < columns.last(); ++i) {
          sum += view.texel(level - 1, i, j) * (rows.weight(j) * columns.weight(i));
        }
      }
      store(target, view.format, w, x, y, sum);
    }
  }
}

TextureView build(const Texture& texture, Array<TexelBytes>& texels) {
  TextureView view;
  view.srgb_table = srgb_to_linear_table();
  view.width = texture.width;
  view.height = texture.height;
  view.format = texture.format;
  view.wrap_u = texture.wrap_u;
  view.wrap_v = texture.wrap_v;
  view.nearest = texture.filter == FilterMode::nearest;
  uint32_t count = 0;
  for (int level = 0; level < static_cast<int>(kMaxMipLevels); ++level) {
    view.level_offset[level] = count;
    count += padded_texels(view.level_width(level), view.level_height(level));
    view.level_count = level + 1;
    if (view.level_width(level) == 1 && view.level_height(level) == 1) break;
  }
  // Texels come in blocks of 16, so the division is exact.
  texels.reset(static_cast<size_t>(count) * texel_size(texture.format) / sizeof(TexelBytes));
  auto* const target = reinterpret_cast<std::byte*>(texels.write().data());
  view.texels = target;
  copy_base(texture, target);
  for (int level = 1; level < view.level_count; ++level) filter_level(view, level, target);
  return view;
}

}  // namespace

const float* srgb_to_linear_table() {
  static const auto table = [] {
    std::array<float, 256> t;
    for (size_t i = 0; i < t.size(); ++i) t[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
    return t;
  }();
  return table.data();
}

TextureStore::TextureStore(std::span<const Texture> textures, TextureFilter filter, Memory& memory)
    : texels_(textures.size(), Array<TexelBytes>(memory)), views_(memory) {
  views_.reset(textures.size());
  const std::span<TextureView> views = views_.write();
  Activity activity("filtering textures", textures.size());
  parallel_for(textures.size(), [&](size_t i) {
    views[i] = build(textures[i], texels_[i]);
    activity.part_done();
    if (filter == TextureFilter::linear) return;
    views[i].encoded = textures[i].format == PixelFormat::rgba8_srgb;
    views[i].level_count = 1;
  });
}

void TextureStore::open_for_host() const {
  views_.read();
  for (const Array<TexelBytes>& texels : texels_) texels.read();
}

size_t TextureStore::memory_bytes() const {
  size_t sum = 0;
  for (const Array<TexelBytes>& t : texels_) sum += t.memory_bytes();
  return sum;
}

}  // namespace relume
