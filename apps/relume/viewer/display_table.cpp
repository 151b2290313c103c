#include "viewer/display_table.h"

#include "core/srgb.h"
#include "framebuffer/ocio_view.h"
#include "framebuffer/tone_map.h"
#include "relume/image.h"

namespace relume::viewer {
namespace {

constexpr int kToneMapSize = 48;
constexpr int kOcioSize = 81;  // four entries per stop

float radiance_at(int entry, int size) {
  const float t = static_cast<float>(entry) / static_cast<float>(size - 1);
  return entry == 0 ? 0.0f : std::exp2(lerp(kTableMinEv, kTableMaxEv, t));
}

/// Radiance of every entry, one row per pair of green and blue.
Image entries(int size) {
  Image image(size, size * size);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < size; ++x)
      image.at(x, y) = Rgb(radiance_at(x, size), radiance_at(y % size, size), radiance_at(y / size, size));
  }
  return image;
}

}  // namespace

DisplayTable display_table(ToneMap tone_map) {
  DisplayTable table{kToneMapSize, entries(kToneMapSize).pixels};
  for (Rgb& color : table.colors) color = srgb_from_linear(relume::tone_map(tone_map, 0, color));
  return table;
}

DisplayTable display_table(const OcioView& view) {
  DisplayTable table{kOcioSize, view.apply(entries(kOcioSize), 0).pixels};
  for (Rgb& color : table.colors) color = srgb_from_linear(color);
  return table;
}

}  // namespace relume::viewer
