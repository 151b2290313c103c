#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/machine.h"
#include "cli/platform.h"
#include "cli/progress.h"
#include "compare/reference.h"
#include "core/clock.h"
#include "experiments/output/results.h"
#include "experiments/shared_parts.h"
#include "files/atomic_file.h"
#include "frame/cuda/device_choice.h"
#include "frame/launch.h"
#include "ranks/launcher.h"
#include "ranks/task_pool.h"
#include "settings/text_list.h"

namespace relume::cli {
namespace {

struct ExperimentOptions {
  std::string action;
  std::string names;  ///< comma-separated
  std::string output = "experiments";
  std::string scenes;
  std::string cache_folder;
  std::string device = "cpu";
  int threads = 0;  ///< 0: all
  bool all = false;
  bool quick = false;
  bool goes_on = false;
};

int list_experiments() {
  for (const Experiment& e : experiments())
    std::fputs(fmt::format("{:<20} {:<18} {}\n", e.name, e.paper, e.summary).c_str(), stdout);
  return kExitDone;
}

std::vector<const Experiment*> chosen(const ExperimentOptions& o) {
  std::vector<const Experiment*> list;
  if (o.all) {
    if (!o.names.empty()) throw UsageError("experiment run takes names or --all, not both");
    for (const Experiment& e : experiments()) list.push_back(&e);
    return list;
  }
  for (const std::string_view name : split_at_commas(o.names)) {
    const Experiment* experiment = &require_experiment(name);
    if (std::find(list.begin(), list.end(), experiment) == list.end()) list.push_back(experiment);
  }
  if (list.empty()) throw UsageError("experiment run needs names or --all; `relume experiment list` shows them");
  return list;
}

/// Throws UsageError for results that cannot be written or would replace a scene.
void check_outputs(const ExperimentOptions& o, const std::vector<const Experiment*>& list,
                   const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files = {folder / "index.html", folder / "index.md"};
  for (const Experiment* experiment : list) {
    for (const char* extension : {".html", ".json"})
      files.push_back(folder / (std::string(experiment->name) + extension));
  }
  FileRoles roles;
  if (!o.scenes.empty()) roles.reads("--scenes", std::filesystem::path(o.scenes) / "sponza" / "sponza.gltf");
  for (const std::filesystem::path& file : files) {
    roles.writes("-o", file);
    check_output_file(file);
  }
}

ExperimentContext make_context(const ExperimentOptions& o, ProgressPrinter& printer) {
  ExperimentContext context;
  context.quick = o.quick;
  context.cache_folder = reference_folder(o.cache_folder);
  context.scene_folder = o.scenes;
  context.program = program_stamp();
  context.device = o.device;
  context.progress = [&printer](const std::string& stage, double fraction) { printer.show_stage(stage, fraction); };
  return context;
}

void print_claims(const Experiment& experiment, const ExperimentResult& result) {
  std::fputs(fmt::format("{} {}\n", experiment.name, experiment.paper).c_str(), stdout);
  for (const Claim& claim : result.claims)
    std::fputs(fmt::format("  {:<14} {:<22} {}\n", claim.verdict, claim.id, claim.measured).c_str(), stdout);
  std::fflush(stdout);
}

/// The experiment's summary in the folder; std::nullopt if it was not run.
std::optional<ExperimentSummary> summary_in(const std::filesystem::path& folder, const Experiment& experiment) {
  const std::filesystem::path file = folder / (std::string(experiment.name) + ".json");
  if (std::error_code failure; !std::filesystem::exists(file, failure)) return std::nullopt;
  const std::vector<std::byte> bytes = read_file(file);
  return read_summary({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

/// All summaries in the folder, of any run.
std::vector<ExperimentSummary> summaries_in(const std::filesystem::path& folder) {
  std::vector<ExperimentSummary> summaries;
  for (const Experiment& experiment : experiments()) {
    if (auto summary = summary_in(folder, experiment)) summaries.push_back(std::move(*summary));
  }
  return summaries;
}

void write_index(const std::filesystem::path& folder) {
  const std::vector<ExperimentSummary> all = summaries_in(folder);
  write_file(folder / "index.html", to_html(index_page(all)));
  write_file(folder / "index.md", index_markdown(all));
}

/// The result that `--continue` keeps from the folder. Returns std::nullopt if it must be measured, also if it lacks
/// scenes that are available now, or is of another device.
std::optional<ExperimentSummary> result_that_stays(const ExperimentOptions& o, const std::filesystem::path& folder,
                                                   const Experiment& experiment) {
  if (!o.goes_on) return std::nullopt;
  std::optional<ExperimentSummary> summary = summary_in(folder, experiment);
  if (!summary) return std::nullopt;
  const bool lacks_scenes = !summary->run.scenes && !o.scenes.empty();
  if (summary->run.quick != o.quick || lacks_scenes || summary->run.device != o.device) return std::nullopt;
  return summary;
}

void tell_that_it_stays(const ExperimentSummary& summary, const std::filesystem::path& folder,
                        const ExperimentContext& context, const Verbosity& verbosity) {
  log_info(verbosity,
           fmt::format("{} is in {} already{}", summary.name, folder.string(),
                       summary.run.program == context.program
                           ? ""
                           : ", measured by another build of relume; run without --continue to measure it again"));
}

/// The machine with its device, and the numbers of threads and ranks used.
std::vector<std::pair<std::string, std::string>> machine_of(const ExperimentOptions& o, const SharedWork* ranks) {
  auto machine = machine_description({o.device});
  if (o.threads > 0) machine.emplace_back("Threads", fmt::format("{} at most", o.threads));
  if (ranks) {
    machine.emplace_back("Ranks", fmt::format("{}; times at equal samples include the load of other ranks, except in "
                                              "experiments with claims about times",
                                              ranks->ranks()));
  }
  return machine;
}

/// Runs the experiment. Throws Error on a rank that measured less than the first, which others would wait for.
ExperimentResult measure(const Experiment& experiment, const ExperimentContext& context) {
  ExperimentResult result = experiment.run(context);
  if (context.ranks) check_step(context, "end");
  return result;
}

/// Measures, and writes the result beside those already in the folder. `writes_index`: on one rank only.
void run_experiment(const Experiment& experiment, const ExperimentOptions& o, const ExperimentContext& context,
                    const std::filesystem::path& folder, ProgressPrinter& printer, const Verbosity& verbosity,
                    bool writes_index) {
  const std::string name(experiment.name);
  const double start_s = now_s();
  const ExperimentResult result = measure(experiment, context);
  const ExperimentRun run{
      machine_of(o, context.ranks), o.quick, now_s() - start_s, !o.scenes.empty(), context.program, o.device};
  printer.clear();
  write_files({{folder / (name + ".html"), to_html(experiment_page(experiment, result, run))},
               {folder / (name + ".json"), to_json(experiment, result, run)}});
  std::error_code stays;
  std::filesystem::remove_all(context.parts_folder, stays);
  if (writes_index) write_index(folder);
  print_claims(experiment, result);
  log_info(verbosity,
           fmt::format("wrote {} in {}", (folder / (name + ".html")).string(), format_duration(run.seconds)));
}

/// Rights of a rank.
struct RankRights {
  bool throws;        ///< whether an error ends the command
  bool writes_index;  ///< on one rank only
};

/// Measures an experiment unless its result stays. Returns its name if it failed; std::nullopt if it was interrupted.
std::optional<std::string> run_task(const Experiment& experiment, const ExperimentOptions& o,
                                    ExperimentContext& context, const std::filesystem::path& folder,
                                    ProgressPrinter& printer, const Verbosity& verbosity, const RankRights& rights) {
  const std::string name(experiment.name);
  context.parts_folder = folder / (name + ".parts");
  if (const auto summary = result_that_stays(o, folder, experiment)) {
    tell_that_it_stays(*summary, folder, context, verbosity);
    return "";
  }
  try {
    run_experiment(experiment, o, context, folder, printer, verbosity, rights.writes_index);
    return "";
  } catch (const ExperimentStopped&) {
    printer.clear();
    log_info(verbosity, fmt::format("interrupted {}; the same command{} continues it", name,
                                    !rights.throws && !o.goes_on ? " with --continue" : ""));
    return std::nullopt;
  } catch (const std::exception& error) {
    if (rights.throws) throw;
    printer.clear();
    warn(fmt::format("{} failed: {}", name, error.what()));  // other experiments continue
    return name;
  }
}

/// Runs this rank's part of an experiment whose parts all ranks share. Only the first one writes and prints.
int run_on_all_ranks(const Experiment& experiment, const ExperimentOptions& o, ExperimentContext context,
                     ProgressPrinter& printer, const Verbosity& verbosity, SharedWork& ranks) {
  const std::filesystem::path folder = o.output;
  const bool stays = ranks.is_first() && result_that_stays(o, folder, experiment).has_value();
  context.ranks = &ranks;
  const std::optional<std::string> first_stays = ranks.share(stays ? "stays" : "");
  if (!first_stays) return kExitFailed;
  const std::string start = fmt::format("{} {} on {}{}{}", experiment.name, context.program, o.device,
                                        o.quick ? ", quick" : "", o.scenes.empty() ? "" : ", with scenes");
  try {
    if (first_stays->empty()) check_step(context, start);
    if (!ranks.is_first()) {
      if (first_stays->empty()) measure(experiment, context);
      return kExitDone;
    }
  } catch (const ExperimentStopped&) {
    return kExitInterrupted;
  }
  const bool done =
      run_task(experiment, o, context, folder, printer, verbosity, {.throws = true, .writes_index = false}).has_value();
  if (done) write_index(folder);
  return done ? kExitDone : kExitInterrupted;
}

/// Makes the folder of the results. Throws UsageError, and Error for a foreign file: before hours of work, not after.
void prepare_folder(const ExperimentOptions& o, const std::vector<const Experiment*>& list,
                    const std::filesystem::path& folder) {
  make_output_folder(folder);
  check_outputs(o, list, folder);
  summaries_in(folder);
}

int run_experiments(const ExperimentOptions& wanted, const Verbosity& verbosity) {
  const std::vector<const Experiment*> list = chosen(wanted);
  ExperimentOptions o = wanted;
  o.device = cuda::resolved_device(wanted.device);  // all results record, and use, the same device
  const std::filesystem::path folder = o.output;
  const std::optional<ranks::Launch> launch = ranks::find_launch();
  const bool is_divided = list.size() == 1 && launch && launch->size > 1;
  if (!is_divided) prepare_folder(o, list, folder);
  ranks::TaskPool pool("run what is missing again");
  const bool is_first_rank = pool.is_first();
  // A result states the limit, whether an option or the launcher sets it.
  if (o.threads == 0 && launch && launch->size > 1) o.threads = ranks::threads_of_rank(*launch);
  const ThreadLimit limit(o.threads);
  const InterruptGuard interrupts(is_first_rank ? interrupt_notice(verbosity, "this step") : "");
  ProgressPrinter printer(!verbosity.quiet && is_first_rank);
  ExperimentContext context = make_context(o, printer);
  context.threads = limit.threads();
  if (is_divided) {
    if (is_first_rank) context.stop = interrupts.token();  // rank 0 handles interrupts, and stops the other ranks
    return pool.run_and_end([&] {
      if (is_first_rank) prepare_folder(o, list, folder);
      return run_on_all_ranks(*list.front(), o, context, printer, verbosity, pool);
    });
  }
  SharedTasks tasks{.tasks = std::vector<size_t>(list.size()), .run = {}};
  std::iota(tasks.tasks.begin(), tasks.tasks.end(), size_t{0});
  // Its result is the name of an experiment that failed.
  tasks.run = [&](size_t task, const std::stop_token& stop, const SharedTasks::Progress&) {
    context.stop = stop;
    return run_task(*list[task], o, context, folder, printer, verbosity, {list.size() == 1, is_first_rank});
  };
  const std::optional<std::vector<std::string>> results = pool.gather(tasks, interrupts.token());
  if (!results || !is_first_rank) return pool.end(kExitInterrupted);
  write_index(folder);  // also if all of them existed
  std::vector<std::string> failed;
  std::copy_if(results->begin(), results->end(), std::back_inserter(failed),
               [](const std::string& name) { return !name.empty(); });
  pool.end(failed.empty() ? kExitDone : kExitFailed);
  if (!failed.empty())
    throw Error(fmt::format("{} of {} experiments failed: {}", failed.size(), list.size(), fmt::join(failed, ", ")));
  return kExitDone;
}

int run(const ExperimentOptions& o, const Verbosity& verbosity) {
  if (o.action == "run") return run_experiments(o, verbosity);
  if (o.action != "list") throw UsageError(fmt::format("experiment has no action '{}'; use list or run", o.action));
  return list_experiments();
}

}  // namespace

Command experiment_command(Verbosity& verbosity) {
  const auto options = std::make_shared<ExperimentOptions>();
  Command command{
      .name = "experiment",
      .summary = "Measure the claims of papers.",
      .examples = {{"relume experiment list", "all experiments"},
                   {"relume experiment run reprojection -o out",
                    "claims and curves, in out/reprojection.html and .json"},
                   {"relume experiment run --all -o out --quick", "a quick run of all, to check that they work"},
                   {"relume experiment run --all -o out --scenes scenes", "with Sponza in scenes/sponza"}},
      .arguments = {{"ACTION", &options->action, "list or run", true, Completion::experiment},
                    {"NAME", &options->names, "Experiments", false, Completion::experiment, true}},
      .options =
          {{{"output", &options->output,
             "Folder for NAME.json and NAME.html, and for index.html and index.md over all of them"},
            "FOLDER",
            'o',
            Completion::file},
           {{"all", &options->all, "Run all experiments"}},
           {{"threads", &options->threads, "Worker threads; 0: one per core", {.min = 0, .max = 1024}}},
           {{"device", &options->device,
             "Device that renders: cpu; cuda or cuda:N, an NVIDIA GPU (relume devices lists them); auto, the first "
             "usable GPU, else cpu"},
            "DEVICE"},
           {{"quick", &options->quick, "Small images and few settings"}},
           {{"continue", &options->goes_on, "Skip experiments whose results are in the folder already"}},
           {{"scenes", &options->scenes, "Folder with scenes that are not built in, such as sponza/sponza.gltf"},
            "FOLDER",
            0,
            Completion::file},
           {{"cache-dir", &options->cache_folder,
             "Folder for cached references, in references/; without it, $XDG_CACHE_HOME/relume or ~/.cache/relume"},
            "FOLDER",
            0,
            Completion::file}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options, &verbosity] { return run(*options, verbosity); },
      .folders = {kReferenceFolder},
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli
