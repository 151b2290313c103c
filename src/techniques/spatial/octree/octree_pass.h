// The octree as a pass, which runs before the passes that adapt to its regions.
#pragma once

#include <optional>

#include "frame/pass.h"
#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/spatial/octree/settings.h"
#include "techniques/spatial/octree/snapshot.h"
#include "techniques/spatial/octree/useful_samples.h"

namespace relume {

/// Thresholds for an image of `pixels` pixels. The settings apply to 1920 × 1080 pixels with two records each, and
/// `scale` scales them with the number of records. Regions of fewer than 1024 samples adapt poorly, so scaling does
/// not lower `split` below that. Numbers of useful records have thresholds without a scale.
OctreeThresholds thresholds_of(const OctreeSettings& settings, uint32_t pixels);

/// Groups the last frame's samples by region and builds the next tree from their numbers. Later passes update the data
/// of the *previous* tree's regions from the groups and copy it to the new tree.
class OctreePass final : public Pass {
 public:
  /// `epochs`: several frames may sample the same tree, because a history accumulates them.
  OctreePass(const OctreeSettings& settings, bool epochs, Memory& memory)
      : settings_(settings),
        epochs_(epochs),
        memory_(memory),
        scratch_(memory),
        stream_(memory),
        useful_(memory),
        depths_(memory) {}

  void configure(const OctreeSettings& settings) { settings_ = settings; }
  /// Sets which records the passes of this pipeline learn from.
  void configure(const RecordUsers& users) { users_ = users; }
  PassDeclaration declaration() const override { return {.name = "octree", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override { prepared_ = has_taken_samples_; }
  uint32_t longest_epoch() const override { return epochs_ ? static_cast<uint32_t>(settings_.longest_epoch) : 1; }
  size_t memory_bytes() const override;
  std::vector<PassStatistic> statistics() const override;
  std::vector<PassRecords> records() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Number of trees so far. A frame that repeats an abandoned one keeps the tree if that already includes the samples
  /// of the last complete frame. Later passes store the number for which they made their data: if it differs, the data
  /// lack these samples.
  uint64_t generation() const { return generation_; }
  /// Whether the last frame recorded samples: previous() and groups() are valid.
  bool has_samples() const { return previous_.has_value(); }
  const OctreeTree& previous() const { return *previous_; }
  SampleGroupsView groups() const { return stream_.groups(); }
  /// Whether camera subpaths record where importance arrives.
  bool records_importance() const { return users_.importance; }
  /// The tree in which this frame's samples are recorded.
  const OctreeTree& tree() const { return *tree_; }
  /// The tree from which this frame's paths take estimates: that of the epoch's first frame.
  const OctreeTree& sampled() const { return snapshot_.of(*tree_); }
  /// Records of this frame's paths.
  const PathRecording& recording() const { return recording_; }
  View<const VertexSample> samples() const { return {recording_.samples.data, recording_.samples.size}; }
  /// Depth of each leaf of tree(), by slot.
  View<const uint8_t> depths() const { return depths_.view(); }

 private:
  void adapt(const FrameContext& frame);
  /// Number of records that count, by leaf slot of the tree.
  View<const uint32_t> counts(const FrameContext& frame);

  OctreeSettings settings_;
  RecordUsers users_;
  bool epochs_;
  Memory& memory_;
  bool prepared_ = false;           ///< whether the tree is already that of the next frame
  bool has_taken_samples_ = false;  ///< whether the tree includes the samples of the last complete frame
  uint64_t generation_ = 0;
  std::optional<OctreeTree> tree_;
  Snapshot<OctreeTree> snapshot_;
  std::optional<OctreeTree> previous_;
  OctreeScratch scratch_;
  SampleStream stream_;
  Array<uint32_t> useful_;  ///< number of useful records by leaf slot
  PathRecording recording_;
  Array<uint8_t> depths_;
};

inline constexpr BufferKey<uint32_t> kRegion{"region"};
inline constexpr BufferKey<uint32_t> kRegionDepth{"region-depth"};

/// Writes the layers `region` and `region-depth`.
class RegionViewPass final : public Pass {
 public:
  explicit RegionViewPass(const OctreePass& octree) : octree_(octree) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  const OctreePass& octree_;
};

}  // namespace relume
