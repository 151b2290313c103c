#include "relume/lab/experiments.h"

#include "core/clock.h"
#include "experiments/experiment.h"
#include "experiments/output/results.h"
#include "relume/version.h"

namespace relume::lab {

std::vector<ExperimentInfo> list_experiments() {
  std::vector<ExperimentInfo> list;
  for (const Experiment& e : experiments())
    list.push_back({std::string(e.name), std::string(e.paper), std::string(e.summary)});
  return list;
}

std::optional<ExperimentReport> run_experiment(
    std::string_view name, const ExperimentRequest& request, std::stop_token stop,
    const std::function<void(const std::string& stage, double fraction)>& progress) {
  const Experiment& experiment = require_experiment(name);
  const ExperimentContext context{.quick = request.quick,
                                  .cache_folder = request.cache_folder,
                                  .scene_folder = request.scene_folder,
                                  .parts_folder = request.parts_folder,
                                  .program = version(),
                                  .device = request.device,
                                  .stop = std::move(stop),
                                  .progress = progress};
  const double start_s = now_s();
  try {
    const ExperimentResult result = experiment.run(context);
    ExperimentReport report;
    report.seconds = now_s() - start_s;
    const ExperimentRun run{.machine = {},
                            .quick = request.quick,
                            .seconds = report.seconds,
                            .scenes = !request.scene_folder.empty(),
                            .program = context.program,
                            .device = context.device};
    for (const Claim& c : result.claims)
      report.claims.push_back({c.id, c.paper, c.claim, c.measured, c.threshold, c.verdict});
    report.json = to_json(experiment, result, run);
    report.html = to_html(experiment_page(experiment, result, run));
    return report;
  } catch (const ExperimentStopped&) {
    return std::nullopt;
  }
}

}  // namespace relume::lab
