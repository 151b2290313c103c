// The choice "restir-pt" of the slot reuse as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/reuse/restir_pt/settings.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

struct LearnedChoices;
struct PairSearch;
struct PathShifter;

/// What the paths of candidates use that was learned, and where they record; nullptr: nothing.
struct PathLearning {
  const LightSelector* selector = nullptr;       ///< light selection that learns
  const DirectionSampler* directions = nullptr;  ///< guide
  const PathRecording* samples = nullptr;
  ChainRecordings chains = {};

  bool any() const { return selector || directions; }
};

/// Adds the light of all paths that scatter by a lobe with a density, to that of paths without such
/// (PathRecords::only_specular).
class RestirPtPass : public Pass {
 public:
  /// `source`: its choices must not learn.
  RestirPtPass(const RestirPtSettings& settings, const PathSource& source, const PathLearning& learning)
      : settings_(settings), source_(source), learning_(learning) {}

  void configure(const RestirPtSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool keeps_to_pixels() const override { return false; }
  uint32_t correlated_frames() const override { return frames_correlated_by(settings_.cap); }

 protected:
  template <typename Suffix>
  bool trace_candidates_with(const FrameContext& frame, const Suffix& suffix) const;
  /// Traces the candidates. Returns false if a stop was requested first.
  virtual bool trace_candidates(const FrameContext& frame) const;
  /// Whether candidates find light behind joints by a radiance cache.
  virtual bool uses_cells() const { return false; }

 private:
  PathShifter shifter(const FrameContext& frame) const;
  PairSearch pairs(const FrameContext& frame) const;
  /// For candidates, here and below.
  PathContext learned_context(const FrameContext& frame) const;
  LearnedChoices learned_choices() const;
  bool finds_duplicates() const { return settings_.cap > 0 && settings_.duplication > 0; }
  // These return false if a stop was requested first.
  template <typename Choices, typename Suffix>
  bool trace_candidates_by(const FrameContext& frame, const PathContext& context, const Choices& choices,
                           const Suffix& suffix) const;
  bool count_duplicates(const FrameContext& frame) const;
  bool reuse_history(const FrameContext& frame) const;
  bool shift_pairs(const FrameContext& frame) const;
  bool reuse_neighbours(const FrameContext& frame) const;

  RestirPtSettings settings_;
  PathSource source_;
  PathLearning learning_;
};

}  // namespace relume
