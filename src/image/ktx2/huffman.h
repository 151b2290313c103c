// Canonical Huffman codes of BasisLZ streams.
#pragma once

#include <cstdint>
#include <vector>

#include "image/ktx2/bit_reader.h"

namespace relume::detail {

/// Decodes one canonical Huffman code of up to 16 bits, as RFC 1951, §3.2.2 assigns them.
class HuffmanTable {
 public:
  /// Reads the code lengths of a table from the stream. Throws Error unless they make a prefix code. A table without
  /// symbols has no codes.
  static HuffmanTable read(BitReader& bits);

  /// Builds the code from its lengths, one for each symbol; 0: the symbol is unused. `bits` reports errors.
  HuffmanTable(const std::vector<uint8_t>& lengths, const BitReader& bits);

  /// Reads one symbol. Throws Error if the stream ends or has no symbol here.
  uint32_t decode(BitReader& bits) const;

 private:
  HuffmanTable() : entries_(2) {}

  struct Entry {
    uint16_t symbol = 0;
    uint8_t length = 0;  ///< 0: no code begins with these bits
  };

  size_t max_length_ = 1;
  std::vector<Entry> entries_;  ///< by the next max_length_ bits
};

}  // namespace relume::detail
