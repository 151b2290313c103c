#include "scene/texture_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

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

/// Mean of the texels that a texel of `level` covers in the finer level, weighted by area.
Vec4 mean_of_covered(const TextureSampler& texture, int level, int x, const Footprint& rows) {
  const TextureRecord& record = texture.record();
  const Footprint columns(x, record.level_width(level), record.level_width(level - 1));
  Vec4 sum(0);
  for (int j = rows.first(); j < rows.last(); ++j) {
    for (int i = columns.first(); i < columns.last(); ++i) {
      sum += texture.texel(level - 1, i, j) * (rows.weight(j) * columns.weight(i));
    }
  }
  return sum;
}

/// The same where a texel covers exactly 2 × 2 texels, with the same bits.
Vec4 mean_of_four(const TextureSampler& texture, int level, int x, int y) {
  Vec4 sum(0);
  for (int j = 2 * y; j < 2 * y + 2; ++j) {
    for (int i = 2 * x; i < 2 * x + 2; ++i) sum += texture.texel(level - 1, i, j) * 0.25f;
  }
  return sum;
}

/// Computes the mean of the covered texels in linear space, so every level has the same mean.
void filter_level(const TextureSampler& texture, int level, std::byte* texels) {
  const TextureRecord& record = texture.record();
  const int w = record.level_width(level);
  const int h = record.level_height(level);
  const bool halves = record.level_width(level - 1) == 2 * w && record.level_height(level - 1) == 2 * h;
  std::byte* target = texels + static_cast<size_t>(record.level_offset[level]) * texel_size(record.format);
  for (int y = 0; y < h; ++y) {
    const Footprint rows(y, h, record.level_height(level - 1));
    for (int x = 0; x < w; ++x) {
      const Vec4 mean = halves ? mean_of_four(texture, level, x, y) : mean_of_covered(texture, level, x, rows);
      store(target, record.format, w, x, y, mean);
    }
  }
}

/// Elements of TexelBytes for a format's texels. They come in blocks of 16, so the division is exact.
size_t elements_of(size_t texels, PixelFormat format) { return texels * texel_size(format) / sizeof(TexelBytes); }

/// Layout of a texture whose texels begin at element `first`.
TextureRecord layout_of(const Texture& texture, size_t first) {
  TextureRecord record;
  record.first = static_cast<uint32_t>(first);
  record.width = texture.width;
  record.height = texture.height;
  record.format = texture.format;
  record.wrap_u = texture.wrap_u;
  record.wrap_v = texture.wrap_v;
  record.nearest = texture.filter == FilterMode::nearest;
  return record;
}

/// Clears the levels that have texels beyond their width or height, so that equal textures have equal bytes.
void clear_padding(const TextureRecord& record, std::span<std::byte> texels) {
  for (int level = 0; level < record.level_count; ++level) {
    const int w = record.level_width(level);
    const int h = record.level_height(level);
    if (w % 4 == 0 && h % 4 == 0) continue;
    const size_t size = texel_size(record.format);
    std::byte* start = texels.data() + static_cast<size_t>(record.level_offset[level]) * size;
    std::memset(start, 0, static_cast<size_t>(padded_texels(w, h)) * size);
  }
}

/// Sets the levels. Returns the number of texels.
size_t lay_out_levels(TextureRecord& record) {
  uint32_t count = 0;
  for (int level = 0; level < static_cast<int>(kMaxMipLevels); ++level) {
    record.level_offset[level] = count;
    count += padded_texels(record.level_width(level), record.level_height(level));
    record.level_count = level + 1;
    if (record.level_width(level) == 1 && record.level_height(level) == 1) break;
  }
  return count;
}

void fill_srgb_table(Array<float>& table) {
  table.reset(256, kUninitialized);
  const std::span<float> values = table.write();
  for (size_t i = 0; i < values.size(); ++i) values[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
}

}  // namespace

TextureStore::TextureStore(std::span<const Texture> textures, TextureFilter filter, Memory& memory)
    : TextureStore(memory) {
  fill_srgb_table(srgb_table_);
  records_.reset(textures.size());
  const std::span<TextureRecord> records = records_.write();
  std::vector<size_t> first(textures.size() + 1, 0);
  for (size_t i = 0; i < textures.size(); ++i) {
    records[i] = layout_of(textures[i], first[i]);
    first[i + 1] = first[i] + elements_of(lay_out_levels(records[i]), records[i].format);
  }
  texels_.reset(first.back(), kUninitialized);
  const std::span<TexelBytes> texels = texels_.write();
  const TexturesView view{view_of(std::span<const TextureRecord>(records)),
                          view_of(std::span<const TexelBytes>(texels)), view_of(srgb_table_.read())};
  Activity activity("filtering textures", textures.size());
  parallel_for(textures.size(), [&](size_t i) {
    const std::span<std::byte> own = std::as_writable_bytes(texels.subspan(first[i], first[i + 1] - first[i]));
    clear_padding(records[i], own);
    copy_base(textures[i], own.data());
    for (int level = 1; level < records[i].level_count; ++level)
      filter_level(view[static_cast<uint32_t>(i)], level, own.data());
    activity.part_done();
    if (filter == TextureFilter::linear) return;
    records[i].encoded = textures[i].format == PixelFormat::rgba8_srgb;
    records[i].level_count = 1;
  });
}

TextureSampler TextureStore::operator[](size_t i) const {
  return {records_.read()[i], view_of(texels_.read()), view_of(srgb_table_.read())};
}

void TextureStore::open_for_host() const {
  records_.permit_reading();
  texels_.permit_reading();
  srgb_table_.permit_reading();
}

}  // namespace relume
