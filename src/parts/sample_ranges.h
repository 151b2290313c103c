// Sets of sample indices, as ranges.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// Samples `first` to `last`, both included.
struct SampleRange {
  uint32_t first = 0;
  uint32_t last = 0;

  uint32_t count() const { return last - first + 1; }
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Largest index of a sample: more samples could overflow exact sums.
inline constexpr uint32_t kLastSample = (1u << 23) - 1;

/// Parses "0-127"; std::nullopt for any other text, for ranges that do not begin at a multiple of kBlockSamples, and
/// beyond kLastSample.
std::optional<SampleRange> parse_sample_range(std::string_view text);

/// Disjoint ranges in order. Adjacent ones are joined.
class SampleRanges {
 public:
  SampleRanges() = default;
  explicit SampleRanges(const SampleRange& range) : ranges_{range} {}

  /// Parses the text of to_string(); std::nullopt for any other.
  static std::optional<SampleRanges> parse(std::string_view text);

  bool overlaps(const SampleRanges& other) const;
  /// Adds disjoint ranges.
  void add(const SampleRanges& other);

  bool empty() const { return ranges_.empty(); }
  uint32_t first() const { return ranges_.front().first; }
  uint32_t last() const { return ranges_.back().last; }
  /// Number of samples in the ranges.
  uint32_t count() const;
  /// Number of samples before last() that are not in the ranges.
  uint32_t missing() const { return last() + 1 - count(); }
  /// The ranges, in order.
  const std::vector<SampleRange>& ranges() const { return ranges_; }
  /// "0-31,64-95".
  std::string to_string() const;

 private:
  std::vector<SampleRange> ranges_;
};

}  // namespace relume
