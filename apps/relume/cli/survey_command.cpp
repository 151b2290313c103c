#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/machine.h"
#include "cli/platform.h"
#include "cli/progress.h"
#include "core/clock.h"
#include "experiments/survey/survey.h"
#include "experiments/survey/survey_file.h"
#include "experiments/survey/survey_scenes.h"
#include "experiments/survey/technique_list.h"
#include "frame/cuda/device_choice.h"
#include "frame/launch.h"

namespace relume::cli {
namespace {

struct SurveyOptions {
  std::string output = "survey";
  std::string scenes;      ///< names
  std::string techniques;  ///< names
  std::string folder;      ///< of scenes that are not built in
  std::string cache_folder;
  std::string device = "cpu";
  float time_limit_s = 0;  ///< 0: none
  int threads = 0;         ///< 0: all
  bool list = false;
  bool quick = false;
};

int list_all(const ExperimentContext& context) {
  for (const std::string& name : survey_scene_names(context))
    std::fputs(fmt::format("scene      {}\n", name).c_str(), stdout);
  for (const SurveyTechnique& technique : survey_techniques())
    std::fputs(fmt::format("technique  {:<30} {}\n", technique.name, technique.settings).c_str(), stdout);
  return kExitDone;
}

ExperimentContext context_of(const SurveyOptions& o) {
  ExperimentContext context;
  context.quick = o.quick;
  context.scene_folder = o.folder;
  context.program = program_stamp();
  return context;
}

/// The machine with its device, and the number of threads used.
std::vector<std::pair<std::string, std::string>> machine_of(const SurveyOptions& o) {
  auto machine = machine_description({o.device});
  if (o.threads > 0) machine.emplace_back("Threads", fmt::format("{} at most", o.threads));
  return machine;
}

/// Numbers of techniques over the scenes of this run.
struct Outcomes {
  size_t complete = 0;
  size_t failed = 0;

  void add(const SceneValues& scene) {
    for (const TechniqueValues& values : scene.techniques) {
      if (!values.failed.empty()) {
        ++failed;
      } else if (values.refused.empty()) {
        ++complete;
      }
    }
  }
};

/// Warns of each technique that failed, and tells "measured 12 of 14 techniques in corridor, in 7:31".
void report(const SceneValues& scene, double seconds, const Verbosity& verbosity) {
  for (const TechniqueValues& values : scene.techniques) {
    if (!values.failed.empty())
      warn(fmt::format("{} failed in {}: {}", values.technique.name, scene.name, values.failed));
  }
  Outcomes outcomes;
  outcomes.add(scene);
  log_info(verbosity, fmt::format("measured {} of {} techniques in {}, in {}", outcomes.complete,
                                  scene.techniques.size(), scene.name, format_duration(seconds)));
}

/// A failure is a result of the survey. That of all techniques is one of the machine.
int exit_code(const Outcomes& outcomes) {
  return outcomes.failed > 0 && outcomes.complete == 0 ? kExitFailed : kExitDone;
}

int measure(const SurveyOptions& o, const Verbosity& verbosity, ExperimentContext context) {
  const std::vector<SurveyTechnique> techniques = chosen_techniques(o.techniques);
  const std::vector<std::string> scenes = chosen_scenes(context, o.scenes);
  const SurveyEffort effort = SurveyEffort::of(context);
  const std::filesystem::path folder = o.output;
  make_output_folder(folder);
  FileRoles roles;
  if (!o.folder.empty()) roles.reads("--folder", std::filesystem::path(o.folder) / "sponza" / "sponza.gltf");
  roles.writes("-o", folder / kSurveyFile);
  check_output_file(folder / kSurveyFile);
  SurveyFile file(folder, survey_key(context, techniques, effort, o.threads));
  if (file.dropped() > 0) {
    log_info(verbosity, fmt::format("{}: {} scenes were measured under other conditions and will be replaced",
                                    (folder / kSurveyFile).string(), file.dropped()));
  }
  const ThreadLimit limit(o.threads);
  const InterruptGuard interrupts(interrupt_notice(verbosity, "this step"));
  ProgressPrinter printer(!verbosity.quiet);
  context.stop = interrupts.token();
  context.progress = [&printer](const std::string& stage, double fraction) { printer.show_stage(stage, fraction); };
  const double start_s = now_s();
  Outcomes outcomes;
  for (const std::string& name : scenes) {
    if (file.has(name)) continue;
    const double begin_s = now_s();
    if (o.time_limit_s > 0 && begin_s - start_s > static_cast<double>(o.time_limit_s)) {
      log_info(verbosity, "the time limit is reached; the same command measures the other scenes");
      return exit_code(outcomes);
    }
    try {
      const SceneValues values = measure_survey(context, survey_scene(context, name), techniques, effort);
      file.add(values, now_s() - begin_s, context, machine_of(o), effort);
      printer.clear();
      report(values, now_s() - begin_s, verbosity);
      outcomes.add(values);
    } catch (const ExperimentStopped&) {
      printer.clear();
      log_info(verbosity, fmt::format("interrupted in {}; the same command continues with this scene", name));
      return kExitInterrupted;
    }
  }
  log_info(verbosity, fmt::format("{} has all {} scenes", (folder / kSurveyFile).string(), scenes.size()));
  return exit_code(outcomes);
}

int run(const SurveyOptions& o, const Verbosity& verbosity) {
  ExperimentContext context = context_of(o);
  if (o.list) return list_all(context);
  context.cache_folder = reference_folder(o.cache_folder);
  context.device = cuda::resolved_device(o.device);
  SurveyOptions resolved = o;
  resolved.device = context.device;
  return measure(resolved, verbosity, std::move(context));
}

std::vector<Option> options_of(SurveyOptions& o) {
  return {{{"output", &o.output, "Folder for all.json and the images"}, "FOLDER", 'o', Completion::file},
          {{"scenes", &o.scenes, "Scenes, separated by commas; empty: all built-in scenes and those in --folder"},
           "NAMES",
           0,
           Completion::scene,
           true},
          {{"techniques", &o.techniques,
            "Techniques, or slots for all of their choices, separated by commas; empty: all (--list)"},
           "NAMES",
           0,
           Completion::none,
           true},
          {{"list", &o.list, "List scenes and techniques"}},
          {{"time-limit",
            &o.time_limit_s,
            "Begin no scene after this time; 0: none. The same command then measures the other scenes",
            {.min = 0, .max = 1e6, .unit = "s"}}},
          {{"folder", &o.folder, "Folder with further scenes, each as NAME/NAME.gltf, such as sponza/sponza.gltf"},
           "FOLDER",
           0,
           Completion::file},
          {{"threads", &o.threads, "Worker threads; 0: one per core", {.min = 0, .max = 1024}}},
          {{"device", &o.device,
            "Device that renders: cpu; cuda or cuda:N, an NVIDIA GPU (relume devices lists them); auto, the first "
            "usable GPU, else cpu"},
           "DEVICE"},
          {{"quick", &o.quick, "Small images and few frames, to check that everything runs"}},
          {{"cache-dir", &o.cache_folder,
            "Folder for cached references, in references/; without it, $XDG_CACHE_HOME/relume or ~/.cache/relume"},
           "FOLDER",
           0,
           Completion::file}};
}

}  // namespace

Command survey_command(Verbosity& verbosity) {
  const auto options = std::make_shared<SurveyOptions>();
  Command command{
      .name = "survey",
      .summary = "Measure every technique in every scene.",
      .examples = {{"relume survey -o out", "all techniques in all built-in scenes"},
                   {"relume survey -o out --scenes corridor,mine --techniques cache,guide", "all caches and guides"},
                   {"relume survey -o out --folder scenes --time-limit 60min", "with Sponza, in parts of an hour"}},
      .arguments = {},
      .options = options_of(*options),
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options, &verbosity] { return run(*options, verbosity); },
      .folders = {kReferenceFolder},
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli
