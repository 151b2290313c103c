// KTX File Format Specification 2.0, appendix "BasisLZ/ETC1S Bitstream".
#include "image/ktx2/etc1s_codebooks.h"

namespace relume::detail {
namespace {

/// Codes of differences between 5-bit channels, selected by the previous value.
class ColorDeltas {
 public:
  explicit ColorDeltas(BitReader& bits)
      : low_(HuffmanTable::read(bits)), middle_(HuffmanTable::read(bits)), high_(HuffmanTable::read(bits)) {}

  uint8_t next(uint8_t previous, BitReader& bits) const {
    constexpr uint8_t kLastLow = 9;
    constexpr uint8_t kLastMiddle = 21;
    const HuffmanTable& table = previous <= kLastLow ? low_ : previous <= kLastMiddle ? middle_ : high_;
    return static_cast<uint8_t>((previous + table.decode(bits)) & 31u);
  }

 private:
  HuffmanTable low_;
  HuffmanTable middle_;
  HuffmanTable high_;
};

}  // namespace

std::vector<Etc1sEndpoint> read_etc1s_endpoints(std::span<const std::byte> bytes, size_t count,
                                                const std::string& name) {
  BitReader bits(bytes, name);
  const ColorDeltas color_deltas(bits);
  const HuffmanTable intensity_deltas = HuffmanTable::read(bits);
  const bool is_grey = bits.read(1) != 0;
  std::vector<Etc1sEndpoint> endpoints(count);
  Etc1sEndpoint previous{{16, 16, 16}, 0};
  for (Etc1sEndpoint& endpoint : endpoints) {
    endpoint.intensity = static_cast<uint8_t>((previous.intensity + intensity_deltas.decode(bits)) & 7u);
    for (size_t c = 0; c < 3; ++c)
      endpoint.color[c] = is_grey && c > 0 ? endpoint.color[0] : color_deltas.next(previous.color[c], bits);
    previous = endpoint;
  }
  return endpoints;
}

std::vector<Etc1sSelector> read_etc1s_selectors(std::span<const std::byte> bytes, size_t count,
                                                const std::string& name) {
  BitReader bits(bytes, name);
  if (bits.read(2) != 0) bits.fail("the selectors of its blocks have an unknown encoding");
  const bool is_raw = bits.read(1) != 0;
  std::vector<Etc1sSelector> selectors(count);
  if (is_raw) {
    for (Etc1sSelector& selector : selectors) {
      for (uint8_t& row : selector) row = static_cast<uint8_t>(bits.read(8));
    }
    return selectors;
  }
  const HuffmanTable deltas = HuffmanTable::read(bits);
  for (size_t i = 0; i < count; ++i) {
    for (size_t y = 0; y < 4; ++y)
      selectors[i][y] = static_cast<uint8_t>(i == 0 ? bits.read(8) : deltas.decode(bits) ^ selectors[i - 1][y]);
  }
  return selectors;
}

Etc1sTables read_etc1s_tables(std::span<const std::byte> bytes, const std::string& name) {
  BitReader bits(bytes, name);
  // Members of a braced list are evaluated in order.
  return {HuffmanTable::read(bits), HuffmanTable::read(bits), HuffmanTable::read(bits), HuffmanTable::read(bits),
          bits.read(13)};
}

}  // namespace relume::detail
