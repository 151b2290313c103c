#include "techniques/spatial/markov_grid/markov_records.h"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "frame/launch.h"
#include "techniques/spatial/markov_grid/markov_cells.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

struct Number {
  uint32_t value = 0;
  float weight = 0;

  bool operator==(const Number&) const = default;
};

constexpr uint32_t kSlots = 200;
constexpr uint32_t kRecords = 3000;

std::vector<MarkovRecord<Number>> random_records(uint32_t seed) {
  testing::Random random(seed);
  std::vector<MarkovRecord<Number>> records(kRecords);
  for (uint32_t i = 0; i < kRecords; ++i) {
    records[i].state = {i + 1, 1};
    if (random.next() < 0.2f) continue;  // no cells
    for (MarkovCell& cell : records[i].cells) cell = {random.next_bits() % kSlots, random.next_bits()};
  }
  records[0].cells[0].slot = kSlots;  // out of range, as after a change of the table's size
  return records;
}

struct Table {
  std::vector<uint64_t> winners = std::vector<uint64_t>(kSlots, MarkovPriority::kNone);
  std::vector<MarkovSlot<Number>> slots = std::vector<MarkovSlot<Number>>(kSlots);

  /// Takes the records in the order `place(i)`.
  template <typename Place>
  void take(const std::vector<MarkovRecord<Number>>& records, const MarkovPriority& priority, const Place& place) {
    const ElectWritersKernel<Number> elect{view_of(records), mutable_view_of(winners), priority};
    for (uint32_t i = 0; i < kRecords; ++i) elect(place(i), 0);
    const WriteStatesKernel<Number> write{view_of(records), view_of(winners), mutable_view_of(slots), priority};
    for (uint32_t i = 0; i < kRecords; ++i) write(place(i), 0);
  }
};

TEST(MarkovRecords, TheOrderOfThreadsDoesNotMatter) {
  const auto records = random_records(3);
  const auto forward = [](uint32_t i) { return i; };
  const auto backward = [](uint32_t i) { return kRecords - 1 - i; };
  Table a;
  Table b;
  for (uint32_t stamp = 1; stamp < 4; ++stamp) {
    a.take(records, {stamp, 9 * stamp}, forward);
    b.take(records, {stamp, 9 * stamp}, backward);
    for (uint32_t i = 0; i < kSlots; ++i) {
      ASSERT_EQ(a.slots[i].state, b.slots[i].state);
      ASSERT_EQ(a.slots[i].check, b.slots[i].check);
    }
  }
}

TEST(MarkovRecords, CellsTakeARecordOfTheLatestFrame) {
  const auto records = random_records(3);
  Table table;
  const auto forward = [](uint32_t i) { return i; };
  table.take(records, {1, 5}, forward);
  auto later = random_records(4);
  for (MarkovRecord<Number>& record : later) record.state.value += kRecords;
  table.take(later, {MarkovPriority::kMostStamp, 5}, forward);
  for (uint32_t slot = 0; slot < kSlots; ++slot) {
    // 3,000 records for 200 slots: each has one.
    const uint32_t value = table.slots[slot].state.value;
    ASSERT_GT(value, kRecords);
    const MarkovRecord<Number>& record = later[value - kRecords - 1];
    EXPECT_TRUE((record.cells[0].slot == slot && record.cells[0].check == table.slots[slot].check) ||
                (record.cells[1].slot == slot && record.cells[1].check == table.slots[slot].check));
  }
}

TEST(MarkovRecords, AllRecordsOfACellWinEquallyOften) {
  constexpr uint32_t kRivals = 16;
  constexpr uint32_t kFrames = 8000;
  std::vector<uint64_t> wins(kRivals);
  for (uint32_t frame = 0; frame < kFrames; ++frame) {
    const MarkovPriority priority{1, hash(frame)};
    uint32_t best = 0;
    for (uint32_t i = 1; i < kRivals; ++i) {
      if (priority.key(1000 * i) < priority.key(1000 * best)) best = i;
    }
    ++wins[best];
  }
  const std::vector<double> expected(kRivals, double{kFrames} / kRivals);
  EXPECT_GT(testing::chi2_test(wins, expected).p_value, testing::significance());
}

TEST(MarkovCells, RejectsCheckpointsWithOtherSizes) {
  MarkovCells<Number> empty("test", host_memory());
  std::stringstream file;
  empty.save(file);
  const std::string text = file.str();
  MarkovCells<Number> loaded("test", host_memory());
  std::stringstream whole(text);
  loaded.load(whole);
  EXPECT_TRUE(static_cast<bool>(whole));
  std::stringstream part(text.substr(0, text.size() - 1));
  loaded.load(part);
  EXPECT_FALSE(static_cast<bool>(part));
  std::string more_slots = text;
  more_slots[0] = 1;  // adaptive slots that the table lacks
  std::stringstream wrong(more_slots);
  loaded.load(wrong);
  EXPECT_FALSE(static_cast<bool>(wrong));
}

}  // namespace
}  // namespace relume
