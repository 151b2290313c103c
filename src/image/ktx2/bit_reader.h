// Bit fields of BasisLZ streams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "files/little_endian.h"
#include "image/ktx2/ktx2_error.h"

namespace relume::detail {

/// Reads bits, starting at the least significant bit of the first byte. `bytes` and `name` must outlive the reader.
class BitReader {
 public:
  BitReader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  /// Returns the next `count` ≤ 32 bits without consuming them. Bits beyond the end are 0.
  uint32_t peek(size_t count) const {
    const uint64_t bits = number_at(bytes_, position_ / 8, 5) >> (position_ % 8);
    return static_cast<uint32_t>(bits & ((uint64_t{1} << count) - 1));
  }

  /// Throws Error if fewer than `count` bits remain.
  void skip(size_t count) {
    position_ += count;
    if (position_ > 8 * bytes_.size()) fail_cut_off_ktx2(name_);
  }

  /// Reads `count` ≤ 32 bits. Throws Error at the end of the stream.
  uint32_t read(size_t count) {
    const uint32_t bits = peek(count);
    skip(count);
    return bits;
  }

  [[noreturn]] void fail(const std::string& problem) const { fail_damaged_ktx2(name_, problem); }

 private:
  std::span<const std::byte> bytes_;
  const std::string& name_;
  size_t position_ = 0;  ///< in bits
};

}  // namespace relume::detail
