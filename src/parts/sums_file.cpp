#include "parts/sums_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/parallel.h"
#include "image/exr_rows.h"
#include "parts/part_file.h"
#include "relume/error.h"

namespace relume {
namespace {

/// Channels of the image, in the order of EXR files.
constexpr std::array<const char*, 3> kImage = {"B", "G", "R"};

Attributes attributes_of(const MergedSums& merged, const std::string& file) {
  Attributes attributes = merged.attributes;
  attributes[kSumsAttribute] = part_attributes({}, merged.surface).at(kSumsAttribute);
  attributes[kSamplesAttribute] = merged.samples.to_string();
  attributes[kCorrelatedAttribute] = std::to_string(merged.correlated_frames);
  if (merged.replicas > 0) attributes[kReplicasAttribute] = std::to_string(merged.replicas);
  PartInfo info = read_part_info(attributes, file);
  return merged_attributes(std::move(attributes), info, true);
}

/// Calls `copy` with the index of each pixel of the window's rows and its index in the image.
template <typename F>
void for_pixels(const MergedSums& merged, int first, int rows, const F& copy) {
  const PixelWindow& w = merged.window;
  parallel_for(static_cast<size_t>(rows), [&](size_t row) {
    const size_t y = static_cast<size_t>(w.y + first) + row;
    for (size_t x = 0; x < static_cast<size_t>(w.width); ++x) {
      copy(row * static_cast<size_t>(w.width) + x,
           y * static_cast<size_t>(merged.width) + static_cast<size_t>(w.x) + x);
    }
  });
}

}  // namespace

bool is_sums_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 4> magic{};
  return stream.read(magic.data(), magic.size()) && magic == std::array<char, 4>{0x76, 0x2f, 0x31, 0x01};
}

void write_sums_file(const std::filesystem::path& file, const MergedSums& merged, std::span<const PixelSums> sums) {
  ExrLayout layout{merged.width, merged.height, merged.window, {}, attributes_of(merged, file.string())};
  for (const char* name : kImage) layout.channels.push_back({name, false});
  for (ExrRowChannel& channel : sum_channels(merged.surface)) layout.channels.push_back(std::move(channel));
  const uint32_t samples = merged.samples.count();
  ExrRowWriter writer(file, layout);
  for (int y = 0; y < merged.window.height; y += kRowsAtOnce) {
    const int rows = std::min(kRowsAtOnce, merged.window.height - y);
    const auto pixels = static_cast<size_t>(rows) * static_cast<size_t>(merged.window.width);
    std::vector<uint32_t> words(layout.channels.size() * pixels);
    std::vector<PixelSums> window(pixels);
    for_pixels(merged, y, rows, [&](size_t i, size_t pixel) {
      window[i] = sums[pixel];
      const Rgb mean = sums[pixel].radiance.mean(samples);
      for (size_t c = 0; c < 3; ++c) words[c * pixels + i] = std::bit_cast<uint32_t>(mean[2 - static_cast<int>(c)]);
    });
    store_sums(window, merged.surface, std::span(words).subspan(kImage.size() * pixels));
    writer.write(rows, words);
  }
  writer.commit();
}

PartInfo read_sums_file(const std::filesystem::path& file, const MergedSums& expected, std::span<PixelSums> sums) {
  const std::string name = file.string();
  ExrRowReader reader(file);
  const ExrLayout& layout = reader.layout();
  PartInfo info = read_part_info(layout.attributes, name);
  MergedSums like_file = expected;  // whose samples may differ
  like_file.samples = info.samples;
  like_file.replicas = info.replicas;
  const PartInfo wanted = read_part_info(attributes_of(like_file, "this render"), "this render");
  if (const std::string problem = difference(info, name, wanted, "this render"); !problem.empty())
    throw Error(fmt::format("{}; or delete the checkpoint to start over", problem));
  const std::vector<ExrRowChannel> channels = sum_channels(expected.surface);
  const bool fits = layout.width == expected.width && layout.height == expected.height &&
                    layout.window == expected.window && layout.channels.size() == kImage.size() + channels.size() &&
                    std::equal(channels.begin(), channels.end(), layout.channels.begin() + kImage.size());
  if (!fits)
    throw Error(
        fmt::format("{}: it has another size or other layers than this render; use the same, or delete it", name));
  std::vector<PixelSums> read(sums.size());  // `sums` stay unchanged if the file is damaged
  for (int y = 0; y < layout.window.height; y += kRowsAtOnce) {
    const int rows = std::min(kRowsAtOnce, layout.window.height - y);
    const auto pixels = static_cast<size_t>(rows) * static_cast<size_t>(layout.window.width);
    std::vector<uint32_t> words(layout.channels.size() * pixels);
    reader.read(y, rows, words);
    std::vector<PixelSums> window(pixels);
    add_sums(std::span(words).subspan(kImage.size() * pixels), expected.surface, window);
    for_pixels(expected, y, rows, [&](size_t i, size_t pixel) { read[pixel] = window[i]; });
  }
  parallel_for(sums.size(), [&](size_t i) { sums[i].add(read[i]); });
  return info;
}

}  // namespace relume
