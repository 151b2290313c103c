// Tests the records that reservoirs leave for the chains of light selection.
#include <vector>

#include <gtest/gtest.h>

#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/reuse/reservoir/candidate_stage.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

class ChainRecords : public ::testing::Test {
 protected:
  static constexpr LightId kLight = 1;

  ChainRecords() {
    receiver_.sp = testing::point_at({1, 0, 2}, Vec3(0, 1, 0));
    reservoir_.sample.light = kLight;
    reservoir_.target = 2;
    reservoir_.weight = 3;
  }

  MarkovRecord<LightState> record(bool visible) {
    std::vector<MarkovRecord<LightState>> records(1);
    LightChainRecording chains;
    chains.chains = {table_.grid, table_.view(), 0.2f};
    chains.tree = data_.view(scene_.lights());
    chains.out = {mutable_view_of(records), 1, 1};
    record_in_chains(chains, receiver_, reservoir_, visible, 0);
    return records[0];
  }

  testing::LightScene scene_ = testing::make_light_scene({});
  LightTreeData data_ = build_light_tree(scene_.lights());
  testing::FilledTable<LightState> table_;
  Receiver receiver_{};
  LightReservoir reservoir_;
};

TEST_F(ChainRecords, AVisibleSampleScoresItsEstimateOfTheLight) {
  const MarkovRecord<LightState> r = record(true);
  EXPECT_EQ(r.state.light, kLight);
  EXPECT_EQ(r.state.weight, 6.0f);
  EXPECT_EQ(r.state.count, 1u);
  EXPECT_NE(r.cells[0].slot, kNoSlot);
  EXPECT_NE(r.cells[1].slot, kNoSlot);
}

TEST_F(ChainRecords, AHiddenSampleFadesInItsCell) {
  EXPECT_EQ(record(false).cells[0].slot, kNoSlot) << "a light of the tree has no cell";
  table_.fill(receiver_.sp, [](uint32_t) { return LightState{kLight, 4, 1}; });
  const MarkovRecord<LightState> r = record(false);
  EXPECT_EQ(r.state.weight, 2.0f);  // the mean of 4 and 0
  EXPECT_EQ(table_.view().load(r.cells[0]).weight, 4.0f);
  EXPECT_EQ(r.cells[1].slot, kNoSlot);
}

}  // namespace
}  // namespace relume
