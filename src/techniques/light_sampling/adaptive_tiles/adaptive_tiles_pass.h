// The pass for the light selection "neeat", after the octree pass if there is one.
#pragma once

#include "frame/pass.h"
#include "techniques/light_sampling/adaptive_tiles/learned_tiles.h"
#include "techniques/light_sampling/adaptive_tiles/settings.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/spatial/octree/octree_pass.h"
#include "techniques/spatial/octree/snapshot.h"

namespace relume {

/// Builds lists and proxies from the feedback of the last frames' paths, and receives that of this frame's.
class AdaptiveTilesPass final : public Pass {
 public:
  /// `octree`: recording of guided paths; nullptr: none. `epochs`: several frames may choose from the same lists,
  /// because a history accumulates them.
  AdaptiveTilesPass(const AdaptiveTilesSettings& settings, const LightSelectionSettings& selection,
                    const OctreePass* octree, bool epochs, Memory& memory)
      : settings_(settings),
        selection_(selection),
        octree_(octree),
        epochs_(epochs),
        tiles_(memory),
        next_(memory),
        feedback_(memory),
        kept_(memory),
        counts_(memory),
        power_(memory) {
    selector_.kind = LightSelectorKind::adaptive_tiles;
  }

  void configure(const AdaptiveTilesSettings& settings) { settings_ = settings; }
  void configure(const LightSelectionSettings& selection) { selection_ = selection; }
  PassDeclaration declaration() const override { return {.name = "neeat", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override { prepared_ = has_taken_feedback_; }
  uint32_t longest_epoch() const override { return epochs_ ? static_cast<uint32_t>(settings_.longest_epoch) : 1; }
  size_t memory_bytes() const override;
  std::vector<PassStatistic> statistics() const override;
  std::vector<PassRecords> records() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Valid after the first run().
  const LightSelector& selector() const { return selector_; }
  /// Destination of the records of this frame's paths.
  const PathRecording& recording() const { return recording_; }

 private:
  /// Recomputes the power of lights if they have changed. Returns whether they have.
  bool update_lights(const FrameContext& frame);
  /// Clears what a damaged checkpoint left inconsistent.
  void drop_inconsistent(const FrameContext& frame);
  /// Whether the counts have the stored sum; false after damage. Reads them on the host.
  bool has_exact_counts(const FrameContext& frame) const;
  /// Adds the feedback of the frame before to that of the last frame.
  void keep_lights(const FrameContext& frame);
  /// Counts the lights in the feedback of the last frame.
  void count_lights(const FrameContext& frame);
  void fill_lists(const FrameContext& frame);
  void receive_feedback(const FrameContext& frame);
  void set_selector();
  /// Whether there is feedback of a frame of this size.
  bool has_feedback(const FrameContext& frame) const { return feedback_.size() == frame.pixels(); }

  AdaptiveTilesSettings settings_;
  LightSelectionSettings selection_;
  const OctreePass* octree_;
  bool epochs_;
  LightSelector selector_;
  PathRecording recording_;
  LearnedTiles tiles_;
  LearnedTiles next_;  ///< lists under construction
  Snapshot<LearnedTiles> snapshot_;
  Array<LightFeedback> feedback_;  ///< by pixel, of the last frame until receive_feedback()
  CameraView feedback_camera_ = {};
  Array<LightFeedback> kept_;  ///< by pixel, of the frame before; of the last frame after receive_feedback()
  CameraView kept_camera_ = {};
  Array<uint32_t> counts_;  ///< use by light in the feedback that the lists include
  uint32_t used_ = 0;       ///< sum of the counts
  Array<AliasEntry> power_;
  PrimitiveScratch scratch_;
  bool prepared_ = false;            ///< whether the lists already include the feedback of the last complete frame
  bool has_taken_feedback_ = false;  ///< the same, within a frame
  bool merged_ = false;              ///< whether `feedback_` includes `kept_`
  bool loaded_ = false;              ///< whether a loaded checkpoint is still unchecked
  bool built_ = false;               ///< whether the power of lights is complete
};

}  // namespace relume
