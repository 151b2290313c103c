// Writes canonical Huffman codes in BasisLZ's format, for tests.
#pragma once

#include <cstdint>
#include <vector>

#include "image/ktx2/testing/bit_writer.h"

namespace relume::testing {

/// Lengths of an optimal code of at most `max_length` bits for symbols with the frequencies `counts`. A single symbol
/// gets length 1.
std::vector<uint8_t> huffman_lengths(std::vector<uint64_t> counts, size_t max_length);

/// A code for the counted symbols.
class HuffmanWriter {
 public:
  /// Must precede write_table().
  void count(uint32_t symbol);

  /// Writes the code lengths, with runs. A code without counts contains symbol 0.
  void write_table(BitWriter& bits);

  /// Writes the code of a symbol. Requires write_table().
  void write(uint32_t symbol, BitWriter& bits) const;

 private:
  std::vector<uint64_t> counts_;
  std::vector<uint8_t> lengths_;
};

}  // namespace relume::testing
