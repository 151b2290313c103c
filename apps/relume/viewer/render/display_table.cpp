#include "viewer/render/display_table.h"

#include <chrono>
#include <utility>

#include "cli/platform.h"
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

DisplayTable display_table(const OcioView& view) { return {kOcioSize, view.encode(entries(kOcioSize), 0).pixels}; }

OcioDisplay::OcioDisplay(std::shared_ptr<const OcioView> view) : view_(std::move(view)) {
  if (!view_) return;
  table_ = std::async(std::launch::async, [view = view_] {
    cli::lower_thread_priority();
    return display_table(*view);
  });
}

bool OcioDisplay::ready() const {
  return !table_.valid() || table_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

const DisplayTable* OcioDisplay::table() const { return table_.valid() ? &table_.get() : nullptr; }

}  // namespace relume::viewer
