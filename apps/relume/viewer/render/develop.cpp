#include "viewer/render/develop.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/srgb.h"
#include "viewer/render/display_table.h"

namespace relume::viewer {
namespace {

constexpr Rgb kNotFinite{1, 0, 1};
constexpr int kPaletteSize = 256;
constexpr int kMantissaBits = 10;

/// Binary logarithms of positive normal numbers, from a table of their leading bits. The error is below 0.001.
class Log2Table {
 public:
  Log2Table() {
    for (uint32_t i = 0; i < values_.size(); ++i)
      values_[i] = std::log2(1 + (static_cast<float>(i) + 0.5f) / static_cast<float>(values_.size()));
  }
  float operator()(float x) const {
    const auto bits = std::bit_cast<uint32_t>(x);
    const uint32_t leading = (bits & 0x7fffff) >> (23 - kMantissaBits);
    return static_cast<float>(static_cast<int>(bits >> 23) - 127) + values_[leading];
  }

 private:
  std::array<float, 1 << kMantissaBits> values_;
};

std::array<Rgb, kPaletteSize> make_palette() {
  std::array<Rgb, kPaletteSize> palette;
  for (int i = 0; i < kPaletteSize; ++i)
    palette[static_cast<size_t>(i)] = palette_color(static_cast<float>(i) / (kPaletteSize - 1));
  return palette;
}

/// A cell of the table along one channel, and the position in it.
struct Cell {
  int index = 0;
  float share = 0;
};

/// Colours by a display table: trilinear interpolation between its entries.
class TableLookup {
 public:
  TableLookup(const DisplayTable& table, float exposure)
      : table_(table), scale_(std::exp2(std::clamp(exposure, -64.0f, 64.0f))) {}

  Rgb operator()(const Rgb& radiance) const {
    const Cell r = cell(radiance.r);
    const Cell g = cell(radiance.g);
    const Cell b = cell(radiance.b);
    const auto size = static_cast<size_t>(table_.size);
    const Rgb* at = table_.colors.data() + static_cast<size_t>(r.index) +
                    size * (static_cast<size_t>(g.index) + size * static_cast<size_t>(b.index));
    const auto row = [&](const Rgb* first) { return first[0] + r.share * (first[1] - first[0]); };
    const auto plane = [&](const Rgb* first) {
      const Rgb low = row(first);
      return low + g.share * (row(first + size) - low);
    };
    const Rgb low = plane(at);
    return low + b.share * (plane(at + size * size) - low);
  }

 private:
  Cell cell(float radiance) const {
    static const Log2Table log2;
    const float ev = log2(std::clamp(radiance * scale_, 1e-9f, 1e30f));
    const float t = saturate((ev - kTableMinEv) / (kTableMaxEv - kTableMinEv));
    const float position = t * static_cast<float>(table_.size - 1);
    const int index = std::min(static_cast<int>(position), table_.size - 2);
    return {index, position - static_cast<float>(index)};
  }

  const DisplayTable& table_;
  float scale_;
};

float in_range(float x, const Vec2& range) { return (x - range.x) / std::max(range.y - range.x, 1e-30f); }

Rgb false_color(const Rgb& v, const DisplayTransform& transform) {
  static const std::array<Rgb, kPaletteSize> palette = make_palette();
  const float chosen = transform.channel < 0 ? glm::length(v) : v[std::min(transform.channel, 2)];
  const float t = saturate(in_range(chosen, transform.range));
  return palette[static_cast<size_t>(t * (kPaletteSize - 1) + 0.5f)];
}

Rgb color_in_range(const Rgb& v, const Vec2& range) {
  return srgb_from_linear(
      Rgb(saturate(in_range(v.r, range)), saturate(in_range(v.g, range)), saturate(in_range(v.b, range))));
}

uint8_t to_byte(float x) { return static_cast<uint8_t>(saturate(x) * 255 + 0.5f); }

template <typename Convert>
void convert_all(std::span<const Rgb> values, std::span<uint8_t> rgb, const Convert& convert) {
  const size_t count = std::min(values.size(), rgb.size() / 3);
  for (size_t i = 0; i < count; ++i) {
    const Rgb color = is_finite(values[i]) ? convert(values[i]) : kNotFinite;
    for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = to_byte(color[static_cast<int>(c)]);
  }
}

}  // namespace

void develop(std::span<const Rgb> values, const DisplayTransform& transform, const DisplayTable& table,
             std::span<uint8_t> rgb) {
  switch (transform.mode) {
    case DisplayMode::radiance: return convert_all(values, rgb, TableLookup(table, transform.exposure));
    case DisplayMode::color:
      return convert_all(values, rgb, [&](const Rgb& v) { return color_in_range(v, transform.range); });
    case DisplayMode::false_color:
      return convert_all(values, rgb, [&](const Rgb& v) { return false_color(v, transform); });
    case DisplayMode::direction: return convert_all(values, rgb, [](const Rgb& v) { return v * 0.5f + 0.5f; });
  }
}

}  // namespace relume::viewer
