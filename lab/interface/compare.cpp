#include "relume/lab/compare.h"

#include <algorithm>

#include "compare/comparison.h"
#include "compare/comparison_page.h"
#include "relume/error.h"
#include "relume/settings.h"
#include "relume/version.h"

namespace relume::lab {
namespace {

std::vector<Contender> contenders_of(const ComparisonRequest& request) {
  if (request.contenders.empty()) return parse_contenders(request.techniques, "techniques");
  std::vector<Contender> contenders;
  for (const ContenderSettings& c : request.contenders) {
    const auto same = [&](const Contender& other) { return other.name == c.name; };
    if (c.name.empty() || std::any_of(contenders.begin(), contenders.end(), same))
      throw Error("two contenders are called '" + c.name + "', or one has no name; give each a name of its own");
    contenders.push_back({.name = c.name, .preset = c.preset, .settings = c.settings});
  }
  return contenders;
}

ComparisonOptions options_of(const Scene& scene, const ComparisonRequest& request) {
  ComparisonOptions options;
  options.scene_name = request.scene_name;
  options.contenders = contenders_of(request);
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
  // As `relume compare` does: these settings are the scene's, so all contenders share them.
  Settings common;
  if (!scene.settings_json.empty()) common.apply_json(scene.settings_json, request.scene_name);
  for (const auto& [name, value] : request.settings) common.set(name, value);
  Scene changed = scene;
  apply_to_scene(common, changed);
  std::optional<Comparison> comparison = relume::compare(changed, options_of(scene, request), stop, report);
  if (!comparison) return std::nullopt;
  auto state = std::make_unique<ComparisonReport::State>();
  state->comparison = std::move(*comparison);
  return ComparisonReport(std::move(state));
}

}  // namespace relume::lab
