#include "cli/render_job.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/image.h"
#include "cli/platform.h"
#include "cli/progress.h"
#include "cli/render_plan.h"
#include "cli/render_setup.h"
#include "cli/reports.h"
#include "cli/tev_display.h"
#include "cli/version.h"
#include "cli/video.h"
#include "core/clock.h"
#include "files/atomic_file.h"
#include "files/extension.h"
#include "files/temporary_file.h"
#include "ranks/ranks_job.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/display.h"
#include "render/session.h"
#include "render/stop_criteria.h"

namespace relume::cli {
namespace {

enum class DeviceErrors { shown, thrown };

/// Calls `step`, and warns of its error. `of_device`: what happens with that of a GPU that is lost.
template <typename F>
void attempt(DeviceErrors of_device, const F& step) {
  try {
    step();
  } catch (const std::exception& error) {
    const auto* const known = dynamic_cast<const Error*>(&error);
    if (of_device == DeviceErrors::thrown && known && known->code() == ErrorCode::device) throw;
    warn(error.what());
  }
}

class RenderJob {
 public:
  RenderJob(const RenderOptions& options, const Verbosity& verbosity, RenderPlan plan)
      : options_(options), verbosity_(verbosity), plan_(std::move(plan)), display_(options.display, options.scene) {}

  int run() {
    load();  // an interrupt ends it at once: there is nothing to save
    const InterruptGuard interrupts(interrupt_notice(verbosity_, "this sample"));
    tell_more(verbosity_, fmt::format("built it in {:.2f} s; {} threads", session_->statistics().build_s,
                                      session_->statistics().threads));
    StopReason reason = StopReason::samples;
    for (size_t i = first_image_; i < plan_.files.size() && reason != StopReason::interrupted; ++i) {
      reason = render_or_keep(i, interrupts.token());
      // An image that was complete at the interrupt stays complete, and the next one does not start.
      const bool last = i + 1 == plan_.files.size();
      if (!last && interrupts.token().stop_requested()) reason = StopReason::interrupted;
    }
    if (video_) video_->finish();
    report(reason);
    return reason == StopReason::interrupted ? kExitInterrupted : kExitDone;
  }

 private:
  void load();
  void resume();
  size_t image_of_checkpoint() const;
  StopReason render_or_keep(size_t index, const std::stop_token& stop);
  StopReason render_image(size_t index, std::stop_token stop);
  void frame_done(size_t index, const RenderProgress& state, const RenderLimits& criteria, ProgressPrinter& printer);
  void keep(size_t index, StopReason reason);
  void save_checkpoint();
  void try_checkpoint(size_t index);
  void copy_image(size_t index);
  void keep_finished(size_t index);
  void write(size_t index, std::string_view verb);
  void write_image_file(const std::filesystem::path& file);
  Display display_of_image();
  void report(StopReason reason) const;

  bool is_still() const { return options_.frames.empty(); }
  float time_of(size_t index) const { return time_of_image(options_, plan_, scene_time_s_, index); }

  const RenderOptions& options_;
  const Verbosity& verbosity_;
  RenderPlan plan_;
  TevDisplay display_;
  AllSettings settings_;
  float scene_time_s_ = 0;  ///< of frame 0
  std::optional<Session> session_;
  size_t first_image_ = 0;  ///< greater than 0 if a sequence is resumed
  std::optional<VideoWriter> video_;
  int video_images_ = 0;       ///< images in video_
  uint64_t resumed_rays_ = 0;  ///< rays from the checkpoint: times cover only this run
  std::vector<std::string> written_;
  std::optional<float> last_exposure_;  ///< of the previous image, if exposures are automatic
  double load_s_ = 0;
  double write_s_ = 0;
  double last_checkpoint_s_ = 0;
  std::unique_ptr<PendingFile> copy_;  ///< see copy_image()
  double copied_samples_ = 0;          ///< Session::image_samples() of the copy

  double rays_per_s() const {
    const Statistics& s = session_->statistics();
    return static_cast<double>(s.rays - resumed_rays_) / std::max(s.render_s, 1e-9);
  }
};

void RenderJob::load() {
  RenderSetup setup = set_up_render(options_, verbosity_, std::move(plan_));
  plan_ = std::move(setup.plan);
  settings_ = std::move(setup.settings);
  scene_time_s_ = setup.scene_time_s;
  load_s_ = setup.load_s;
  session_ = std::move(setup.session);
  if (std::error_code failure; std::filesystem::exists(options_.checkpoint, failure)) resume();
}

void RenderJob::resume() {
  session_->load_checkpoint(options_.checkpoint);
  resumed_rays_ = session_->statistics().rays;
  first_image_ = image_of_checkpoint();
  check_earlier_images(plan_, first_image_, options_.checkpoint);
  log_info(verbosity_,
           fmt::format("continues from {} at {} samples per pixel{}", options_.checkpoint,
                       format_samples(session_->image_samples()),
                       options_.frames.empty()
                           ? ""
                           : fmt::format(" of frame {}", plan_.frames.first + static_cast<int>(first_image_))));
  if (first_image_ > 0) log_info(verbosity_, "images of earlier frames are kept");
}

size_t RenderJob::image_of_checkpoint() const {
  for (size_t i = 0; i < plan_.files.size(); ++i) {
    if (time_of(i) == render_settings(*session_).time_s) return i;
  }
  throw Error(fmt::format(
      "{}: the checkpoint was made at time {} s, which is not requested; use the same frames or time, or delete it",
      options_.checkpoint, render_settings(*session_).time_s));
}

/// After an error of the GPU, keeps what is finished.
StopReason RenderJob::render_or_keep(size_t index, const std::stop_token& stop) {
  try {
    return render_image(index, stop);
  } catch (const DeviceMemoryError&) {
    keep_finished(index);
    throw;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::device) keep_finished(index);
    throw;
  }
}

StopReason RenderJob::render_image(size_t index, std::stop_token stop) {
  if (index > first_image_) {
    session_->set_time(time_of(index));
    session_->begin_image();  // even if nothing has moved
  }
  const RenderLimits criteria = stop_criteria(settings_.stop);
  last_checkpoint_s_ = now_s();
  ProgressPrinter printer(!verbosity_.quiet);
  printer.show_stage("first sample", 0);
  const auto done = [&](const RenderProgress& state) { frame_done(index, state, criteria, printer); };
  const StopReason reason = render_until(*session_, criteria, stop, done);
  printer.clear();
  display_.show(*session_);
  keep(index, reason);
  return reason;
}

void RenderJob::frame_done(size_t index, const RenderProgress& state, const RenderLimits& criteria,
                           ProgressPrinter& printer) {
  printer.show(
      {
          .label = plan_.files.size() > 1 ? fmt::format("image {} of {}", index + 1, plan_.files.size()) : "",
          .samples = static_cast<uint32_t>(state.samples),
          .samples_wanted = criteria.samples,
          .fraction = fraction_done(state, criteria),
          .rays_per_s = rays_per_s(),
          .error = state.error,
          .remaining_s = remaining_s(state, criteria),
      },
      now_s());
  if (now_s() - last_checkpoint_s_ >= static_cast<double>(options_.checkpoint_interval_s)) try_checkpoint(index);
  if (display_.due()) display_.show(*session_);
}

/// Image and checkpoint may lie on different disks: a full disk only affects the files on it.
void RenderJob::keep(size_t index, StopReason reason) {
  std::exception_ptr problem;
  try {
    write(index, reason == StopReason::interrupted ? "interrupted; wrote" : "wrote");
  } catch (...) {
    problem = std::current_exception();
  }
  save_checkpoint();
  if (problem) std::rethrow_exception(problem);
}

void RenderJob::save_checkpoint() {
  // Samples taken with incomplete light lists differ from those of an uninterrupted render.
  if (options_.checkpoint.empty() || !session_->prepared()) return;
  session_->save_checkpoint(options_.checkpoint);
}

/// Saves a checkpoint and a copy during an image: a full disk or a lack of memory must not abort the image.
void RenderJob::try_checkpoint(size_t index) {
  attempt(DeviceErrors::thrown, [&] { save_checkpoint(); });
  attempt(DeviceErrors::thrown, [&] { copy_image(index); });
  last_checkpoint_s_ = now_s();
}

/// Writes a copy of an incomplete image beside its file, for keep_finished(): the memory of a GPU that is lost cannot
/// be read. Sequences have none, because an image with fewer samples than the others could go unnoticed.
void RenderJob::copy_image(size_t index) {
  if (!is_still() || settings_.render.device == "cpu" || !session_->statistics().device) return;
  auto copy = std::make_unique<PendingFile>(plan_.files[index]);
  if (!is_temporary_file(copy->path())) return;  // a pipe
  write_image_file(copy->path());
  copy_ = std::move(copy);
  copied_samples_ = session_->image_samples();
}

/// Completes a video with its earlier images. Writes the complete samples of a still image, or else its last copy.
void RenderJob::keep_finished(size_t index) {
  constexpr std::string_view kFailed = "the GPU failed; wrote";
  const std::string file = plan_.files[index].string();
  if (video_ && video_images_ > 0) {
    attempt(DeviceErrors::shown, [&] {
      video_->finish();
      log_info(verbosity_,
               fmt::format("the GPU failed; {} ends with frame {}", file, plan_.frames.first + video_images_ - 1));
    });
  }
  if (!is_still() || !written_.empty()) return;
  attempt(DeviceErrors::shown, [&] {
    if (device_is_lost(*session_) || session_->image_samples() <= 0) return;
    write(index, kFailed);  // no checkpoint: it could contain parts of the frame that failed
  });
  if (!written_.empty() || !copy_) return;
  attempt(DeviceErrors::shown, [&] {
    copy_->commit();
    log_info(verbosity_, fmt::format("{} {} with {}", kFailed, file, samples_text(copied_samples_)));
  });
}

/// In a sequence, an automatic exposure adapts from image to image.
Display RenderJob::display_of_image() {
  Display display = display_for(settings_.output, cropped_image(*session_).pixels, session_->in_studio());
  if (settings_.output.exposure || is_still()) return display;
  if (last_exposure_) display.exposure = adapted_exposure(*last_exposure_, display.exposure, 1.0f / options_.fps);
  last_exposure_ = display.exposure;
  return display;
}

void RenderJob::write_image_file(const std::filesystem::path& file) {
  const Metadata metadata = image_metadata(*session_, options_.scene, settings_, load_s_);
  const bool is_displayed = lower_extension(file) != ".exr" && lower_extension(file) != ".hdr";
  write_image(file, *session_, is_displayed ? display_of_image() : Display{}, plan_.aovs, metadata, plan_.ocio.get());
}

/// `verb`: for the message, such as "wrote".
void RenderJob::write(size_t index, std::string_view verb) {
  const double start_s = now_s();
  const std::filesystem::path& file = plan_.files[index];
  if (is_video_file(file)) {
    const Display display = display_of_image();
    const Image image = displayed_image(*session_, display, plan_.ocio.get());
    if (!video_) video_.emplace(file, image.width, image.height, options_.fps);
    video_->add(image);
    ++video_images_;
    if (index == first_image_) written_.push_back(file.string());
  } else {
    write_image_file(file);
    written_.push_back(file.string());
  }
  copy_.reset();
  write_s_ += now_s() - start_s;
  const std::string what =
      is_video_file(file) ? fmt::format("frame {} of {}", plan_.frames.first + static_cast<int>(index), file.string())
                          : file.string();
  log_info(verbosity_, fmt::format("{} {} with {}", verb, what, samples_text(session_->image_samples())));
}

void RenderJob::report(StopReason reason) const {
  const Statistics& statistics = session_->statistics();
  const uint32_t pilot = pilot_samples(settings_.render);
  if (pilot > 0 && session_->frames_since_change() <= pilot)
    warn(
        fmt::format("rendering ended within the {} pilot frames of adaptive sampling, so the image is biased; give it "
                    "more time, or lower --adaptive.max",
                    pilot));
  if (statistics.nonfinite_samples > 0)
    warn(fmt::format("{} of {} samples were not finite and count as black; please report the scene",
                     format_count(statistics.nonfinite_samples), format_count(statistics.samples)));
  if (!session_->prepared()) {
    warn(fmt::format("rendering stopped before the light lists were complete: the image is noisier{}; raise --time",
                     options_.checkpoint.empty() ? "" : " and no checkpoint was written"));
  }
  for (const std::string& warning : session_->warnings()) warn(warning);
  tell_more(verbosity_,
            fmt::format("stopped by {} after {:.2f} s; {} samples, {} rays, {:.1f} Mrays/s, at most {} of memory",
                        name_of(reason), statistics.render_s, format_count(statistics.samples),
                        format_count(statistics.rays), rays_per_s() * 1e-6, format_bytes(peak_memory_bytes())));
  if (options_.stats.empty()) return;
  RunReport run{
      .version = kVersion,
      .scene = options_.scene,
      .width = settings_.render.width,
      .height = settings_.render.height,
      .crop = settings_.render.crop,
      .samples_per_pixel = session_->image_samples(),
      .stopped_by = name_of(reason),
      .estimated_error = session_->estimated_error(),
      .load_s = load_s_,
      .build_s = statistics.build_s,
      .accel_s = statistics.accel_s,
      .render_s = statistics.render_s,
      .write_s = write_s_,
      .samples = statistics.samples,
      .paths = statistics.paths,
      .rays = statistics.rays,
      .nonfinite_samples = statistics.nonfinite_samples,
      .threads = statistics.threads,
      .peak_memory_bytes = peak_memory_bytes(),
      .scene_bytes = statistics.scene_bytes,
      .buffer_bytes = statistics.buffer_bytes,
      .technique_bytes = statistics.technique_bytes,
      .files = written_,
      .passes = statistics.passes,
      .figures = {},
      .device = statistics.device,
  };
  for (const PassStatistic& figure : statistics.pass_statistics) run.figures.emplace_back(figure.name, figure.value);
  write_file(options_.stats, to_json(run));
}

}  // namespace

int run_render(const RenderOptions& options, const Verbosity& verbosity) {
  if (ranks::runs_on_ranks(options)) return ranks::run_on_ranks(options, verbosity);
  return RenderJob(options, verbosity, make_plan(options)).run();
}

}  // namespace relume::cli
