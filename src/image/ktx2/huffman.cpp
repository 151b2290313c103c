// KTX File Format Specification 2.0, appendix "BasisLZ/ETC1S Bitstream", §"Compressed Huffman Tables".
#include "image/ktx2/huffman.h"

#include <algorithm>
#include <array>

namespace relume::detail {
namespace {

constexpr size_t kMaxLength = 16;
constexpr size_t kLengthSymbols = 21;  ///< lengths 0 to 16 and four kinds of runs

/// Symbols of code lengths in the order of their own lengths (same appendix).
constexpr std::array<uint8_t, kLengthSymbols> kLengthOrder = {17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                              11, 4,  12, 3,  13, 2, 14, 1, 15, 16};

/// Repetition of a length by a symbol from 17 on.
struct Run {
  size_t count_bits;
  size_t min_count;
  bool zeros;  ///< otherwise repeats the previous length
};
constexpr std::array<Run, 4> kRuns = {{{3, 3, true}, {7, 11, true}, {2, 3, false}, {7, 7, false}}};

HuffmanTable read_length_table(BitReader& bits) {
  const size_t count = bits.read(5);
  if (count < 1 || count > kLengthSymbols) bits.fail("a Huffman table has a wrong number of code lengths");
  std::vector<uint8_t> lengths(kLengthSymbols);
  for (size_t i = 0; i < count; ++i) lengths[kLengthOrder[i]] = static_cast<uint8_t>(bits.read(3));
  return HuffmanTable(lengths, bits);
}

/// The first `length` bits of `code` in reverse: streams store the most significant bit of a code first.
uint32_t reversed(uint32_t code, size_t length) {
  uint32_t result = 0;
  for (size_t i = 0; i < length; ++i) result |= ((code >> i) & 1u) << (length - 1 - i);
  return result;
}

}  // namespace

HuffmanTable HuffmanTable::read(BitReader& bits) {
  const size_t symbol_count = bits.read(14);
  if (symbol_count == 0) return {};
  const HuffmanTable length_table = read_length_table(bits);
  std::vector<uint8_t> lengths;
  lengths.reserve(symbol_count);
  while (lengths.size() < symbol_count) {
    const uint32_t symbol = length_table.decode(bits);
    if (symbol <= kMaxLength) {
      lengths.push_back(static_cast<uint8_t>(symbol));
      continue;
    }
    const Run& run = kRuns[symbol - kMaxLength - 1];
    const size_t count = run.min_count + bits.read(run.count_bits);
    const uint8_t length = run.zeros || lengths.empty() ? uint8_t{0} : lengths.back();
    if (!run.zeros && length == 0) bits.fail("a Huffman table repeats a length of 0");
    if (count > symbol_count - lengths.size()) bits.fail("a Huffman table has too many symbols");
    lengths.insert(lengths.end(), count, length);
  }
  return HuffmanTable(lengths, bits);
}

HuffmanTable::HuffmanTable(const std::vector<uint8_t>& lengths, const BitReader& bits) {
  std::array<uint32_t, kMaxLength + 1> counts{};
  for (const uint8_t length : lengths) ++counts[length];
  const size_t used = lengths.size() - counts[0];
  counts[0] = 0;
  std::array<uint32_t, kMaxLength + 1> next_code{};
  uint32_t code_space = 0;  // in codes of kMaxLength bits
  for (size_t length = 1; length <= kMaxLength; ++length) {
    next_code[length] = (next_code[length - 1] + counts[length - 1]) << 1;
    code_space += counts[length] << (kMaxLength - length);
    if (counts[length] > 0) max_length_ = length;
  }
  // A single symbol may have any code length; the rest of the code space is unused.
  if (used == 0 || (used > 1 && code_space != 1u << kMaxLength)) bits.fail("a Huffman table is not a prefix code");
  entries_.resize(size_t{1} << max_length_);
  for (size_t symbol = 0; symbol < lengths.size(); ++symbol) {
    const size_t length = lengths[symbol];
    if (length == 0) continue;
    const uint32_t first = reversed(next_code[length]++, length);
    for (size_t i = first; i < entries_.size(); i += size_t{1} << length)
      entries_[i] = {static_cast<uint16_t>(symbol), static_cast<uint8_t>(length)};
  }
}

uint32_t HuffmanTable::decode(BitReader& bits) const {
  const Entry entry = entries_[bits.peek(max_length_)];
  if (entry.length == 0) bits.fail("its compressed data contain an unknown Huffman code");
  bits.skip(entry.length);
  return entry.symbol;
}

}  // namespace relume::detail
