#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/frame_sequence.h"
#include "cli/machine.h"
#include "cli/platform.h"
#include "cli/preparation_progress.h"
#include "cli/progress.h"
#include "cli/scene_source.h"
#include "compare/comparison.h"
#include "compare/comparison_page.h"
#include "compare/frame_timing.h"
#include "core/clock.h"
#include "files/atomic_file.h"
#include "files/bytes.h"
#include "files/extension.h"
#include "frame/launch.h"
#include "ranks/launcher.h"
#include "ranks/task_pool.h"
#include "render/build_pipeline.h"

namespace relume::cli {
namespace {

struct CompareOptions {
  std::string scene;
  std::string output;
  std::string techniques;
  std::string images;
  float budget_s = 0;
  std::string frames;
  float fps = 24;
  int repetitions = 5;
  std::string reference;
  int reference_spp = 1024;
  std::string reference_settings;
  std::string cache_folder;
  int timed_frames = 0;  ///< 0: errors are measured
  std::vector<std::pair<std::string, std::string>> flags;
};

/// Makes a folder, and removes it if nothing was written into it.
class NewFolder {
 public:
  explicit NewFolder(std::filesystem::path folder) : folder_(std::move(folder)), made_(make_output_folder(folder_)) {}
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code not_empty;
    if (made_) std::filesystem::remove(folder_, not_empty);
  }

 private:
  std::filesystem::path folder_;
  bool made_;
};

/// The three files that a comparison writes.
struct OutputFiles {
  std::filesystem::path page;
  std::filesystem::path json;
  std::filesystem::path csv;
  std::unique_ptr<NewFolder> folder;  ///< nullptr if a page was named
};

OutputFiles output_files(const CompareOptions& o) {
  const std::string output = o.output.empty() ? std::filesystem::path(o.scene).stem().string() + "-compare" : o.output;
  const bool names_page = lower_extension(output) == ".html";
  OutputFiles files;
  if (!names_page) files.folder = std::make_unique<NewFolder>(output);
  files.page = names_page ? std::filesystem::path(output) : std::filesystem::path(output) / "compare.html";
  files.json = files.csv = files.page;
  files.json.replace_extension(".json");
  files.csv.replace_extension(".csv");
  for (const std::filesystem::path& file : {files.page, files.json, files.csv}) check_output_file(file);
  return files;
}

/// Throws UsageError if results would overwrite their inputs.
void check_roles(const OutputFiles& files, const CompareOptions& o, const ComparisonOptions& options,
                 const Scene& scene) {
  FileRoles roles;
  roles.reads("SCENE", o.scene);
  roles.reads("SCENE", scene.source_files);
  roles.reads("--reference", o.reference);
  roles.reads("--env", resolve(options.common).scene.env);
  for (const Contender& contender : options.contenders) roles.reads("--techniques", contender.file);
  for (const ImageContender& image : options.images) roles.reads("--image", image.file);
  for (const std::filesystem::path& output : {files.page, files.json, files.csv}) roles.writes("-o", output);
}

/// The default contenders: plain path tracing and the best techniques for a moving camera.
constexpr const char* kUsualTechniques = "default,interactive";

/// Comparison options, before the scene is loaded.
ComparisonOptions comparison_options(const CompareOptions& o) {
  ComparisonOptions options;
  options.scene_name = std::filesystem::path(o.scene).stem().string();
  options.images = parse_image_contenders(o.images, "--image");
  if (!o.techniques.empty() || options.images.empty())
    options.contenders = parse_contenders(o.techniques.empty() ? kUsualTechniques : o.techniques, "--techniques");
  for (const ImageContender& image : options.images) {
    for (const Contender& contender : options.contenders) {
      if (image.name == contender.name)
        throw UsageError(
            fmt::format("two contenders are called '{}'; rename the image with --image NAME=FILE", image.name));
    }
    if (const std::string reason = missing_reason(image.file); !reason.empty())
      throw Error(fmt::format("{}: the file of --image {}; check its path", image.file.string(), reason));
  }
  options.common.flags = o.flags;
  const AllSettings common = resolve(options.common);
  for (const Contender& contender : options.contenders) resolve_contender(contender, options.common);
  if (o.budget_s > 0 && common.stop.spp > 0)
    throw UsageError("--spp compares at equal samples and --budget at equal time; choose one");
  if (common.stop.time_s > 0) throw UsageError("compare has no --time; use --budget to compare at equal time");
  if (common.stop.error > 0)
    throw UsageError("compare has no --error; use --spp to compare at equal samples, or --budget at equal time");
  options.spp = common.stop.spp > 0 ? common.stop.spp : o.frames.empty() ? kDefaultSpp : 1;
  options.budget_s = static_cast<double>(o.budget_s);
  options.repetitions = o.repetitions;
  options.reference_file = o.reference;
  options.reference_spp = o.reference_spp;
  options.reference_settings = parse_settings(o.reference_settings, "--reference-settings");
  if (!o.reference.empty() && !options.reference_settings.empty())
    throw UsageError("--reference reads an image, and --reference-settings is for a rendered reference; choose one");
  resolve_reference(options.common, {}, options.reference_settings);
  if (o.reference.empty() && o.timed_frames == 0) options.cache_folder = reference_folder(o.cache_folder);
  options.program = program_stamp();
  return options;
}

std::vector<float> frame_times(const CompareOptions& o, float scene_time_s) {
  if (o.frames.empty()) return {};
  const FrameRange range = parse_frame_range(o.frames, "--frames");
  std::vector<float> times;
  for (int frame = range.first; frame <= range.last; ++frame) times.push_back(frame_time_s(frame, o.fps, scene_time_s));
  return times;
}

/// Rejects options that timing alone does not use.
void check_timing(const CompareOptions& o) {
  const std::pair<const char*, bool> others[] = {
      {"--output", !o.output.empty()},       {"--image", !o.images.empty()},
      {"--budget", o.budget_s > 0},          {"--frames", !o.frames.empty()},
      {"--reference", !o.reference.empty()}, {"--reference-settings", !o.reference_settings.empty()}};
  for (const auto& [name, given] : others) {
    if (given) throw UsageError(fmt::format("--timing compares no images; remove {}", name));
  }
}

/// Shows on a terminal the current step. Returns std::nullopt if interrupted.
std::optional<Comparison> compare_with_progress(const Scene& scene, const ComparisonOptions& options,
                                                const std::stop_token& stop, const Verbosity& verbosity,
                                                SharedWork* ranks) {
  ProgressPrinter printer(!verbosity.quiet);
  const PreparationProgress preparation(!verbosity.quiet);
  return compare(
      scene, options, stop, [&](const std::string& stage, double fraction) { printer.show_stage(stage, fraction); },
      ranks);
}

int run_timing(const CompareOptions& o, const ComparisonOptions& options, const Scene& scene,
               const Verbosity& verbosity) {
  std::vector<TimedContender> contenders;
  for (const Contender& contender : options.contenders)
    contenders.push_back({contender.name, resolve_contender(contender, options.common).render});
  const InterruptGuard interrupts(interrupt_notice(verbosity, "this step"));
  ProgressPrinter printer(!verbosity.quiet);
  const PreparationProgress preparation(!verbosity.quiet);
  const auto timings = time_frames(scene, contenders, o.timed_frames, interrupts.token(),
                                   [&](double fraction) { printer.show_stage("timing", fraction); });
  printer.clear();
  if (!timings) {
    log_info(verbosity, "interrupted");
    return kExitInterrupted;
  }
  std::fputs(to_csv(*timings).c_str(), stdout);
  return kExitDone;
}

/// The scene as the contenders render it; adds the scene's own settings to `options`.
Scene open_compared_scene(const CompareOptions& o, ComparisonOptions& options, const Verbosity& verbosity) {
  Scene scene = open_scene(o.scene, !verbosity.quiet);
  warn_all(verbosity, scene);
  options.common.scene_json = scene.settings_json;
  options.common.scene_place = o.scene;
  const AllSettings common = resolve(options.common);
  override_scene(common.scene, scene, !verbosity.quiet);
  AllSettings fitted = common;
  fit_to_camera(fitted, options.common, scene);
  options.common.flags.emplace_back("width", std::to_string(fitted.render.width));
  options.common.flags.emplace_back("height", std::to_string(fitted.render.height));
  options.times_s = frame_times(o, common.render.time_s);
  // Checks the combination with the scene's own settings before the reference is rendered, which may be slow.
  for (const Contender& contender : options.contenders)
    check_combination(resolve_contender(contender, options.common).render);
  check_combination(resolve_reference(options.common, {}, options.reference_settings).settings.render);
  return scene;
}

/// The setting --device of the reference and of each contender.
std::vector<std::string> devices_of(const ComparisonOptions& options) {
  std::vector<std::string> devices{
      resolve_reference(options.common, {}, options.reference_settings).settings.render.device};
  for (const Contender& contender : options.contenders)
    devices.push_back(resolve_contender(contender, options.common).render.device);
  return devices;
}

/// Compares and writes. `ranks`: those that share the work, of which this is the first; nullptr: this process alone.
int compare_and_write(const CompareOptions& o, const Verbosity& verbosity, SharedWork* ranks) {
  ComparisonOptions options = comparison_options(o);
  const Scene scene = open_compared_scene(o, options, verbosity);
  const OutputFiles files = output_files(o);  // a missing scene leaves no folder
  check_roles(files, o, options, scene);

  const InterruptGuard interrupts(interrupt_notice(verbosity, "this step"));
  const double start_s = now_s();
  const std::optional<Comparison> comparison =
      compare_with_progress(scene, options, interrupts.token(), verbosity, ranks);
  if (!comparison) {
    log_info(verbosity, "interrupted; the same command reuses finished references and continues an unfinished one");
    return kExitInterrupted;
  }
  const auto machine = machine_description(devices_of(options));
  write_files({{files.json, to_json(*comparison, machine)},
               {files.csv, to_csv(*comparison)},
               {files.page, to_html(comparison_page(*comparison, machine))}});
  for (const std::string& note : comparison->notes) warn(note);
  std::fputs(to_csv(*comparison).c_str(), stdout);
  log_info(verbosity, fmt::format("wrote {} in {}", files.page.string(), format_duration(now_s() - start_s)));
  return kExitDone;
}

/// Runs tasks of the first rank, which alone writes and prints.
int compare_as_worker(const CompareOptions& o, SharedWork& ranks) {
  const Verbosity quiet{.quiet = true};
  ComparisonOptions options = comparison_options(o);
  const Scene scene = open_compared_scene(o, options, quiet);
  const InterruptGuard interrupts("");  // the first rank decides what an interrupt ends
  compare_with_progress(scene, options, {}, quiet, &ranks);
  return kExitDone;
}

int compare_on_ranks(const CompareOptions& o, const Verbosity& verbosity, ranks::Launch launch) {
  std::optional<ranks::TaskPool> pool;
  try {
    pool.emplace("the same command reuses finished references");
  } catch (const Error&) {
    if (launch.rank == 0) throw;
    return kExitFailed;  // rank 0 has the same error
  }
  return pool->run_and_end([&] {
    if (o.timed_frames > 0) throw UsageError("--timing measures one process; start it without mpirun");
    if (o.budget_s > 0) launch.local_size = 1;  // only one rank of a machine is timed
    const ThreadLimit limit(ranks::threads_of_rank(launch));
    return pool->is_first() ? compare_and_write(o, verbosity, &*pool) : compare_as_worker(o, *pool);
  });
}

int run_compare(const CompareOptions& o, const Verbosity& verbosity) {
  const std::optional<ranks::Launch> launch = ranks::find_launch();
  if (launch && launch->size > 1) return compare_on_ranks(o, verbosity, *launch);
  if (o.timed_frames == 0) return compare_and_write(o, verbosity, nullptr);
  check_timing(o);
  ComparisonOptions options = comparison_options(o);
  const Scene scene = open_compared_scene(o, options, verbosity);
  return run_timing(o, options, scene, verbosity);
}

std::vector<Option> declare(CompareOptions& o) {
  return {
      {{"output", &o.output,
        "Folder for compare.html, compare.json and compare.csv, or FILE.html; without it, SCENE-compare"},
       "FOLDER",
       'o',
       Completion::file},
      {{"techniques", &o.techniques,
        "Contenders, separated by commas: presets, techniques, settings files, NAME=KEY:VALUE,KEY:VALUE or "
        "NAME=PRESET,KEY:VALUE; 'default' is all defaults; without it, default,interactive"},
       "LIST",
       0,
       Completion::preset,
       true},
      {{"image", &o.images, "Image of another renderer or version, as another column; can be given several times"},
       "NAME=FILE",
       0,
       Completion::file,
       true},
      {{"budget",
        &o.budget_s,
        "Compare at equal time: 50ms, 2s; without it at equal samples (--spp, or 64, or 1 per frame of --frames)",
        {.min = 0, .max = 1e6, .unit = "s"}}},
      {{"frames", &o.frames, "Compare along these frames of the animation; techniques keep their history"}, "A-B"},
      {{"fps", &o.fps, "Frames per second of --frames", {.min = 0.001, .max = 100000}}},
      {{"repeat",
        &o.repetitions,
        "Repetitions with separate seeds, for medians, bias and variance",
        {.min = 1, .max = 1000}}},
      {{"reference", &o.reference, "Use this image as the reference instead of rendering one"},
       "FILE",
       0,
       Completion::file},
      {{"reference-spp", &o.reference_spp, "Samples per pixel of the reference", {.min = 2, .max = 1 << 24}}},
      {{"reference-settings", &o.reference_settings,
        "Settings of the reference alone, such as lights:light-tree; flags that could bias it do not apply to it"},
       "KEY:VALUE",
       0,
       Completion::none,
       true},
      {{"timing",
        &o.timed_frames,
        "Only time this many frames of each contender, alternately, after a quarter as many warm-up frames; prints "
        "milliseconds and the ratio to the first contender, with 95 % intervals",
        {.min = 0, .max = 1 << 20}},
       "FRAMES"},
      {{"cache-dir", &o.cache_folder,
        "Folder for cached references, in references/; without it, $XDG_CACHE_HOME/relume or ~/.cache/relume"},
       "FOLDER",
       0,
       Completion::file},
  };
}

}  // namespace

Command compare_command(Verbosity& verbosity) {
  const auto options = std::make_shared<CompareOptions>();
  const auto defaults = std::make_shared<AllSettings>();
  Command command{
      .name = "compare",
      .summary = "Compare techniques on a scene, against a reference and each other.",
      .examples =
          {
              {"relume compare scene.glb --budget 2s --width 640 --height 360",
               "interactive against plain path tracing after two seconds each; the page is in scene-compare"},
              {"relume compare scene.glb --techniques default,psf,apg,bmfr", "techniques by their names"},
              {"relume compare cornell --techniques uniform=lights:uniform,power=lights:power -o out",
               "64 samples each"},
              {"relume compare scene.glb --techniques default,mine.json --budget 2s -o out", "two seconds each"},
              {"relume compare turntable --techniques a=history:none,b=history:accumulate --frames 0-47 -o out",
               "along an animation, with flicker"},
              {"relume compare scene.glb --techniques default,psf,vlc --timing 64", "frame times"},
              {"relume compare scene.glb --techniques default --image cycles=cycles.exr -o out",
               "with an image of another renderer"},
              {"mpirun -n 4 relume compare scene.glb --spp 256", "on four ranks"},
          },
      .arguments = {{"SCENE", &options->scene, "Scene file or built-in scene", true, Completion::scene}},
      .options = declare(*options),
      .setting_groups = setting_groups(*defaults),
      .setting_flags = &options->flags,
      .run = [options, defaults, &verbosity] { return run_compare(*options, verbosity); },
      .folders = {kReferenceFolder},
      .essentials = {"output", "techniques", "budget", "spp", "width", "height", "frames", "image", "reference",
                     "reference-spp"},
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli
