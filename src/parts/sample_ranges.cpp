#include "parts/sample_ranges.h"

#include <algorithm>
#include <charconv>
#include <system_error>

#include <fmt/format.h>

#include "framebuffer/pixel_sums.h"

namespace relume {
namespace {

std::optional<uint32_t> parse_index(std::string_view text) {
  uint32_t index = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (failure != std::errc{} || end != text.data() + text.size() || index > kLastSample) return std::nullopt;
  return index;
}

}  // namespace

std::optional<SampleRange> parse_sample_range(std::string_view text) {
  const size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const std::optional<uint32_t> first = parse_index(text.substr(0, dash));
  const std::optional<uint32_t> last = parse_index(text.substr(dash + 1));
  if (!first || !last || *last < *first || *first % kBlockSamples != 0) return std::nullopt;
  return SampleRange{*first, *last};
}

std::optional<SampleRanges> SampleRanges::parse(std::string_view text) {
  SampleRanges ranges;
  while (true) {
    const size_t comma = std::min(text.find(','), text.size());
    const std::optional<SampleRange> range = parse_sample_range(text.substr(0, comma));
    if (!range || ranges.overlaps(SampleRanges(*range))) return std::nullopt;
    ranges.add(SampleRanges(*range));
    if (comma == text.size()) return ranges;
    text.remove_prefix(comma + 1);
  }
}

bool SampleRanges::overlaps(const SampleRanges& other) const {
  return std::any_of(ranges_.begin(), ranges_.end(), [&](const SampleRange& a) {
    return std::any_of(other.ranges_.begin(), other.ranges_.end(),
                       [&](const SampleRange& b) { return a.first <= b.last && b.first <= a.last; });
  });
}

void SampleRanges::add(const SampleRanges& other) {
  ranges_.insert(ranges_.end(), other.ranges_.begin(), other.ranges_.end());
  std::sort(ranges_.begin(), ranges_.end(),
            [](const SampleRange& a, const SampleRange& b) { return a.first < b.first; });
  std::vector<SampleRange> joined;
  for (const SampleRange& range : ranges_) {
    if (!joined.empty() && joined.back().last + 1 == range.first) {
      joined.back().last = range.last;
    } else {
      joined.push_back(range);
    }
  }
  ranges_ = std::move(joined);
}

uint32_t SampleRanges::count() const {
  uint32_t count = 0;
  for (const SampleRange& range : ranges_) count += range.count();
  return count;
}

std::string SampleRanges::to_string() const {
  std::string text;
  for (const SampleRange& range : ranges_)
    text += fmt::format("{}{}-{}", text.empty() ? "" : ",", range.first, range.last);
  return text;
}

}  // namespace relume
