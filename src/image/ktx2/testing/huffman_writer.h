// Writes canonical Huffman codes as BasisLZ stores them, for tests.
#pragma once

#include <cstdint>
#include <vector>

#include "image/ktx2/testing/bit_writer.h"

namespace relume::testing {

/// Lengths of an optimal code for symbols that occur `counts` times each, of at most `max_length` bits. A single symbol
/// gets length 1.
std::vector<uint8_t> huffman_lengths(std::vector<uint64_t> counts, size_t max_length);

/// A code made for the symbols that were counted.
class HuffmanWriter {
 public:
  /// Before write_table().
  void count(uint32_t symbol);

  /// Writes the lengths of the codes, with runs. A code for nothing has symbol 0.
  void write_table(BitWriter& bits);

  /// Writes the code of a symbol. After write_table().
  void write(uint32_t symbol, BitWriter& bits) const;

 private:
  std::vector<uint64_t> counts_;
  std::vector<uint8_t> lengths_;
};

}  // namespace relume::testing
