#include "relume/merge.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/parallel.h"
#include "files/extension.h"
#include "image/exr_rows.h"
#include "parts/part_file.h"
#include "parts/part_info.h"
#include "relume/error.h"
#include "render/summed_layers.h"

namespace relume {
namespace {

struct Part {
  explicit Part(const std::filesystem::path& path)
      : file(path.string()), rows(path), info(read_part_info(rows.layout().attributes, file)) {}

  std::string file;
  ExrRowReader rows;
  PartInfo info;
};

/// Source of a channel of the merged image.
struct Source {
  std::optional<SummedValue> value;  ///< std::nullopt: the channel is copied from one part
  bool of_first = false;             ///< copied from the part with the first sample, instead of the last
  size_t channel = 0;                ///< its index in the parts
};

void check_layout(const Part& a, const Part& b) {
  const ExrLayout& left = a.rows.layout();
  const ExrLayout& right = b.rows.layout();
  if (left.width != right.width || left.height != right.height) {
    throw Error(fmt::format("{} has {} x {} pixels, but {} has {} x {}; merge parts of one size", a.file, left.width,
                            left.height, b.file, right.width, right.height));
  }
  if (left.window != right.window)
    throw Error(fmt::format("{} and {} show different windows; use the same --crop", a.file, b.file));
  if (left.channels != right.channels)
    throw Error(fmt::format("{} and {} have different layers; use the same --aov", a.file, b.file));
}

void check_samples(const Part& a, const Part& b) {
  const SampleRanges& left = a.info.samples;
  const SampleRanges& right = b.info.samples;
  if (!left.overlaps(right)) return;
  throw Error(fmt::format("{} and {} share samples ({} and {}); merge each sample once", a.file, b.file,
                          left.to_string(), right.to_string()));
}

/// Opens the parts, in the order of their samples, and checks that they belong together.
std::vector<Part> open_parts(const std::vector<std::filesystem::path>& files) {
  if (files.empty()) throw Error("there is no part to merge; name at least one file");
  std::vector<Part> parts;
  for (const std::filesystem::path& file : files) parts.emplace_back(file);
  const Part& first = parts.front();
  for (size_t b = 1; b < parts.size(); ++b) {
    const std::string problem = difference(first.info, first.file, parts[b].info, parts[b].file);
    if (!problem.empty()) throw Error(problem);
    check_layout(first, parts[b]);
    for (size_t a = 0; a < b; ++a) check_samples(parts[a], parts[b]);
  }
  std::sort(parts.begin(), parts.end(),
            [](const Part& a, const Part& b) { return a.info.samples.first() < b.info.samples.first(); });
  return parts;
}

PartInfo merged_info(const std::vector<Part>& parts) {
  PartInfo merged = parts.front().info;
  for (size_t i = 1; i < parts.size(); ++i) {
    merged.samples.add(parts[i].info.samples);
    merged.replicas += parts[i].info.replicas;
    merged.correlated_frames = std::max(merged.correlated_frames, parts[i].info.correlated_frames);
  }
  return merged;
}

Attributes attributes_of(const std::vector<Part>& parts, const PartInfo& merged, bool keep_sums) {
  Attributes attributes = parts.front().rows.layout().attributes;
  std::string& timings = attributes["relume.timings"];
  for (size_t i = 1; i < parts.size(); ++i) {
    const Attributes& others = parts[i].rows.layout().attributes;
    if (const auto found = others.find("relume.timings"); found != others.end())
      timings = add_timings(timings, found->second);
  }
  return merged_attributes(std::move(attributes), merged, keep_sums);
}

class Merge {
 public:
  Merge(std::vector<Part> parts, bool keep_sums)
      : parts_(std::move(parts)), keep_sums_(keep_sums), merged_(merged_info(parts_)) {
    const auto latest = std::max_element(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) {
      return a.info.samples.last() < b.info.samples.last();
    });
    last_ = static_cast<size_t>(latest - parts_.begin());
    sort_channels();
  }

  MergeReport write(const std::filesystem::path& output) {
    ExrRowWriter writer(output, layout_);
    const int height = layout_.window.height;
    for (int y = 0; y < height; y += kRowsAtOnce) {
      const int rows = std::min(kRowsAtOnce, height - y);
      writer.write(rows, merge_rows(y, rows));
    }
    writer.commit();
    return {merged_.samples.count(), merged_.samples.missing(), merged_.samples.to_string(), merged_.replicas};
  }

 private:
  /// Finds the channels of the sums, which files hold in alphabetical order, and the sources of all others.
  void sort_channels() {
    const ExrLayout& layout = parts_.front().rows.layout();
    layout_ = {layout.width, layout.height, layout.window, {}, attributes_of(parts_, merged_, keep_sums_)};
    std::vector<ExrRowChannel> sums;
    for (size_t c = 0; c < layout.channels.size(); ++c) {
      const ExrRowChannel& channel = layout.channels[c];
      if (channel.name.starts_with(kSumsPrefix)) {
        if (sums.empty()) first_sum_ = c;
        sums.push_back(channel);
      } else {
        layout_.channels.push_back(channel);
        sources_.push_back({summed_value(channel.name), channel.name.starts_with("motion."), c});
      }
    }
    if (sums != sum_channels(merged_.surface))
      throw Error(fmt::format("{}: channels of its sums are missing; render the part again", parts_.front().file));
    if (keep_sums_) layout_.channels.insert(layout_.channels.end(), sums.begin(), sums.end());
  }

  std::vector<uint32_t> merge_rows(int first, int rows) {
    const size_t pixels = static_cast<size_t>(rows) * static_cast<size_t>(layout_.window.width);
    const size_t words_of_sums = sum_words(merged_.surface) * pixels;
    std::vector<PixelSums> sums(pixels);
    std::vector<uint32_t> merged(layout_.channels.size() * pixels);
    std::vector<uint32_t> words(parts_.front().rows.layout().channels.size() * pixels);
    for (size_t i = 0; i < parts_.size(); ++i) {
      parts_[i].rows.read(first, rows, words);
      add_sums(std::span(words).subspan(first_sum_ * pixels, words_of_sums), merged_.surface, sums);
      for (size_t c = 0; c < sources_.size(); ++c) {
        const Source& source = sources_[c];
        if (source.value || i != (source.of_first ? 0 : last_)) continue;
        std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(source.channel * pixels), pixels,
                    merged.begin() + static_cast<std::ptrdiff_t>(c * pixels));
      }
    }
    write_values(sums, merged);
    if (keep_sums_) store_sums(sums, merged_.surface, std::span(merged).subspan(sources_.size() * pixels));
    return merged;
  }

  void write_values(const std::vector<PixelSums>& sums, std::vector<uint32_t>& merged) const {
    const uint32_t samples = merged_.samples.count();
    for (size_t c = 0; c < sources_.size(); ++c) {
      const std::optional<SummedValue>& value = sources_[c].value;
      if (!value) continue;
      parallel_for(sums.size(), [&](size_t pixel) {
        merged[c * sums.size() + pixel] =
            std::bit_cast<uint32_t>(value_of(*value, sums[pixel], samples, merged_.correlated_frames));
      });
    }
  }

  std::vector<Part> parts_;
  bool keep_sums_;
  PartInfo merged_;
  size_t last_ = 0;  ///< index of the part with the last sample
  ExrLayout layout_;
  std::vector<Source> sources_;  ///< of the first channels of layout_
  size_t first_sum_ = 0;         ///< index of the first channel of sums in the parts
};

}  // namespace

MergeReport merge_images(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& output,
                         bool keep_sums) {
  if (lower_extension(output) != ".exr")
    throw Error(fmt::format("{}: merged images are written as .exr; choose this extension", output.string()));
  return Merge(open_parts(parts), keep_sums).write(output);
}

}  // namespace relume
