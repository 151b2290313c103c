// The octree as a pass, ahead of those that learn in its regions.
#pragma once

#include <optional>

#include "frame/pass.h"
#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/spatial/octree/settings.h"
#include "techniques/spatial/octree/snapshot.h"

namespace relume {

/// Thresholds for so many pixels: given for 1920 × 1080 with two records a pixel, and scaled with both. Below 1024
/// samples a region learns too little, so the scaled ones stop there.
OctreeThresholds thresholds_of(const OctreeSettings& settings, uint32_t pixels);

/// Groups the last frame's samples by region and makes the next tree from their numbers. Passes behind it build what
/// the regions of the *previous* tree hold from the groups, and hand it on to the new one.
class OctreePass final : public Pass {
 public:
  /// `epochs`: several frames may sample with the same tree, as a history adds them up.
  OctreePass(const OctreeSettings& settings, bool epochs) : settings_(settings), epochs_(epochs) {}

  void configure(const OctreeSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "octree", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override { prepared_ = true; }
  uint32_t longest_epoch() const override { return epochs_ ? static_cast<uint32_t>(settings_.longest_epoch) : 1; }
  size_t memory_bytes() const override;
  std::vector<PassStatistic> statistics() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Whether this frame was begun before and abandoned: tree() has taken in the samples of the last complete frame
  /// already, and so has what regions hold.
  bool begins_again() const { return begins_again_; }
  /// Whether the last frame left samples: previous() and groups() are valid.
  bool has_samples() const { return previous_.has_value(); }
  const OctreeTree& previous() const { return *previous_; }
  SampleGroupsView groups() const { return stream_.groups(); }
  /// The tree whose regions this frame's samples belong to.
  const OctreeTree& tree() const { return *tree_; }
  /// The tree whose regions this frame samples with: that of the first frame of the epoch.
  const OctreeTree& sampled() const { return snapshot_.of(*tree_); }
  /// Where this frame's paths leave samples.
  const PathRecording& recording() const { return recording_; }
  View<const VertexSample> samples() const { return {recording_.samples.data, recording_.samples.size}; }
  /// Level of each leaf of this frame's tree.
  View<const uint8_t> depths() const { return view_of(depths_); }

 private:
  void adapt(const FrameContext& frame);

  OctreeSettings settings_;
  bool epochs_;
  bool prepared_ = false;  ///< for the next frame
  bool begins_again_ = false;
  std::optional<OctreeTree> tree_;
  Snapshot<OctreeTree> snapshot_;
  std::optional<OctreeTree> previous_;
  SampleStream stream_;
  PathRecording recording_;
  std::vector<uint8_t> depths_;
};

inline constexpr BufferKey<uint32_t> kRegion{"region"};
inline constexpr BufferKey<uint32_t> kRegionDepth{"region-depth"};

/// Fills buffers that show the regions.
class RegionViewPass final : public Pass {
 public:
  explicit RegionViewPass(const OctreePass& octree) : octree_(octree) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  const OctreePass& octree_;
};

}  // namespace relume
