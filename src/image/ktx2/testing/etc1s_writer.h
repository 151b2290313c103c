// Writes BasisLZ streams of ETC1S blocks, for tests.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "image/ktx2/etc1s_codebooks.h"
#include "image/ktx2/testing/bit_writer.h"

namespace relume::testing {

/// Blocks of an image: codebook indices, row by row.
struct Etc1sBlocks {
  size_t width = 0;   ///< in blocks
  size_t height = 0;  ///< in blocks
  std::vector<uint32_t> endpoints;
  std::vector<uint32_t> selectors;
};

/// Data shared by several images.
struct Etc1sCodebooks {
  std::vector<detail::Etc1sEndpoint> endpoints;
  std::vector<detail::Etc1sSelector> selectors;
  bool grey = false;           ///< endpoints have one channel
  bool raw_selectors = false;  ///< selectors without a code
  size_t history_size = 8;
};

/// Number of times that the writer used a feature of the format.
struct Etc1sStatistics {
  std::array<size_t, 4> predictions{};  ///< left, above, above left, difference
  size_t prediction_runs = 0;
  size_t new_selectors = 0;
  size_t old_selectors = 0;  ///< from the history
  size_t selector_runs = 0;
  size_t long_selector_runs = 0;
};

struct Etc1sStreams {
  std::vector<std::byte> endpoints;
  std::vector<std::byte> selectors;
  std::vector<std::byte> tables;
  std::vector<std::vector<std::byte>> slices;
  Etc1sStatistics statistics;
};

std::vector<std::byte> write_etc1s_endpoints(const std::vector<detail::Etc1sEndpoint>& endpoints, bool grey);
std::vector<std::byte> write_etc1s_selectors(const std::vector<detail::Etc1sSelector>& selectors, bool raw);

/// Writes the codebooks, the code tables and one slice per image.
Etc1sStreams write_etc1s(const Etc1sCodebooks& codebooks, const std::vector<Etc1sBlocks>& images);

}  // namespace relume::testing
