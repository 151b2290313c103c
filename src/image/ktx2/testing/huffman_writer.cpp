#include "image/ktx2/testing/huffman_writer.h"

#include <algorithm>
#include <map>

namespace relume::testing {
namespace {

/// Sets lengths to the depths of the leaves of a Huffman tree; returns the largest.
size_t measure_tree(const std::vector<uint64_t>& counts, std::vector<uint8_t>& lengths) {
  std::multimap<uint64_t, std::vector<size_t>> trees;  // leaves of each tree, keyed by the sum of their counts
  for (size_t symbol = 0; symbol < counts.size(); ++symbol) {
    if (counts[symbol] > 0) trees.insert({counts[symbol], {symbol}});
  }
  lengths.assign(counts.size(), 0);
  if (trees.size() == 1) lengths[trees.begin()->second[0]] = 1;
  while (trees.size() > 1) {
    auto first = trees.extract(trees.begin());
    auto second = trees.extract(trees.begin());
    first.key() += second.key();
    first.mapped().insert(first.mapped().end(), second.mapped().begin(), second.mapped().end());
    for (const size_t symbol : first.mapped()) ++lengths[symbol];
    trees.insert(std::move(first));
  }
  return *std::max_element(lengths.begin(), lengths.end());
}

/// Code of a symbol (RFC 1951, §3.2.2).
uint32_t canonical_code(const std::vector<uint8_t>& lengths, size_t symbol) {
  uint32_t code = 0;
  for (uint8_t length = 1; length <= lengths[symbol]; ++length) {
    code <<= 1;
    const size_t end = length == lengths[symbol] ? symbol : lengths.size();
    code +=
        static_cast<uint32_t>(std::count(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(end), length));
  }
  return code;
}

void write_code(const std::vector<uint8_t>& lengths, size_t symbol, BitWriter& bits) {
  const uint32_t code = canonical_code(lengths, symbol);
  for (int i = lengths[symbol] - 1; i >= 0; --i) bits.put(code >> i, 1);
}

/// A length, or a run followed by its number of repetitions.
struct Token {
  uint32_t symbol;
  size_t extra_bits = 0;
  uint64_t extra = 0;
};

std::vector<Token> tokens_of(const std::vector<uint8_t>& lengths) {
  std::vector<Token> tokens;
  for (size_t i = 0; i < lengths.size();) {
    size_t run = 1;
    while (i + run < lengths.size() && lengths[i + run] == lengths[i]) ++run;
    const bool zeros = lengths[i] == 0;
    if (!zeros && run > 3) {  // runs repeat the length before them
      tokens.push_back({lengths[i]});
      ++i;
      --run;
    }
    if (zeros && run >= 11) {
      run = std::min<size_t>(run, 138);
      tokens.push_back({18, 7, run - 11});
    } else if (zeros && run >= 3) {
      tokens.push_back({17, 3, run - 3});
    } else if (!zeros && run >= 7 && !tokens.empty() && lengths[i - 1] == lengths[i]) {
      run = std::min<size_t>(run, 134);
      tokens.push_back({20, 7, run - 7});
    } else if (!zeros && run >= 3 && !tokens.empty() && lengths[i - 1] == lengths[i]) {
      tokens.push_back({19, 2, run - 3});
    } else {
      run = 1;
      tokens.push_back({lengths[i]});
    }
    i += run;
  }
  return tokens;
}

}  // namespace

std::vector<uint8_t> huffman_lengths(std::vector<uint64_t> counts, size_t max_length) {
  std::vector<uint8_t> lengths;
  while (measure_tree(counts, lengths) > max_length) {
    for (uint64_t& count : counts) count = (count + 1) / 2;
  }
  return lengths;
}

void HuffmanWriter::count(uint32_t symbol) {
  if (symbol >= counts_.size()) counts_.resize(symbol + 1);
  ++counts_[symbol];
}

void HuffmanWriter::write_table(BitWriter& bits) {
  constexpr uint8_t kOrder[] = {17, 18, 19, 20, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15, 16};
  if (counts_.empty()) count(0);
  lengths_ = huffman_lengths(counts_, 16);
  const std::vector<Token> tokens = tokens_of(lengths_);
  std::vector<uint64_t> token_counts(std::size(kOrder));
  for (const Token& token : tokens) ++token_counts[token.symbol];
  const std::vector<uint8_t> token_lengths = huffman_lengths(token_counts, 7);
  bits.put(lengths_.size(), 14);
  bits.put(std::size(kOrder), 5);
  for (const uint8_t symbol : kOrder) bits.put(token_lengths[symbol], 3);
  for (const Token& token : tokens) {
    write_code(token_lengths, token.symbol, bits);
    bits.put(token.extra, token.extra_bits);
  }
}

void HuffmanWriter::write(uint32_t symbol, BitWriter& bits) const { write_code(lengths_, symbol, bits); }

}  // namespace relume::testing
