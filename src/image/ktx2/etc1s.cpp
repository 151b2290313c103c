// KTX File Format Specification 2.0, appendix "BasisLZ/ETC1S Bitstream", §"ETC1S Slice Decoding"; Khronos Data Format
// Specification, §"ETC1S".
#include "image/ktx2/etc1s.h"

#include <algorithm>

namespace relume::detail {
namespace {

/// Modifiers of the selectors 0 to 3 (Khronos Data Format Specification, table "Intensity modifier sets for ETC1").
constexpr std::array<std::array<int, 4>, 8> kModifiers = {{{-8, -2, 2, 8},
                                                           {-17, -5, 5, 17},
                                                           {-29, -9, 9, 29},
                                                           {-42, -13, 13, 42},
                                                           {-60, -18, 18, 60},
                                                           {-80, -24, 24, 80},
                                                           {-106, -33, 33, 106},
                                                           {-183, -47, 47, 183}}};

/// Recently used selectors. Frequently used ones move to the front.
class SelectorHistory {
 public:
  explicit SelectorHistory(size_t size) : selectors_(size), next_(size / 2) {}

  size_t size() const { return selectors_.size(); }

  /// Replaces the oldest selector of the back half.
  void add(uint32_t selector) {
    if (selectors_.empty()) return;
    selectors_[next_++] = selector;
    if (next_ == selectors_.size()) next_ = selectors_.size() / 2;
  }

  /// Returns the selector at `index` and swaps it with the one at half the index.
  uint32_t use(size_t index) {
    const uint32_t selector = selectors_[index];
    std::swap(selectors_[index], selectors_[index / 2]);
    return selector;
  }

 private:
  std::vector<uint32_t> selectors_;
  size_t next_;
};

/// Reads a number in groups of `group_bits`, the lowest first. A bit after each group is set if another one follows.
uint64_t read_number(BitReader& bits, size_t group_bits) {
  uint64_t number = 0;
  for (size_t shift = 0; shift < 32; shift += group_bits) {
    const uint64_t group = bits.read(group_bits + 1);
    const uint64_t more = uint64_t{1} << group_bits;
    number |= (group & (more - 1)) << shift;
    if ((group & more) == 0) return number;
  }
  bits.fail("a run of its blocks has no end");
}

/// Decodes the endpoint of each block, row by row.
class EndpointIndices {
 public:
  EndpointIndices(size_t blocks_x, const Etc1sGlobalData& global)
      : tables_(global.tables),
        endpoint_count_(static_cast<uint32_t>(global.endpoints.size())),
        row_(blocks_x),
        row_above_(blocks_x),
        below_((blocks_x + 1) / 2) {}

  /// Index of the endpoint of block (x, y); blocks must be read in order.
  uint32_t next(size_t x, size_t y, BitReader& bits) {
    if (x == 0) row_.swap(row_above_);
    if (x % 2 == 0) start_group(x, y, bits);
    const uint32_t prediction = predictions_ & 3u;
    predictions_ >>= 2;
    previous_ = predict(prediction, x, y, bits);
    row_[x] = previous_;
    return previous_;
  }

 private:
  enum Prediction : uint32_t { kLeft = 0, kAbove = 1, kAboveLeft = 2, kDelta = 3 };

  /// Sets the predictions of block x and its right neighbour. Groups are 2 × 2 blocks with 2 bits each.
  void start_group(size_t x, size_t y, BitReader& bits) {
    if (y % 2 == 0) {
      const uint32_t symbol = next_symbol(bits);
      predictions_ = symbol & 15u;
      below_[x / 2] = symbol >> 4;
    } else {
      predictions_ = below_[x / 2];
    }
  }

  uint32_t next_symbol(BitReader& bits) {
    constexpr uint32_t kRepeat = 256;
    constexpr uint64_t kMinRepeats = 3;
    if (repeats_ > 0) {
      --repeats_;
      return symbol_;
    }
    const uint32_t symbol = tables_.endpoint_prediction.decode(bits);
    if (symbol > kRepeat) bits.fail("the endpoint of a block has an unknown prediction");
    if (symbol == kRepeat) {
      repeats_ = read_number(bits, 4) + kMinRepeats - 1;
    } else {
      symbol_ = symbol;
    }
    return symbol_;
  }

  uint32_t predict(uint32_t prediction, size_t x, size_t y, BitReader& bits) {
    if (prediction == kDelta) {
      uint32_t index = previous_ + tables_.endpoint_delta.decode(bits);
      if (index >= endpoint_count_) index -= endpoint_count_;
      if (index >= endpoint_count_) bits.fail("a block refers to an endpoint that does not exist");
      return index;
    }
    const bool needs_left = prediction != kAbove;
    const bool needs_above = prediction != kLeft;
    if ((needs_left && x == 0) || (needs_above && y == 0)) bits.fail("a block refers to a block outside the image");
    if (prediction == kLeft) return previous_;
    return row_above_[prediction == kAbove ? x : x - 1];
  }

  const Etc1sTables& tables_;
  uint32_t endpoint_count_;
  std::vector<uint32_t> row_;        ///< endpoints of the current row of blocks
  std::vector<uint32_t> row_above_;  ///< endpoints of the row above
  std::vector<uint32_t> below_;      ///< predictions of the lower blocks of each group
  uint32_t predictions_ = 0;         ///< of the remaining blocks in this row of a group
  uint32_t symbol_ = 0;              ///< predictions of the last group
  uint64_t repeats_ = 0;             ///< number of groups that repeat `symbol_`
  uint32_t previous_ = 0;            ///< endpoint of the previous block
};

/// Decodes the selector of each block.
class SelectorIndices {
 public:
  explicit SelectorIndices(const Etc1sGlobalData& global)
      : tables_(global.tables), selector_count_(global.selectors.size()), history_(global.tables.history_size) {}

  uint32_t next(BitReader& bits) {
    const uint32_t symbol = next_symbol(bits);
    if (symbol < selector_count_) {
      history_.add(symbol);
      return symbol;
    }
    const size_t index = symbol - selector_count_;
    if (index >= history_.size()) bits.fail("a block refers to a selector that does not exist");
    return history_.use(index);
  }

 private:
  /// Returns a selector, or the number of selectors plus an index in the history.
  uint32_t next_symbol(BitReader& bits) {
    constexpr uint64_t kMinRun = 3;
    constexpr uint32_t kLongRun = 63;
    const auto first_of_history = static_cast<uint32_t>(selector_count_);
    if (run_ > 0) {
      --run_;
      return first_of_history;
    }
    const uint32_t symbol = tables_.selector.decode(bits);
    if (symbol != first_of_history + history_.size()) return symbol;
    const uint32_t length = tables_.selector_run.decode(bits);
    run_ = (length == kLongRun ? read_number(bits, 7) : length) + kMinRun - 1;
    return first_of_history;
  }

  const Etc1sTables& tables_;
  size_t selector_count_;
  SelectorHistory history_;
  uint64_t run_ = 0;  ///< remaining blocks that use the front of the history
};

/// Writes the texels of a block that are inside the image.
void paint_block(const Etc1sEndpoint& endpoint, const Etc1sSelector& selector, size_t left, size_t top, size_t width,
                 size_t height, std::vector<uint8_t>& rgb) {
  for (size_t y = 0; y < 4 && top + y < height; ++y) {
    uint8_t* texel = &rgb[3 * ((top + y) * width + left)];
    for (size_t x = 0; x < 4 && left + x < width; ++x) {
      const int modifier = kModifiers[endpoint.intensity][(selector[y] >> (2 * x)) & 3u];
      for (size_t c = 0; c < 3; ++c) {
        const int base = endpoint.color[c] << 3 | endpoint.color[c] >> 2;
        *texel++ = static_cast<uint8_t>(std::clamp(base + modifier, 0, 255));
      }
    }
  }
}

}  // namespace

std::vector<uint8_t> decode_etc1s_slice(std::span<const std::byte> bytes, size_t width, size_t height,
                                        const Etc1sGlobalData& global, const std::string& name) {
  BitReader bits(bytes, name);
  if (global.endpoints.empty() || global.selectors.empty()) bits.fail("its codebooks are empty");
  const size_t blocks_x = (width + 3) / 4;
  const size_t blocks_y = (height + 3) / 4;
  EndpointIndices endpoints(blocks_x, global);
  SelectorIndices selectors(global);
  std::vector<uint8_t> rgb(3 * width * height);
  for (size_t y = 0; y < blocks_y; ++y) {
    for (size_t x = 0; x < blocks_x; ++x) {
      const Etc1sEndpoint& endpoint = global.endpoints[endpoints.next(x, y, bits)];
      paint_block(endpoint, global.selectors[selectors.next(bits)], 4 * x, 4 * y, width, height, rgb);
    }
  }
  return rgb;
}

}  // namespace relume::detail
