// Reprojection as two passes: one moves histories, the other stores this frame's samples.
#pragma once

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/temporal/reprojection/look_back.h"
#include "techniques/temporal/reprojection/settings.h"
#include "techniques/temporal/reprojection/stored_sample.h"

namespace relume {

// Result by pixel. The declaration lists the values.
inline constexpr BufferKey<uint32_t> kHistoryKept{"history-kept"};
inline constexpr BufferKey<uint32_t> kHistoryReason{"history-reason"};
inline constexpr BufferKey<uint32_t> kHistoryRejectReason{"history-reject-reason"};

/// Contents of the histories besides mean, variance and count.
struct HistoryContents {
  bool m2_rgb = false;          ///< this member of the moments
  bool cells = false;           ///< a separate mean of the part from a radiance cache (forward)
  bool light_points = false;    ///< light samples of reservoirs in place of random numbers (forward)
  bool splats_apart = false;    ///< directions of splats beside the light of cells (forward)
  bool indirect_apart = false;  ///< indirect light of reservoirs, which cells lack (forward)
};

/// Moves the moments of pixels, and all buffers that follow surfaces, to the surfaces' pixels in this frame. Changes of
/// materials or settings end all histories.
class ReprojectionPass final : public Pass {
 public:
  /// `pixel_count`: pixels of the image, which a checkpoint must match.
  ReprojectionPass(const ReprojectionSettings& settings, uint32_t pixel_count, const HistoryContents& contents,
                   Memory& memory);

  void configure(const ReprojectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  void abandon() override;
  size_t memory_bytes() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Stored samples, for StoreSamplesPass.
  View<StoredSample> stored() { return stored_.mutable_view(); }
  View<StoredPixel> pixels() { return pixels_.mutable_view(); }
  uint32_t capacity() const { return capacity_; }

 private:
  bool looks_back() const;
  /// Whether pixels without a vote look back in this frame.
  bool fills(const FrameContext& frame) const;
  void allocate(const FrameContext& frame);
  void drop_unknown(const FrameContext& frame);
  /// All pixels keep their own histories, or start without any.
  void stay(const FrameContext& frame);
  /// `sources`: see MoveMomentsKernel.
  void move_moments(const FrameContext& frame, View<const uint32_t> sources) const;
  void run_forward(const FrameContext& frame);
  void vote_for_pixels(const FrameContext& frame);
  void take_over(const FrameContext& frame);
  LookBack look_back(const FrameContext& frame) const;
  void fill(const FrameContext& frame) const;
  void move_cells(const FrameContext& frame) const;
  void mark_covered(const FrameContext& frame);
  void run_backward(const FrameContext& frame);
  void move(const FrameContext& frame, Buffer& buffer);
  void limit(const FrameContext& frame) const;
  /// Marks all pixels as kept, or as without a history.
  void set_all(const FrameContext& frame, bool kept) const;

  ReprojectionSettings settings_;
  const uint32_t pixel_count_;
  const HistoryContents contents_;
  uint32_t capacity_ = 0;
  bool loaded_ = false;  ///< stored samples come from a checkpoint and are not yet checked
  bool moved_ = false;   ///< stored samples moved in this frame
  bool rests_ = false;   ///< nothing has moved since the previous frame, and the buffers mark all pixels as kept
  Array<StoredSample> stored_;
  Array<StoredPixel> pixels_;
  Array<StoredSample> stored_before_;
  Array<StoredPixel> pixels_before_;
  Array<uint64_t> votes_;
  Array<uint32_t> sources_;
  Array<uint32_t> owned_;
  Array<uint32_t> limits_;         ///< maximum sample count of each history
  Array<uint32_t> limits_before_;  ///< the same by pixel of the previous frame
  Array<uint32_t> before_;         ///< copy of the buffer being moved
};

/// Stores this frame's samples. Runs before AccumulatePass.
class StoreSamplesPass final : public Pass {
 public:
  StoreSamplesPass(const ReprojectionSettings& settings, ReprojectionPass& history)
      : settings_(settings), history_(history) {}

  void configure(const ReprojectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool commits() const override { return true; }

 private:
  ReprojectionSettings settings_;
  ReprojectionPass& history_;
};

}  // namespace relume
