// One comparison in progress. Used only by compare().
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/rounds.h"

namespace relume {

class Comparing {
 public:
  /// `shared`: the ranks that take part; nullptr: this process does all.
  Comparing(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
            const ComparisonProgress& progress, SharedWork* shared);

  std::optional<Comparison> run();

 private:
  const ComparisonOptions& options() const { return result_.options; }
  std::function<void(double)> stage(std::string name) const;

  void prepare();
  void read_images();
  std::vector<float> reference_times() const;
  ReferenceRenderer reference_renderer() const;
  bool make_references();
  bool measure_contenders();
  bool begin_sharing();
  bool share_references();
  bool share_contenders();
  bool share_plan(FramePlan& plan);
  void keep_results(const std::vector<std::string>& results);
  Sessions sessions_of(size_t first, size_t count, const std::stop_token& stop) const;
  void add_repetition(size_t contender, Repetition repetition, Image image);
  void split_errors();
  void measure_images();
  void judge_references();

  const Scene& scene_;
  const std::stop_token& stop_;
  const ComparisonProgress& progress_;
  SharedWork* shared_;
  std::vector<AllSettings> settings_;  ///< of each contender
  std::vector<Ensemble> ensembles_;    ///< of each contender
  std::vector<Image> images_;          ///< the external images
  std::vector<Reference> references_;
  Comparison result_;
};

}  // namespace relume
