#include "parts/part_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "core/parallel.h"
#include "parts/part_info.h"
#include "relume/error.h"
#include "render/session.h"
#include "render/summed_layers.h"

namespace relume {
namespace {

constexpr size_t kWords = sizeof(PixelSums) / sizeof(uint32_t);
constexpr size_t kWordsWithoutSurface = (sizeof(PixelSums) - sizeof(SurfaceSums)) / sizeof(uint32_t);
using Words = std::array<uint32_t, kWords>;
static_assert(std::endian::native == std::endian::little, "words of sums are stored in the order of memory");

ExrLayout layout_of(const ExrFile& exr, bool surface) {
  ExrLayout layout{exr.width, exr.height, exr.data_window, {}, exr.attributes};
  if (layout.window.empty()) layout.window = {0, 0, exr.width, exr.height};
  for (const ExrChannel& channel : exr.channels) layout.channels.push_back({channel.name, false});
  for (ExrRowChannel& channel : sum_channels(surface)) layout.channels.push_back(std::move(channel));
  return layout;
}

/// Copies rows of the channels of an image within the window.
void copy_channels(const ExrFile& exr, const PixelWindow& window, int first, int rows, uint32_t* words) {
  const auto width = static_cast<size_t>(window.width);
  for (const ExrChannel& channel : exr.channels) {
    for (int y = 0; y < rows; ++y) {
      const size_t begin = static_cast<size_t>(window.y + first + y) * static_cast<size_t>(exr.width);
      std::memcpy(words, channel.values.data() + begin + static_cast<size_t>(window.x), width * sizeof(uint32_t));
      words += width;
    }
  }
}

}  // namespace

size_t sum_words(bool surface) { return surface ? kWords : kWordsWithoutSurface; }

std::vector<ExrRowChannel> sum_channels(bool surface) {
  std::vector<ExrRowChannel> channels;
  for (size_t i = 0; i < sum_words(surface); ++i) channels.push_back({fmt::format("{}{:02}", kSumsPrefix, i), true});
  return channels;
}

void add_sums(std::span<const uint32_t> words, bool surface, std::span<PixelSums> sums) {
  parallel_for(sums.size(), [&](size_t pixel) {
    Words pixel_words{};
    for (size_t i = 0; i < sum_words(surface); ++i) pixel_words[i] = words[i * sums.size() + pixel];
    sums[pixel].add(std::bit_cast<PixelSums>(pixel_words));
  });
}

void store_sums(std::span<const PixelSums> sums, bool surface, std::span<uint32_t> words) {
  parallel_for(sums.size(), [&](size_t pixel) {
    const auto pixel_words = std::bit_cast<Words>(sums[pixel]);
    for (size_t i = 0; i < sum_words(surface); ++i) words[i * sums.size() + pixel] = pixel_words[i];
  });
}

void write_part(const std::filesystem::path& file, const ExrFile& exr, const Session& session) {
  const RenderedSamples rendered = rendered_samples(session);
  if (rendered.count == 0) throw Error(fmt::format("{}: the part has no sample; render it again", file.string()));
  if (!session.prepared()) {
    throw Error(fmt::format(
        "{}: the part ended before the light lists were complete, so its samples differ from those of other parts; "
        "raise --time",
        file.string()));
  }
  const bool surface = render_settings(session).auxiliary;
  ExrLayout layout = layout_of(exr, surface);
  layout.attributes.merge(part_attributes(rendered, surface));
  const PixelWindow& window = layout.window;
  ExrRowWriter writer(file, layout);
  for (int y = 0; y < window.height; y += kRowsAtOnce) {
    const int rows = std::min(kRowsAtOnce, window.height - y);
    const auto pixels = static_cast<size_t>(rows) * static_cast<size_t>(window.width);
    std::vector<uint32_t> words(layout.channels.size() * pixels);
    copy_channels(exr, window, y, rows, words.data());
    std::vector<PixelSums> sums(pixels);
    for (int row = 0; row < rows; ++row) {
      const int first = (window.y + y + row) * exr.width + window.x;
      const auto width = static_cast<size_t>(window.width);
      read_sums(buffer_table(session), static_cast<uint32_t>(first),
                std::span(sums).subspan(static_cast<size_t>(row) * width, width));
    }
    store_sums(sums, surface, std::span(words).subspan(exr.channels.size() * pixels));
    writer.write(rows, words);
  }
  writer.commit();
}

}  // namespace relume
