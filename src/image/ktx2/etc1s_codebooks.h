// Codebooks and code tables shared by all ETC1S slices of a BasisLZ file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/ktx2/huffman.h"

namespace relume::detail {

/// Colour of an ETC1S block.
struct Etc1sEndpoint {
  std::array<uint8_t, 3> color{};  ///< RGB, 5 bits
  uint8_t intensity = 0;           ///< row of ETC1's modifier table, 0 to 7
};

/// Modifiers of the texels of an ETC1S block: one byte per row, 2 bits per texel, the left texel in the lowest bits.
using Etc1sSelector = std::array<uint8_t, 4>;

/// Reads `count` endpoints from `bytes`. Throws Error.
std::vector<Etc1sEndpoint> read_etc1s_endpoints(std::span<const std::byte> bytes, size_t count,
                                                const std::string& name);

/// Reads `count` selectors from `bytes`. Throws Error.
std::vector<Etc1sSelector> read_etc1s_selectors(std::span<const std::byte> bytes, size_t count,
                                                const std::string& name);

/// Codes of the symbols in slices.
struct Etc1sTables {
  HuffmanTable endpoint_prediction;  ///< per group of 2 × 2 blocks
  HuffmanTable endpoint_delta;       ///< relative to the endpoint of the previous block
  HuffmanTable selector;             ///< selectors, history entries, runs
  HuffmanTable selector_run;
  size_t history_size = 0;  ///< number of selectors
};

/// Reads the tables. Throws Error.
Etc1sTables read_etc1s_tables(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
