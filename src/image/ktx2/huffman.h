// Canonical Huffman codes of BasisLZ streams.
#pragma once

#include <cstdint>
#include <vector>

#include "image/ktx2/bit_reader.h"

namespace relume::detail {

/// Decodes one canonical Huffman code of up to 16 bits, assigned as in RFC 1951, §3.2.2.
class HuffmanTable {
 public:
  /// Reads the code lengths of a table. Throws Error unless they form a prefix code. A table without symbols has no
  /// codes.
  static HuffmanTable read(BitReader& bits);

  /// Builds the code from the length of each symbol; 0: unused symbol. `bits` reports errors.
  HuffmanTable(const std::vector<uint8_t>& lengths, const BitReader& bits);

  /// Reads one symbol. Throws Error if the stream ends or contains no valid code.
  uint32_t decode(BitReader& bits) const;

 private:
  HuffmanTable() : entries_(2) {}

  struct Entry {
    uint16_t symbol = 0;
    uint8_t length = 0;  ///< 0: no code begins with these bits
  };

  size_t max_length_ = 1;
  std::vector<Entry> entries_;  ///< indexed by the next max_length_ bits
};

}  // namespace relume::detail
