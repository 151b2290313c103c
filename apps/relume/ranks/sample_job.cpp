#include "ranks/sample_job.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/image.h"
#include "cli/platform.h"
#include "cli/progress.h"
#include "cli/reports.h"
#include "cli/version.h"
#include "core/clock.h"
#include "files/atomic_file.h"
#include "files/extension.h"
#include "ranks/sample_coordinator.h"
#include "relume/error.h"
#include "render/display.h"
#include "render/sample_blocks.h"
#include "render/sample_parts.h"
#include "render/session.h"
#include "render/stop_criteria.h"

namespace relume::ranks {
namespace {

/// Layers that follow from sums. Others show one frame.
constexpr std::array<std::string_view, 7> kSummedLayers = {"variance", "albedo",  "normal",   "depth",
                                                           "heatmap",  "samples", "nonfinite"};

SampleJob job_of(const RanksRun& run) {
  const Session& session = *run.setup.session;
  const RenderSettings& settings = render_settings(session);
  if (const std::string refused = sums_refusal(settings); !refused.empty())
    throw cli::UsageError(fmt::format("an image cannot be rendered on several ranks: {}", refused));
  SampleJob job;
  job.image.width = settings.width;
  job.image.height = settings.height;
  job.image.window = settings.crop.empty() ? PixelWindow{0, 0, settings.width, settings.height} : settings.crop;
  job.image.attributes = cli::image_metadata(session, run.options.scene, run.setup.settings, run.setup.load_s);
  job.image.surface = settings.auxiliary;
  job.adapt = samples_adapt(settings);
  job.limits = stop_criteria(run.setup.settings.stop);
  job.checkpoint = run.options.checkpoint;
  job.checkpoint_interval_s = static_cast<double>(run.options.checkpoint_interval_s);
  job.identity = run.identity;
  return job;
}

void resume(SampleCoordinator& coordinator, const RanksRun& run) {
  const std::string& file = run.options.checkpoint;
  if (std::error_code failure; !std::filesystem::exists(file, failure)) return;
  if (!is_sums_file(file)) {
    throw Error(fmt::format(
        "{}: this is the checkpoint of a render without mpirun; continue without mpirun, or delete it", file));
  }
  coordinator.resume();
  cli::log_info(run.verbosity, fmt::format("continues from {} at {}", file, cli::samples_text(coordinator.samples())));
}

/// Coordinates in a thread, while this one renders rank 0's share: devices belong to the thread of their session.
StopReason render(SampleCoordinator& coordinator, const RanksRun& run) {
  const RenderLimits limits = stop_criteria(run.setup.settings.stop);
  cli::ProgressPrinter printer(!run.verbosity.quiet);
  printer.show_stage("first sample", 0);
  const auto show = [&](const RanksProgress& state) {
    printer.show(
        {
            .label = state.ranks > 1 ? fmt::format("{} ranks", state.ranks) : "",
            .samples = static_cast<uint32_t>(state.render.samples),
            .samples_wanted = limits.samples,
            .fraction = fraction_done(state.render, limits),
            .rays_per_s = state.rays_per_s,
            .error = state.render.error,
            .remaining_s = remaining_s(state.render, limits),
        },
        now_s());
  };
  StopReason reason = StopReason::samples;
  std::exception_ptr failure;
  std::thread coordination([&] {
    try {
      reason = coordinator.run(run.stop, show);
    } catch (...) {
      failure = std::current_exception();
    }
  });
  std::exception_ptr own_failure;
  try {
    SampleWorker(*run.setup.session, run.link).run();
  } catch (const std::exception& error) {
    own_failure = std::current_exception();
    run.link.send(0, MessageKind::failed, MessageWriter().put_text(error.what()).take());
  }
  coordination.join();
  printer.clear();
  if (own_failure) std::rethrow_exception(own_failure);
  if (failure) std::rethrow_exception(failure);
  return reason;
}

/// Renders what layers of single frames show: motion is that of the first sample, others are of the last.
void render_frame_layers(Session& session, const std::vector<std::string>& aovs, uint32_t samples) {
  const bool any = std::any_of(aovs.begin(), aovs.end(), [](const std::string& name) {
    return std::find(kSummedLayers.begin(), kSummedLayers.end(), name) == kSummedLayers.end();
  });
  if (!any || samples_adapt(render_settings(session))) return;
  begin_samples(session, 0);
  session.render_frame();
  if (samples < 2) return;
  skip_samples(session, samples - 1);
  session.render_frame();
}

void write_report(const RanksRun& run, StopReason reason, double error, double write_s) {
  const Statistics& statistics = run.setup.session->statistics();
  if (statistics.nonfinite_samples > 0)
    cli::warn(fmt::format("{} of {} samples were not finite and count as black; please report the scene",
                          cli::format_count(statistics.nonfinite_samples), cli::format_count(statistics.samples)));
  for (const std::string& warning : run.setup.session->warnings()) cli::warn(warning);
  if (run.options.stats.empty()) return;
  const RenderSettings& settings = render_settings(*run.setup.session);
  cli::RunReport report;
  report.version = cli::kVersion;
  report.scene = run.options.scene;
  report.width = settings.width;
  report.height = settings.height;
  report.crop = settings.crop;
  report.samples_per_pixel = run.setup.session->image_samples();
  report.stopped_by = name_of(reason);
  report.estimated_error = error;
  report.load_s = run.setup.load_s;
  report.build_s = statistics.build_s;
  report.accel_s = statistics.accel_s;
  report.render_s = statistics.render_s;
  report.write_s = write_s;
  report.samples = report.paths = statistics.samples;
  report.rays = statistics.rays;
  report.nonfinite_samples = statistics.nonfinite_samples;
  report.threads = statistics.threads;
  report.peak_memory_bytes = cli::peak_memory_bytes();
  report.scene_bytes = statistics.scene_bytes;
  report.buffer_bytes = statistics.buffer_bytes;
  report.technique_bytes = statistics.technique_bytes;
  report.files = {run.setup.plan.files.front().string()};
  report.passes = statistics.passes;
  report.device = statistics.device;
  write_file(run.options.stats, to_json(report));
}

/// Returns the seconds that it took.
double write_output(const RanksRun& run) {
  const double start_s = now_s();
  const Session& session = *run.setup.session;
  const std::filesystem::path& file = run.setup.plan.files.front();
  const std::string extension = lower_extension(file);
  Display display;
  if (extension != ".exr" && extension != ".hdr")
    display = display_for(run.setup.settings.output, cli::cropped_image(session).pixels, session.in_studio());
  const cli::Metadata metadata = cli::image_metadata(session, run.options.scene, run.setup.settings, run.setup.load_s);
  cli::write_image(file, session, display, run.setup.plan.aovs, metadata, run.setup.plan.ocio.get());
  return now_s() - start_s;
}

}  // namespace

RanksEnd run_sample_job(const RanksRun& run) {
  SampleCoordinator coordinator(run.link, job_of(run));
  if (!run.options.checkpoint.empty()) resume(coordinator, run);
  const StopReason reason = render(coordinator, run);
  const uint32_t samples = coordinator.samples();
  const std::string& problem = coordinator.problem();
  if (samples == 0) {
    if (!problem.empty()) return {cli::kExitFailed, problem};
    return {cli::kExitInterrupted};
  }
  const double error = coordinator.complete_image();
  Session& session = *run.setup.session;
  if (reason != StopReason::interrupted) render_frame_layers(session, run.setup.plan.aovs, samples);
  set_samples(session, coordinator.sums(), samples);
  const double write_s = write_output(run);
  const std::string file = run.setup.plan.files.front().string();
  const bool interrupted = reason == StopReason::interrupted;
  cli::log_info(run.verbosity, fmt::format("{} {} with {}", interrupted ? "interrupted; wrote" : "wrote", file,
                                           cli::samples_text(session.image_samples())));
  write_report(run, reason, error, write_s);
  if (const std::string& unsaved = coordinator.save_problem(); !unsaved.empty())
    return {cli::kExitFailed, problem.empty() ? unsaved : fmt::format("{}; {}", problem, unsaved)};
  if (problem.empty()) return {interrupted ? cli::kExitInterrupted : cli::kExitDone};
  return {cli::kExitFailed, fmt::format("{}; {}", problem, way_to_continue(run.options))};
}

std::string way_to_continue(const cli::RenderOptions& options) {
  if (options.checkpoint.empty()) return "use --resume FILE.ckpt to be able to continue such a render";
  return fmt::format("continue from {} with the same command", options.checkpoint);
}

}  // namespace relume::ranks
