#include "ranks/frame_job.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/image.h"
#include "cli/progress.h"
#include "cli/reports.h"
#include "core/clock.h"
#include "ranks/frame_dealer.h"
#include "ranks/frame_image.h"
#include "ranks/hosts.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/sample_parts.h"
#include "render/session.h"
#include "render/stop_criteria.h"

namespace relume::ranks {
namespace {

/// Images of frames that wait for earlier ones take about this many bytes at most.
constexpr size_t kWaitingBytes = size_t{2} << 30;
constexpr size_t kLongestSegment = 64;
constexpr double kWait_s = 0.5;

/// Whether frames depend on earlier ones.
bool uses_earlier_frames(const RenderSettings& s) {
  return samples_adapt(s) || s.history == HistoryChoice::reproject || s.cache != CacheChoice::none ||
         s.denoise != DenoiseChoice::none || s.allocation != AllocationChoice::uniform || upscales(s);
}

class FrameWorker {
 public:
  FrameWorker(const cli::RenderOptions& options, cli::RenderSetup& setup, RankLink& link)
      : options_(options), setup_(setup), link_(link), session_(*setup.session) {
    link_.on_interrupt([this](const Message& message) {
      if (message.kind == MessageKind::finish) stop_.request_stop();
    });
  }
  ~FrameWorker() { link_.on_interrupt({}); }
  FrameWorker(const FrameWorker&) = delete;
  FrameWorker& operator=(const FrameWorker&) = delete;

  void run() {
    while (!stop_.stop_requested()) {
      const std::optional<Message> message = link_.receive_at_worker(1);
      if (!message) continue;
      if (message->kind == MessageKind::finish) return;  // it came before the hook
      if (message->kind != MessageKind::deal) continue;
      render(MessageReader(message->content).get<Segment>());
      if (!stop_.stop_requested()) link_.send(0, MessageKind::done);
    }
  }

 private:
  void render(const Segment& segment) {
    const RenderSettings& settings = render_settings(session_);
    const auto warmup = uses_earlier_frames(settings) ? static_cast<size_t>(options_.warmup) : 0;
    const bool continues = position_ == segment.first;
    const size_t begin = continues ? segment.first : segment.first - std::min(segment.first, warmup);
    if (!continues) {
      session_.set_time(time_of(begin - std::min(begin, size_t{1})));  // motion is that since the frame before
      session_.restart(settings.seed);
    }
    for (size_t frame = begin; frame < segment.first + segment.count; ++frame) {
      session_.set_time(time_of(frame));
      session_.begin_image();
      position_.reset();
      RenderLimits limits = stop_criteria(setup_.settings.stop);
      limits.completes_first_frame = false;
      if (render_until(session_, limits, stop_.get_token(), {}) == StopReason::interrupted) return;
      position_ = frame + 1;
      const bool is_seam = !continues && frame == segment.first && uses_earlier_frames(settings);
      if (frame >= segment.first) send(frame, is_seam ? std::optional(segment.first - begin) : std::nullopt);
    }
  }

  float time_of(size_t frame) const { return time_of_image(options_, setup_.plan, setup_.scene_time_s, frame); }

  /// `warmup`: frames before a segment's first one, whose file states it.
  void send(size_t index, const std::optional<size_t>& warmup) {
    FrameImage frame;
    frame.index = index;
    frame.samples = session_.image_samples();
    frame.render_s = session_.image_render_s();
    frame.rays = session_.statistics().rays - rays_;
    rays_ = session_.statistics().rays;
    frame.in_studio = session_.in_studio();
    const Image image = session_.image();
    frame.exr = ExrFile{image.width, image.height, exr_channels(image),
                        cli::image_metadata(session_, options_.scene, setup_.settings, setup_.load_s),
                        render_settings(session_).crop};
    if (warmup) frame.exr.attributes["relume.warmup"] = std::to_string(*warmup);
    for (const std::string& name : setup_.plan.aovs) {
      for (ExrChannel& channel : session_.aov(name)) frame.exr.channels.push_back(std::move(channel));
    }
    while (!link_.wait_until_sent(kWait_s)) {  // at most one image waits in memory
      if (stop_.stop_requested()) return;
    }
    link_.send(0, MessageKind::image, to_message(frame));
  }

  const cli::RenderOptions& options_;
  cli::RenderSetup& setup_;
  RankLink& link_;
  Session& session_;
  std::stop_source stop_;
  std::optional<size_t> position_ = 0;  ///< frame that the session would render next; it begins at the first
  uint64_t rays_ = 0;
};

class FrameCoordinator {
 public:
  explicit FrameCoordinator(const RanksRun& run)
      : run_(run),
        hosts_(run.link.size(), run.identity),
        writer_(run.options, run.setup, run.identity),
        ready_(static_cast<size_t>(run.link.size()), false),
        busy_(ready_) {
    std::error_code failure;
    if (std::filesystem::exists(run.options.checkpoint, failure)) {
      writer_.resume();
      log_info(run.verbosity, fmt::format("continues from {} after {} of {} images", run.options.checkpoint,
                                          writer_.next(), run.setup.plan.files.size()));
    }
    const RenderSettings& s = render_settings(*run.setup.session);
    const size_t image_bytes = static_cast<size_t>(s.width) * static_cast<size_t>(s.height) * sizeof(float) *
                               (3 + 3 * run.setup.plan.aovs.size());
    const size_t waiting = kWaitingBytes / image_bytes / (2 * static_cast<size_t>(run.link.size()));
    dealer_.emplace(writer_.next(), run.setup.plan.files.size(), run.link.size(),
                    std::clamp(waiting, size_t{1}, kLongestSegment));
  }

  /// Returns whether all frames are written.
  bool run() {
    cli::ProgressPrinter printer(!run_.verbosity.quiet);
    const double start_s = now_s();
    const size_t first = writer_.next();
    const size_t all = run_.setup.plan.files.size();
    while (!dealer_->complete() && problem_.empty() && !run_.stop.stop_requested()) {
      double wait_s = 0.05;
      for (int left = run_.link.size(); left > 0; --left) {  // images may arrive as fast as they are written
        std::optional<Message> message = run_.link.receive_at_coordinator(wait_s);
        if (!message) break;
        handle(*message, printer);
        message.reset();  // its memory is free for the next image
        deal_to_idle();
        wait_s = 0;
      }
      if (const std::optional<int> lost = run_.link.lost_rank(); lost && problem_.empty())
        problem_ = fmt::format("{} cannot be reached any more", hosts_.name_of(*lost));
      const size_t done = writer_.next() - first;
      const double elapsed_s = now_s() - start_s;
      printer.show(
          {.label = fmt::format("{} of {} images, {} ranks", writer_.next(), all, std::ranges::count(ready_, true)),
           .fraction = static_cast<double>(writer_.next()) / static_cast<double>(all),
           .rays_per_s = static_cast<double>(rays_) / std::max(elapsed_s, 1e-9),
           .remaining_s =
               elapsed_s * static_cast<double>(all - writer_.next()) / static_cast<double>(std::max(done, size_t{1})),
           .shows_samples = false},
          now_s());
    }
    printer.clear();
    writer_.finish();
    return dealer_->complete();
  }

  const std::string& problem() const { return problem_; }
  size_t written() const { return writer_.next(); }

 private:
  void handle(const Message& message, cli::ProgressPrinter& printer) {
    const auto rank = static_cast<size_t>(message.from);
    if (message.kind == MessageKind::hello) {
      const std::string difference = hosts_.add(message);
      ready_[rank] = difference.empty();
      if (problem_.empty()) problem_ = difference;
    } else if (message.kind == MessageKind::done) {
      busy_[rank] = false;
      dealer_->finished(message.from);
    } else if (message.kind == MessageKind::failed) {
      problem_ = fmt::format("{}: {}", hosts_.name_of(message.from), MessageReader(message.content).get_text());
    } else if (message.kind == MessageKind::image) {
      FrameImage frame = frame_of_message(message.content);
      rays_ += frame.rays;
      if (!dealer_->received(frame.index)) return;
      const size_t next = writer_.next();
      const size_t count = writer_.add(std::move(frame));
      if (count == 0) return;
      printer.clear();
      for (size_t i = next; i < next + count; ++i)
        log_info(run_.verbosity, fmt::format("wrote {}", run_.setup.plan.files[i].string()));
    }
  }

  void deal_to_idle() {
    for (size_t rank = 0; rank < ready_.size(); ++rank) {
      if (!ready_[rank] || busy_[rank]) continue;
      const std::optional<Segment> segment = dealer_->next(static_cast<int>(rank));
      if (!segment) continue;
      busy_[rank] = true;
      run_.link.send(static_cast<int>(rank), MessageKind::deal, MessageWriter().put(*segment).take());
    }
  }

  const RanksRun& run_;
  HostList hosts_;
  FrameWriter writer_;
  std::optional<FrameDealer> dealer_;
  std::vector<bool> ready_;
  std::vector<bool> busy_;
  uint64_t rays_ = 0;
  std::string problem_;
};

}  // namespace

void run_frame_worker(const cli::RenderOptions& options, cli::RenderSetup& setup, RankLink& link) {
  FrameWorker(options, setup, link).run();
}

RanksEnd run_frame_job(const RanksRun& run) {
  FrameCoordinator coordinator(run);
  bool complete = false;
  std::exception_ptr failure;
  std::thread coordination([&] {
    try {
      complete = coordinator.run();
    } catch (...) {
      failure = std::current_exception();
    }
    for (int rank = 0; rank < run.link.size(); ++rank) run.link.send(rank, MessageKind::finish);
  });
  std::exception_ptr own_failure;
  try {
    run_frame_worker(run.options, run.setup, run.link);
  } catch (const std::exception& error) {
    own_failure = std::current_exception();
    run.link.send(0, MessageKind::failed, MessageWriter().put_text(error.what()).take());
  }
  coordination.join();
  if (own_failure) std::rethrow_exception(own_failure);
  if (failure) std::rethrow_exception(failure);
  if (complete) return {cli::kExitDone};
  if (coordinator.problem().empty()) {
    cli::log_info(run.verbosity,
                  fmt::format("interrupted after {} of {} images", coordinator.written(), run.setup.plan.files.size()));
    return {cli::kExitInterrupted};
  }
  return {cli::kExitFailed, fmt::format("{}; {} of {} images are written{}", coordinator.problem(),
                                        coordinator.written(), run.setup.plan.files.size(),
                                        run.options.checkpoint.empty() ? "" : "; the same command renders the others")};
}

}  // namespace relume::ranks
