#include "relume/lab/compare.h"

#include "compare/comparison.h"
#include "compare/comparison_page.h"
#include "relume/version.h"

namespace relume::lab {
namespace {

ComparisonOptions options_of(const Scene& scene, const ComparisonRequest& request) {
  ComparisonOptions options;
  options.scene_name = request.scene_name;
  options.contenders = parse_contenders(request.techniques, "techniques");
  options.common.scene_json = scene.settings_json;
  options.common.scene_place = request.scene_name;
  options.common.flags = request.settings;
  options.spp = request.spp;
  options.budget_s = request.budget_s;
  options.repetitions = request.repetitions;
  options.times_s = request.times_s;
  options.reference_file = request.reference_file;
  options.reference_spp = request.reference_spp;
  options.cache_folder = request.cache_folder;
  options.program = version();
  return options;
}

ContenderScore score_of(const ContenderResult& result) {
  const auto median = [&](double Repetition::*figure) {
    return median_of(result, [figure](const Repetition& r) { return r.*figure; });
  };
  return {.name = result.name,
          .mse = median(&Repetition::mse),
          .rel_mse = median(&Repetition::rel_mse),
          .mape = median(&Repetition::mape),
          .flip = median(&Repetition::flip),
          .temporal_error = median(&Repetition::temporal_error),
          .samples = median(&Repetition::samples),
          .time_s = median(&Repetition::time_s),
          .mses = values_of(result, [](const Repetition& r) { return r.mse; }),
          .image = result.image};
}

}  // namespace

struct ComparisonReport::State {
  Comparison comparison;
};

ComparisonReport::ComparisonReport(std::unique_ptr<const State> state) : state_(std::move(state)) {
  for (const ContenderResult& result : state_->comparison.contenders) contenders_.push_back(score_of(result));
}
ComparisonReport::~ComparisonReport() = default;
ComparisonReport::ComparisonReport(ComparisonReport&&) noexcept = default;
ComparisonReport& ComparisonReport::operator=(ComparisonReport&&) noexcept = default;

const Image& ComparisonReport::reference() const { return state_->comparison.reference.image; }
double ComparisonReport::reference_mse() const { return state_->comparison.reference.mse; }
const std::vector<std::string>& ComparisonReport::notes() const { return state_->comparison.notes; }
std::string ComparisonReport::to_json() const { return relume::to_json(state_->comparison, {}); }
std::string ComparisonReport::to_csv() const { return relume::to_csv(state_->comparison); }
std::string ComparisonReport::to_html() const { return relume::to_html(comparison_page(state_->comparison, {})); }

std::optional<ComparisonReport> compare(const Scene& scene, const ComparisonRequest& request, std::stop_token stop,
                                        const StageProgress& progress) {
  const StageProgress report = progress ? progress : [](const std::string&, double) {};
  std::optional<Comparison> comparison = relume::compare(scene, options_of(scene, request), stop, report);
  if (!comparison) return std::nullopt;
  auto state = std::make_unique<ComparisonReport::State>();
  state->comparison = std::move(*comparison);
  return ComparisonReport(std::move(state));
}

}  // namespace relume::lab
