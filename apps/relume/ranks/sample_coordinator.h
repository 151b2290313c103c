// Merges the samples of all ranks into one image, on rank 0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "parts/sums_file.h"
#include "ranks/hosts.h"
#include "ranks/link.h"
#include "ranks/sample_dealer.h"
#include "ranks/sample_worker.h"
#include "relume/render.h"

namespace relume::ranks {

struct SampleJob {
  MergedSums image;  ///< without samples
  bool adapt = false;
  RenderLimits limits;
  std::filesystem::path checkpoint;  ///< empty: none
  double checkpoint_interval_s = 60;
  std::string identity;  ///< of scene and settings; all ranks must have the same
};

/// State of a render for its progress line.
struct RanksProgress {
  RenderProgress render;
  double rays_per_s = 0;
  int ranks = 1;
};

class SampleCoordinator {
 public:
  SampleCoordinator(RankLink& link, SampleJob job);

  /// Adds the samples of a checkpoint. Throws Error if it belongs to another image.
  void resume();
  /// Deals and merges until a limit is met, `stop` is requested or a rank is lost. Then tells all ranks to finish.
  /// Returns within about a second of the last result, whatever slower ranks do. Throws Error.
  StopReason run(const std::stop_token& stop, const std::function<void(const RanksProgress&)>& show);

  /// Why the job ended early; empty if it did not.
  const std::string& problem() const { return problem_; }
  /// Why the last checkpoint could not be written; empty if it was.
  const std::string& save_problem() const { return save_problem_; }
  /// Samples per pixel of all ranks.
  uint32_t samples() const { return dealer_.done().count() + rest_samples_; }
  /// Adds the samples of incomplete blocks to sums(), after run(). Returns the error of the image of all samples.
  double complete_image();
  std::span<const PixelSums> sums() const { return sums_; }

 private:
  struct Rank {
    bool ready = false;
    uint32_t deal = 0;  ///< id of what it renders; 0: idle
    WorkProgress progress;
    std::map<uint32_t, uint32_t> rendered = {};  ///< deals whose results have not arrived, with their samples
    std::optional<uint32_t> lane;                ///< number of its last replica that has samples in the image
  };

  std::optional<StopReason> step(const std::stop_token& stop);
  void handle(const Message& message);
  void note_rendered(Rank& rank, const WorkProgress& progress);
  void merge(int rank, const Message& message);
  void deal_to_idle();
  bool time_is_over() const;
  double elapsed_s() const;
  RanksProgress progress() const;
  double error_of(uint32_t samples) const;
  SampleRanges block_samples() const;
  MergedSums merged() const;
  void end_saving();
  void save_if_due();
  void save();

  RankLink& link_;
  SampleJob job_;
  HostList hosts_;
  SampleDealer dealer_;
  std::vector<Rank> ranks_;
  std::vector<PixelSums> sums_;            ///< of complete blocks
  std::vector<PixelSums> rest_;            ///< of samples in other blocks
  uint32_t rest_samples_ = 0;              ///< those that time has cut off
  std::optional<SampleRange> last_block_;  ///< the last samples of the image, if they are fewer than a block
  uint32_t resumed_ = 0;                   ///< samples of the checkpoint
  uint32_t replicas_ = 0;
  bool is_cut_off_ = false;  ///< whether time has cut off a deal
  std::optional<double> start_s_;
  double error_ = 0;
  uint32_t error_samples_ = 0;  ///< samples of error_
  double saved_s_ = 0;
  uint32_t saved_samples_ = 0;
  std::future<void> saving_;
  std::string problem_;
  std::string save_problem_;
};

}  // namespace relume::ranks
