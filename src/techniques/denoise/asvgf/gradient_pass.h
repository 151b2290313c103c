// Finds the gradients of A-SVGF as a pass.
#pragma once

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/denoise/asvgf/gradients.h"
#include "techniques/denoise/asvgf/settings.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Records samples of each frame, and traces those of the previous frame again while light may change. Its paths do not
/// enter the image, whose samples are those of the frame. Requires paths whose random numbers and
/// structures can be repeated: those of PathPass without learning techniques.
class GradientPass final : public Pass {
 public:
  GradientPass(const AsvgfSettings& settings, const PathSource& source, Memory& memory)
      : settings_(settings),
        source_(source),
        recorded_{Recording(memory), Recording(memory)},
        votes_(memory),
        gradients_(memory) {}

  void configure(const AsvgfSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  void abandon() override;
  size_t memory_bytes() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// Whether this frame has gradients. If not, no light has changed, or histories end.
  bool traced() const { return traced_; }
  /// TraceGradientsKernel::gradients by stratum. Requires traced().
  View<const Vec2> gradients() const { return gradients_.view(); }

 private:
  /// Parameters of a frame's random numbers.
  struct FrameNumbers {
    uint32_t seed = 0;
    uint32_t sequence = 0;
    uint32_t frame = 0;
    uint32_t age = 0;
    uint32_t camera_runs = 0;
    uint32_t valid = 0;  ///< 1: the frame was recorded
  };
  /// Samples of a frame.
  struct Recording {
    explicit Recording(Memory& memory) : samples(memory) {}

    FrameNumbers numbers;
    Array<GradientSample> samples;
  };

  /// Whether light may have changed since the previous frame.
  bool may_differ(const FrameContext& frame) const;
  // These return false if a stop was requested first.
  bool trace(const FrameContext& frame, const Recording& before);
  bool record(const FrameContext& frame, Recording& now) const;

  AsvgfSettings settings_;
  PathSource source_;
  Recording recorded_[2];
  uint32_t current_ = 0;    ///< the recording of the last complete frame
  bool exchanged_ = false;  ///< whether this frame has replaced it
  bool traced_ = false;
  Array<uint64_t> votes_;
  Array<Vec2> gradients_;
};

}  // namespace relume
