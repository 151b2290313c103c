// A pass: one step of a frame. It declares the buffers that it owns, reads and writes. It runs once per frame, in the
// order of the stages (docs/architecture.md).
#pragma once

#include <array>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "frame/frame_context.h"
#include "frame/records.h"
#include "relume/statistics.h"

namespace relume {

/// Steps of a frame, in order. The pass list determines the order within a stage.
enum class Stage : uint8_t {
  prepare,       ///< structures from the scene and earlier samples
  hits,          ///< primary hits of every pixel
  gbuffer,       ///< surfaces at the primary hits
  history,       ///< samples of earlier frames for this frame's pixels
  allocate,      ///< number of paths per pixel
  sampled_hits,  ///< primary hits of pixels with a path only, if no pass reads the others
  trace,         ///< paths
  resolve,       ///< pixel values from caches
  present,       ///< addition of samples to the history
  denoise,       ///< filters of the image
};

/// Names of the stages, in order.
inline constexpr std::array<std::string_view, 10> kStageNames{"prepare",      "hits",  "gbuffer", "history", "allocate",
                                                              "sampled-hits", "trace", "resolve", "present", "denoise"};

struct PassDeclaration {
  std::string_view name;  ///< kebab-case, for timings and messages
  Stage stage = Stage::trace;
  std::vector<BufferDescription> owns = {};  ///< buffers that it provides and writes
  std::vector<BufferId> reads = {};          ///< buffers of earlier passes or of the previous frame
  std::vector<BufferId> writes = {};         ///< buffers of other passes that it changes
  std::vector<BufferId> reads_if_any = {};   ///< as `reads`, for buffers that may not exist
  std::vector<BufferId> writes_if_any = {};  ///< as `writes`, for buffers that may not exist
  bool moves_surfaces = false;               ///< whether it writes every buffer that follows the surface
  bool only_sampled_pixels = false;          ///< whether it only reads pixels that have a sample in this frame
};

class Pass {
 public:
  virtual ~Pass() = default;

  virtual PassDeclaration declaration() const = 0;

  /// Runs the pass. Returns false if `frame.stop` was requested first; the frame is then abandoned.
  virtual bool run(const FrameContext& frame) = 0;

  /// Maximum number of frames that the pass samples with the same structures while nothing changes; 0: the pass does
  /// not learn. The random numbers of each epoch are independent of those that built its structures.
  virtual uint32_t longest_epoch() const { return 0; }

  /// Called when a frame was stopped, or ended by an exception, in this pass or a later one. Undoes the changes of
  /// run() outside buffers, so that the next frame is unaffected.
  virtual void abandon() {}

  /// Whether a frame can no longer be stopped once this pass has begun, because abandon() cannot undo its changes.
  virtual bool commits() const { return false; }

  /// Whether the pass computes each pixel from the pixel's own samples, not from light paths or cells that other pixels
  /// sampled.
  virtual bool keeps_to_pixels() const { return true; }

  /// Number of frames that count as one independent frame in estimates of errors, because samples of earlier frames are
  /// used again: the sum of the correlations between a frame and all others, which fall exponentially with their
  /// distance (correlation_factor()). 1: frames are independent.
  virtual uint32_t correlated_frames() const { return 1; }

  /// False if `FrameContext::hurry` ended its preparation early: frames so far are unbiased but noisier.
  virtual bool prepared() const { return true; }

  /// Bytes outside its buffers.
  virtual size_t memory_bytes() const { return 0; }

  /// Numbers for reports, of the last frame.
  virtual std::vector<PassStatistic> statistics() const { return {}; }

  /// Data structures for inspection. The functions that read them are valid while the pass exists.
  virtual std::vector<PassRecords> records() const { return {}; }

  /// Problems that affect the results of the frames so far, one sentence each.
  virtual std::vector<std::string> warnings() const { return {}; }

  /// State outside its buffers, for checkpoints. load() reads the output of save(); a short stream sets its failbit.
  virtual void save(std::ostream&) const {}
  virtual void load(std::istream&) {}
};

/// Constructs a P. Appends `memory` to the arguments if its constructor accepts it.
template <typename P, typename... Arguments>
std::unique_ptr<P> make_pass(Memory& memory, Arguments&&... arguments) {
  if constexpr (std::is_constructible_v<P, Arguments..., Memory&>) {
    return std::make_unique<P>(std::forward<Arguments>(arguments)..., memory);
  } else {
    return std::make_unique<P>(std::forward<Arguments>(arguments)...);
  }
}

}  // namespace relume
