// Bit fields in the order of BasisLZ and UASTC, for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace relume::testing {

/// Appends fields, starting at the least significant bit of the first byte.
class BitWriter {
 public:
  void put(uint64_t value, size_t count) {
    for (size_t i = 0; i < count; ++i, value >>= 1) {
      if (used_ % 8 == 0) bytes_.push_back(std::byte{0});
      if ((value & 1u) != 0) bytes_.back() |= static_cast<std::byte>(1u << (used_ % 8));
      ++used_;
    }
  }

  size_t used() const { return used_; }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
  size_t used_ = 0;  ///< bits
};

}  // namespace relume::testing
