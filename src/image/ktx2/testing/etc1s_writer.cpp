#include "image/ktx2/testing/etc1s_writer.h"

#include <algorithm>

#include "image/ktx2/testing/huffman_writer.h"

namespace relume::testing {
namespace {

enum Table : size_t { kPrediction, kDelta, kSelector, kSelectorRun, kTables };

/// A symbol of a table, or bits without a code.
struct Field {
  size_t table = kTables;
  uint32_t value = 0;
  size_t raw_bits = 0;
};

/// Splits a number into groups of bits, the lowest first. A bit after each group is set if another one follows.
void append_number(uint64_t number, size_t group_bits, std::vector<Field>& fields) {
  const uint64_t more = uint64_t{1} << group_bits;
  do {
    const uint64_t group = number % more;
    number /= more;
    fields.push_back({kTables, static_cast<uint32_t>(group + (number > 0 ? more : 0)), group_bits + 1});
  } while (number > 0);
}

/// Converts the blocks of an image to fields.
class SliceWriter {
 public:
  SliceWriter(const Etc1sCodebooks& codebooks, const Etc1sBlocks& image, Etc1sStatistics& statistics)
      : codebooks_(codebooks), image_(image), statistics_(statistics), history_(codebooks.history_size) {
    next_ = history_.size() / 2;
  }

  std::vector<Field> fields() {
    for (size_t y = 0; y < image_.height; y += 2) {
      for (size_t x = 0; x < image_.width; x += 2) groups_.push_back(group_at(x, y));
    }
    for (size_t y = 0; y < image_.height; ++y) {
      for (size_t x = 0; x < image_.width; ++x) append_block(x, y);
    }
    return std::move(fields_);
  }

 private:
  size_t index(size_t x, size_t y) const { return y * image_.width + x; }
  uint32_t endpoint(size_t x, size_t y) const { return image_.endpoints[index(x, y)]; }

  uint32_t prediction_at(size_t x, size_t y) const {
    if (x >= image_.width || y >= image_.height) return 0;
    if (x > 0 && endpoint(x - 1, y) == endpoint(x, y)) return 0;
    if (y > 0 && endpoint(x, y - 1) == endpoint(x, y)) return 1;
    if (x > 0 && y > 0 && endpoint(x - 1, y - 1) == endpoint(x, y)) return 2;
    return 3;
  }

  uint32_t group_at(size_t x, size_t y) const {
    return prediction_at(x, y) | prediction_at(x + 1, y) << 2 | prediction_at(x, y + 1) << 4 |
           prediction_at(x + 1, y + 1) << 6;
  }

  void append_block(size_t x, size_t y) {
    if (x % 2 == 0 && y % 2 == 0) append_group();
    const uint32_t prediction = prediction_at(x, y);
    ++statistics_.predictions[prediction];
    if (prediction == 3) {
      const auto count = static_cast<uint32_t>(codebooks_.endpoints.size());
      fields_.push_back({kDelta, (endpoint(x, y) + count - previous_) % count});
    }
    previous_ = endpoint(x, y);
    append_selector(index(x, y));
  }

  /// Appends the predictions of the next group, or a run of groups that repeat the last one.
  void append_group() {
    const size_t i = group_++;
    if (i < run_end_) return;
    size_t run = 0;
    while (i + run < groups_.size() && groups_[i + run] == last_group_) ++run;
    if (run >= 3) {
      ++statistics_.prediction_runs;
      fields_.push_back({kPrediction, 256});
      append_number(run - 3, 4, fields_);
      run_end_ = i + run;
    } else {
      fields_.push_back({kPrediction, groups_[i]});
      last_group_ = groups_[i];
    }
  }

  void append_selector(size_t block) {
    if (block < selector_run_end_) return;
    const std::vector<uint32_t>& selectors = image_.selectors;
    const uint32_t selector = selectors[block];
    const auto count = static_cast<uint32_t>(codebooks_.selectors.size());
    size_t run = 0;
    while (!history_.empty() && block + run < selectors.size() && selectors[block + run] == history_[0]) ++run;
    if (run >= 3) {
      append_selector_run(run);
      selector_run_end_ = block + run;
      return;
    }
    const auto found = std::find(history_.begin(), history_.end(), selector);
    if (found == history_.end()) {
      ++statistics_.new_selectors;
      fields_.push_back({kSelector, selector});
      if (history_.empty()) return;
      history_[next_] = selector;
      next_ = next_ + 1 == history_.size() ? history_.size() / 2 : next_ + 1;
    } else {
      ++statistics_.old_selectors;
      const auto place = static_cast<size_t>(found - history_.begin());
      fields_.push_back({kSelector, count + static_cast<uint32_t>(place)});
      std::swap(history_[place], history_[place / 2]);
    }
  }

  void append_selector_run(size_t run) {
    constexpr uint64_t kLong = 63;
    ++statistics_.selector_runs;
    fields_.push_back({kSelector, static_cast<uint32_t>(codebooks_.selectors.size() + history_.size())});
    fields_.push_back({kSelectorRun, static_cast<uint32_t>(std::min<uint64_t>(run - 3, kLong))});
    if (run - 3 < kLong) return;
    ++statistics_.long_selector_runs;
    append_number(run - 3, 7, fields_);
  }

  const Etc1sCodebooks& codebooks_;
  const Etc1sBlocks& image_;
  Etc1sStatistics& statistics_;
  std::vector<uint32_t> history_;
  size_t next_ = 0;
  std::vector<uint32_t> groups_;
  uint32_t last_group_ = 0;
  size_t group_ = 0;
  size_t run_end_ = 0;           ///< groups before this one are already written
  size_t selector_run_end_ = 0;  ///< blocks before this one are already written
  uint32_t previous_ = 0;
  std::vector<Field> fields_;
};

/// Writes a list of fields with the tables built for them.
std::vector<std::byte> write_fields(const std::vector<Field>& fields,
                                    const std::array<HuffmanWriter, kTables>& tables) {
  BitWriter bits;
  for (const Field& field : fields) {
    if (field.table == kTables) {
      bits.put(field.value, field.raw_bits);
    } else {
      tables[field.table].write(field.value, bits);
    }
  }
  return bits.bytes();
}

size_t color_table(uint8_t previous) { return previous < 10 ? 0 : previous < 22 ? 1 : 2; }

}  // namespace

std::vector<std::byte> write_etc1s_endpoints(const std::vector<detail::Etc1sEndpoint>& endpoints, bool grey) {
  std::array<HuffmanWriter, 4> tables;
  BitWriter bits;
  const auto visit = [&](const auto& write) {
    detail::Etc1sEndpoint previous{{16, 16, 16}, 0};
    for (const detail::Etc1sEndpoint& endpoint : endpoints) {
      write(3, (endpoint.intensity - previous.intensity) & 7);
      for (size_t c = 0; c < (grey ? 1u : 3u); ++c)
        write(color_table(previous.color[c]), (endpoint.color[c] - previous.color[c]) & 31);
      previous = endpoint;
    }
  };
  visit([&](size_t table, int symbol) { tables[table].count(static_cast<uint32_t>(symbol)); });
  for (HuffmanWriter& table : tables) table.write_table(bits);
  bits.put(grey ? 1 : 0, 1);
  visit([&](size_t table, int symbol) { tables[table].write(static_cast<uint32_t>(symbol), bits); });
  return bits.bytes();
}

std::vector<std::byte> write_etc1s_selectors(const std::vector<detail::Etc1sSelector>& selectors, bool raw) {
  BitWriter bits;
  bits.put(raw ? 4 : 0, 3);
  HuffmanWriter deltas;
  const auto visit = [&](const auto& write) {
    for (size_t i = 1; i < selectors.size(); ++i) {
      for (size_t y = 0; y < 4; ++y) write(static_cast<uint32_t>(selectors[i][y] ^ selectors[i - 1][y]));
    }
  };
  visit([&](uint32_t symbol) { deltas.count(symbol); });
  if (!raw) deltas.write_table(bits);
  for (size_t i = 0; i < (raw ? selectors.size() : 1); ++i) {
    for (const uint8_t row : selectors[i]) bits.put(row, 8);
  }
  if (!raw) visit([&](uint32_t symbol) { deltas.write(symbol, bits); });
  return bits.bytes();
}

Etc1sStreams write_etc1s(const Etc1sCodebooks& codebooks, const std::vector<Etc1sBlocks>& images) {
  Etc1sStreams streams;
  streams.endpoints = write_etc1s_endpoints(codebooks.endpoints, codebooks.grey);
  streams.selectors = write_etc1s_selectors(codebooks.selectors, codebooks.raw_selectors);
  std::vector<std::vector<Field>> slices;
  std::array<HuffmanWriter, kTables> tables;
  for (const Etc1sBlocks& image : images) {
    slices.push_back(SliceWriter(codebooks, image, streams.statistics).fields());
    for (const Field& field : slices.back()) {
      if (field.table != kTables) tables[field.table].count(field.value);
    }
  }
  BitWriter bits;
  for (HuffmanWriter& table : tables) table.write_table(bits);
  bits.put(codebooks.history_size, 13);
  streams.tables = bits.bytes();
  for (const std::vector<Field>& slice : slices) streams.slices.push_back(write_fields(slice, tables));
  return streams;
}

}  // namespace relume::testing
