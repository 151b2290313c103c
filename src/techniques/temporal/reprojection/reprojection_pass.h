// The history "reproject" as two passes: one that takes the past along, one that remembers the present.
#pragma once

#include <vector>

#include "frame/pass.h"
#include "techniques/temporal/reprojection/look_back.h"
#include "techniques/temporal/reprojection/settings.h"
#include "techniques/temporal/reprojection/stored_sample.h"

namespace relume {

// Whether histories were kept. The declaration lists the values.
inline constexpr BufferKey<uint32_t> kHistoryKept{"history-kept"};
inline constexpr BufferKey<uint32_t> kHistoryReason{"history-reason"};
inline constexpr BufferKey<uint32_t> kHistoryRejectReason{"history-reject-reason"};

/// Moves the moments of pixels, and every buffer that follows the surface, to where the surface is in this frame. No
/// history survives a change of materials or settings.
class ReprojectionPass final : public Pass {
 public:
  /// `pixel_count`: of the image; a checkpoint must agree. `m2_rgb`: this member of the moments is kept, too.
  ReprojectionPass(const ReprojectionSettings& settings, uint32_t pixel_count, bool m2_rgb)
      : settings_(settings), pixel_count_(pixel_count), m2_rgb_(m2_rgb) {}

  void configure(const ReprojectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  void abandon() override;
  size_t memory_bytes() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// What pixels have stored; for the pass that adds to it.
  std::vector<StoredSample>& stored() { return stored_; }
  std::vector<StoredPixel>& pixels() { return pixels_; }
  uint32_t capacity() const { return capacity_; }

 private:
  bool looks_back() const;
  /// Whether pixels to which nothing came look back in this frame.
  bool fills(const FrameContext& frame) const;
  void allocate(const FrameContext& frame);
  void drop_unknown(const SceneView& scene);
  /// Pixels keep their own histories, or start without any.
  void stay(const FrameContext& frame);
  /// `sources`: see MoveMomentsKernel.
  void move_moments(const FrameContext& frame, View<const uint32_t> sources) const;
  void run_forward(const FrameContext& frame);
  void vote_for_pixels(const FrameContext& frame);
  void take_over(const FrameContext& frame);
  LookBack look_back(const FrameContext& frame) const;
  void fill(const FrameContext& frame) const;
  void mark_covered(const FrameContext& frame);
  void run_backward(const FrameContext& frame);
  void move(const FrameContext& frame, Buffer& buffer);
  void limit(const FrameContext& frame) const;
  /// For all pixels: they continue their own histories, or start without any.
  void set_all(const FrameContext& frame, bool kept) const;

  ReprojectionSettings settings_;
  const uint32_t pixel_count_;
  const bool m2_rgb_;
  uint32_t capacity_ = 0;
  bool loaded_ = false;  ///< from a file, and not looked through yet
  bool moved_ = false;   ///< stored samples, in this frame
  bool rests_ = false;   ///< nothing has moved since the last frame, and the buffers say that all go on
  std::vector<StoredSample> stored_;
  std::vector<StoredPixel> pixels_;
  std::vector<StoredSample> stored_before_;
  std::vector<StoredPixel> pixels_before_;
  std::vector<uint64_t> votes_;
  std::vector<uint32_t> sources_;
  std::vector<uint32_t> owned_;
  std::vector<uint32_t> limits_;         ///< samples that each history may count for
  std::vector<uint32_t> limits_before_;  ///< the same where the pixels were
  std::vector<std::byte> before_;        ///< the buffer that is being moved
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
