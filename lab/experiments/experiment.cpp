#include "experiments/experiment.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "experiments/all.h"
#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> list = {
      adaptive_sampling_experiment(),
      proportional_sampling_experiment(),
      reprojection_experiment(),
      combination_experiment(),
      psf_error_experiment(),
      psf_bias_experiment(),
      psf_variance_experiment(),
      psf_frametime_experiment(),
      apg_depth_experiment(),
      // Learned lights and directions.
      light_selection_experiment(),
      guiding_experiment(),
      vlc_adaptation_experiment(),
      cdq_adaptation_experiment(),
      mcpg_adaptation_experiment(),
      guide_cost_experiment(),
      bdpt_quality_experiment(),
      bdpt_cost_experiment(),
      bmfr_experiment(),
      interactive_experiment(),
      upscaling_experiment(),
      vcm_quality_experiment(),
      restir_di_speed_experiment(),
      restir_bias_experiment(),
      restir_correlation_experiment(),
      restir_pt_shifts_experiment(),
      scale_experiment(),
      no_reuse_experiment(),
      readapt_experiment(),
      together_experiment(),
      indirect_experiment(),
      caustics_experiment(),
      sharc_cost_experiment(),
  };
  return list;
}

const Experiment& require_experiment(std::string_view name) {
  std::vector<std::string> names;
  for (const Experiment& experiment : experiments()) {
    if (experiment.name == name) return experiment;
    names.emplace_back(experiment.name);
  }
  throw Error(fmt::format("there is no experiment '{}'{}", name, suggestion(name, names)));
}

Claim judged(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
             bool holds) {
  return with_verdict(std::move(id), std::move(paper), std::move(claim), std::move(measured), std::move(threshold),
                      holds ? kVerdictHolds : kVerdictFails);
}

const char* verdict_of(const Interval& value, double least, double most) {
  if (value.low >= least && value.high <= most) return kVerdictHolds;
  return value.high < least || value.low > most ? kVerdictFails : kVerdictUndecided;
}

const char* verdict_of_all(const std::vector<const char*>& parts) {
  const auto is = [](std::string_view verdict) { return [verdict](const char* part) { return part == verdict; }; };
  if (std::any_of(parts.begin(), parts.end(), is(kVerdictFails))) return kVerdictFails;
  const bool all_hold = !parts.empty() && std::all_of(parts.begin(), parts.end(), is(kVerdictHolds));
  return all_hold ? kVerdictHolds : kVerdictUndecided;
}

Claim with_verdict(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
                   const char* verdict) {
  return {std::move(id), std::move(paper), std::move(claim), std::move(measured), std::move(threshold), verdict};
}

Claim unmeasured(std::string id, std::string paper, std::string claim, std::string threshold, std::string reason) {
  return {std::move(id), std::move(paper), std::move(claim), std::move(reason), std::move(threshold), kVerdictOpen};
}

}  // namespace relume
