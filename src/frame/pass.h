// A pass: one step of a frame. It says which buffers it owns, reads and writes, and is run once a frame, in the order
// of the stages (docs/architecture.md).
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "frame/frame_context.h"
#include "relume/statistics.h"

namespace relume {

/// Steps of a frame, in their order. The pass list keeps the order within a stage.
enum class Stage : uint8_t {
  prepare,       ///< structures from the scene and from what earlier frames sampled
  hits,          ///< primary hits of every pixel
  gbuffer,       ///< surfaces at the primary hits
  history,       ///< what earlier frames know of this frame's pixels
  allocate,      ///< how many paths each pixel gets
  sampled_hits,  ///< primary hits of these paths only, where no pass reads the others
  trace,         ///< the paths
  resolve,       ///< caches turn samples into pixels
  present,       ///< samples join the history
  denoise,       ///< filters over the image
};

struct PassDeclaration {
  std::string_view name;  ///< kebab-case; what timings and messages call it
  Stage stage = Stage::trace;
  std::vector<BufferDescription> owns = {};  ///< buffers that it brings along and writes
  std::vector<BufferId> reads = {};          ///< buffers of passes before it, or of the frame before
  std::vector<BufferId> writes = {};         ///< buffers of others that it changes
  std::vector<BufferId> reads_if_any = {};   ///< as `reads`, where some pass owns them
  std::vector<BufferId> writes_if_any = {};  ///< as `writes`, where some pass owns them
  bool moves_surfaces = false;               ///< writes every buffer that follows the surface
  bool only_sampled_pixels = false;          ///< reads no pixel without a sample in this frame
};

class Pass {
 public:
  virtual ~Pass() = default;

  virtual PassDeclaration declaration() const = 0;

  /// Does its part of the frame. False if `frame.stop` was requested first; the frame is then abandoned.
  virtual bool run(const FrameContext& frame) = 0;

  /// Frames for which the pass samples with the same structures while nothing changes, at most; 0: it learns nothing
  /// from samples. Each such epoch takes random numbers that are independent of those that its structures come from.
  virtual uint32_t longest_epoch() const { return 0; }

  /// Called when a frame was stopped, or an exception left it, in this pass or a later one: undoes what run() has
  /// changed beyond buffers, so that the next frame is as if this one had never begun.
  virtual void abandon() {}

  /// Whether a frame can no longer be stopped once this pass has begun, because abandon() cannot undo its changes.
  virtual bool commits() const { return false; }

  /// Whether what a pixel shows comes from its own samples, as far as this pass goes: not from light paths and cells
  /// that others sampled.
  virtual bool keeps_to_pixels() const { return true; }

  /// False if `FrameContext::hurry` ended its preparation: frames rendered so far are unbiased but noisier.
  virtual bool prepared() const { return true; }

  /// Bytes beyond its buffers.
  virtual size_t memory_bytes() const { return 0; }

  /// Numbers for reports, as of the last frame.
  virtual std::vector<PassStatistic> statistics() const { return {}; }

  /// What a user should know of the frames so far, because results suffered: one sentence each.
  virtual std::vector<std::string> warnings() const { return {}; }

  /// State beyond its buffers, for checkpoints. load() reads what save() wrote; a short stream sets its failbit.
  virtual void save(std::ostream&) const {}
  virtual void load(std::istream&) {}
};

}  // namespace relume
