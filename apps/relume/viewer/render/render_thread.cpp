#include "viewer/render/render_thread.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "cli/platform.h"
#include "core/clock.h"
#include "framebuffer/auto_exposure.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "render/stop_criteria.h"
#include "render/timed_stop.h"
#include "viewer/render/inspect.h"

namespace relume::viewer {
namespace {

constexpr size_t kMostFollowed = 256;

/// Time of each pass since `before`, and "other" for the remainder.
std::vector<PassTime> differences(const std::vector<PassTime>& now, const std::vector<PassTime>& before,
                                  double seconds) {
  std::vector<PassTime> result = pass_times_since(now, before);
  std::erase_if(result, [](const PassTime& pass) { return pass.seconds <= 0 || pass.name == "build"; });
  double sum = 0;
  for (const PassTime& pass : result) sum += pass.seconds;
  result.push_back({"other", std::max(0.0, seconds - sum)});
  return result;
}

/// The value of the first slot that has one.
std::optional<double> first_of(const std::array<SessionSlot, kSides>& slots,
                               std::optional<double> (SessionSlot::*value)() const) {
  for (const SessionSlot& slot : slots) {
    if (const std::optional<double> found = (slot.*value)()) return found;
  }
  return std::nullopt;
}

}  // namespace

RenderThread::RenderThread() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

RenderThread::~RenderThread() { stop(); }

void RenderThread::stop() {
  thread_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    refinement_.request_stop();
    hurry_.request_stop();
  }
  if (thread_.joinable()) thread_.join();
}

void RenderThread::post(RenderRequest request) {
  const std::lock_guard lock(mutex_);
  wanted_ = std::move(request);
  refinement_.request_stop();
  hurry_.request_stop();
  wake_.notify_one();
}

void RenderThread::post_task(Task task) {
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  wake_.notify_one();
}

std::optional<double> RenderThread::compiling_since_s() const {
  return first_of(slots_, &SessionSlot::compiling_since_s);
}

std::optional<double> RenderThread::updating_since_s() const {
  return first_of(slots_, &SessionSlot::updating_since_s);
}

std::shared_ptr<const ViewerFrame> RenderThread::frame(int side) const {
  const std::lock_guard lock(mutex_);
  return frames_[static_cast<size_t>(side)];
}

uint64_t RenderThread::first_frame_following(uint64_t version) const {
  const std::lock_guard lock(mutex_);
  const auto first =
      std::find_if(followed_.begin(), followed_.end(), [&](const auto& entry) { return entry.first >= version; });
  return first == followed_.end() ? 0 : first->second;
}

std::vector<Notice> RenderThread::take_notices() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notices_, {});
}

void RenderThread::add_notice(Notice notice) {
  const std::lock_guard lock(mutex_);
  notices_.push_back(std::move(notice));
}

void RenderThread::run(const std::stop_token& stop) {
  cli::lower_thread_priority();
  while (wait_for_work(stop)) {
    try {
      run_tasks();
      render_round(stop);
    } catch (const DeviceMemoryError& error) {
      refused_version_ = request_.version;
      add_notice({true, error.what(), request_.scene});
    } catch (const std::bad_alloc&) {
      refused_version_ = request_.version;
      add_notice({true, "out of memory; try a smaller size or scene", request_.scene});
    } catch (const std::exception& error) {
      refused_version_ = request_.version;
      add_notice({.problem = true,
                  .text = error.what(),
                  .refused_scene = request_.scene != slots_[0].scene() ? request_.scene : nullptr,
                  .device_lost = has_lost_device()});
    }
  }
  finish_tasks();
}

void RenderThread::finish_tasks() {
  try {
    Session* session = slots_[0].session();
    if (session && !ready_for_tasks() && tasks_wait()) {
      std::stop_source hurry;
      hurry.request_stop();
      session->shorten_preparation_on(hurry.get_token());
      session->render_frame();
    }
    run_tasks();
  } catch (const std::exception& error) {
    add_notice({true, error.what()});
  }
  if (tasks_wait()) {
    add_notice({.problem = true,
                .text = "no image was rendered for the last request",
                .refused_scene = nullptr,
                .failed_task = true});
  }
}

bool RenderThread::has_lost_device() const {
  return std::any_of(slots_.begin(), slots_.end(),
                     [](const SessionSlot& slot) { return slot.session() && device_is_lost(*slot.session()); });
}

bool RenderThread::tasks_wait() const {
  const std::lock_guard lock(mutex_);
  return !tasks_.empty();
}

bool RenderThread::ready_for_tasks() const {
  return slots_[0].session() && slots_[0].session()->frames_since_change() > 0;
}

bool RenderThread::wait_for_work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto due = [&] {
    if (wanted_.version != request_.version) return true;
    if (!tasks_.empty() && ready_for_tasks()) return true;
    const bool refused = refused_version_ == wanted_.version;
    return wanted_.scene && !wanted_.paused && !goal_reached_ && !refused;
  };
  wake_.wait(lock, stop, due);
  if (stop.stop_requested()) return false;
  if (wanted_.version != request_.version) {
    if (wanted_.image_version != request_.image_version) changed_s_ = now_s();
    request_ = wanted_;
    goal_reached_ = false;
  }
  return true;
}

void RenderThread::run_tasks() {
  if (!ready_for_tasks()) return;
  std::unique_lock lock(mutex_);
  const auto tasks = std::exchange(tasks_, {});
  lock.unlock();
  for (const auto& task : tasks) {
    try {
      task(*slots_[0].session(), *slots_[0].scene());
    } catch (const std::exception& error) {
      add_notice({.problem = true,
                  .text = error.what(),
                  .refused_scene = nullptr,
                  .failed_task = true,
                  .device_lost = has_lost_device()});
    }
  }
}

bool RenderThread::at_rest() const {
  return request_.resolution_policy.full_at_rest &&
         now_s() - changed_s_ > static_cast<double>(request_.resolution_policy.rest_after_s);
}

bool RenderThread::may_upscale() const {
  const ResolutionPolicy& policy = request_.resolution_policy;
  // Without a denoiser that has its own history, filled pixels would look worse than a smaller image.
  const auto permits = [](const AllSettings& side) {
    RenderSettings upscaled = side.render;
    upscaled.upscaling.factor = 2;
    return side.render.upscaling.factor == 1 && denoiser_fills(upscaled) && refusal(upscaled).empty();
  };
  return policy.hold_rate && policy.upscale && permits(request_.settings[0]) &&
         (!request_.split || permits(request_.settings[1]));
}

FrameScale RenderThread::choose_scale(bool rest) {
  const RenderSettings& render = request_.settings[0].render;
  const IVec2 full(render.width, render.height);
  const bool upscales = may_upscale();
  resolution_.allow_upscaling(upscales);
  FrameScale scale{.size = full, .upscale = 1, .switches_upscaling = upscales};
  if (!request_.resolution_policy.hold_rate || rest) return scale;
  scale.size = rested_ ? resolution_.first_frame_size(full) : resolution_.size(full);
  scale.upscale = resolution_.upscale();
  return scale;
}

void RenderThread::note_size(const IVec2& size, double seconds, bool rest) {
  const ResolutionPolicy& policy = request_.resolution_policy;
  const IVec2 full(request_.settings[0].render.width, request_.settings[0].render.height);
  resolution_.measured(seconds, size);
  const bool is_first = std::exchange(rested_, rest);
  if (policy.hold_rate && !rest && !is_first)
    resolution_.frame_done(seconds, 1.0 / static_cast<double>(policy.target_hz), full);
}

void RenderThread::render_round(const std::stop_token& stop) {
  if (!request_.scene || goal_reached_ || refused_version_ == request_.version) return;
  if (request_.paused && frame(0) && frame(0)->request_version == request_.version) return;
  // Decided once, because applying the request, such as moving many triangles, may itself take longer than the moment.
  const bool rest = at_rest();
  const FrameScale scale = choose_scale(rest);
  const double start_s = now_s();
  const int sides = request_.split ? 2 : 1;
  if (sides == 1) close_second_side();
  for (int side = 0; side < sides; ++side) {
    if (stop.stop_requested()) return;
    if (render_side(stop, side, scale, rest)) continue;
    rested_ = rested_ || rest;
    return;
  }
  note_size(scale.size, now_s() - start_s, rest);
  goal_reached_ = frame(0)->reached_goal && (sides == 1 || frame(1)->reached_goal);
}

void RenderThread::close_second_side() {
  slots_[1].close();
  const std::lock_guard lock(mutex_);
  frames_[1].reset();
}

bool RenderThread::render_side(const std::stop_token& stop, int side, const FrameScale& scale, bool rest) {
  SessionSlot& slot = slots_[static_cast<size_t>(side)];
  slot.update(request_, side, scale);
  Session& session = *slot.session();
  std::stop_token token;
  std::stop_token hurry;
  {
    const std::lock_guard lock(mutex_);
    if (stop.stop_requested()) return false;
    refinement_ = std::stop_source();
    hurry_ = std::stop_source();
    if (wanted_.version != request_.version) hurry_.request_stop();
    hurry = hurry_.get_token();
    // A large first frame after a rest may be cancelled too: the displayed image follows the same request.
    if (session.frames_since_change() > 0 || (request_.resolution_policy.hold_rate && rest)) {
      // A newer request may have arrived during compilation or while settings were applied.
      if (wanted_.version != request_.version) return false;
      token = refinement_.get_token();
    }
  }
  std::optional<TimedStop> preparation;
  if (session.frames_since_change() == 0 || !session.prepared()) {
    preparation.emplace(hurry, static_cast<double>(request_.resolution_policy.preparation_s));
    hurry = preparation->token();
  }
  session.shorten_preparation_on(hurry);
  const uint64_t rays_before = session.statistics().rays;
  const std::vector<PassTime> passes_before = session.statistics().passes;
  const double start_s = now_s();
  if (!session.render_frame(token)) return false;
  publish(side, now_s() - start_s, rays_before, passes_before);
  return true;
}

void RenderThread::take_image(Session& session, ViewerFrame& frame) const {
  frame.width = render_settings(session).width;
  frame.height = render_settings(session).height;
  if (keeps_images_on_device_ && request_.buffer.empty()) frame.device_image = copy_device_image(session);
  if (frame.device_image) {
    frame.metered_exposure = meter_device_image(session);
    return;
  }
  frame.radiance = session.image().pixels;
  frame.metered_exposure = auto_exposure(frame.radiance);
}

void RenderThread::publish(int side, double seconds, uint64_t rays_before, const std::vector<PassTime>& passes_before) {
  SessionSlot& slot = slots_[static_cast<size_t>(side)];
  Session& session = *slot.session();
  auto frame = std::make_shared<ViewerFrame>();
  take_image(session, *frame);
  frame->serial = ++serials_[static_cast<size_t>(side)];
  frame->request_version = request_.version;
  frame->scene = slot.scene();
  frame->full_width = request_.settings[0].render.width;
  frame->upscale = render_settings(session).upscaling.factor;
  frame->in_studio = session.in_studio();
  frame->statistics = session.statistics();
  frame->samples = session.kept_samples();
  frame->seconds = seconds;
  frame->rays_per_s = static_cast<double>(frame->statistics.rays - rays_before) / std::max(seconds, 1e-9);
  frame->passes = differences(frame->statistics.passes, passes_before, seconds);
  frame->camera = session.camera();
  frame->time_s = render_settings(session).time_s;
  frame->notes = session.notes();
  frame->buffers = inspectable_buffers(render_settings(session));
  read_buffer(session, request_.buffer, *frame);
  frame->reached_goal = goal_reached(side);
  {
    const std::lock_guard lock(mutex_);
    if (side == 0) followed_.emplace_back(frame->request_version, frame->serial);
    if (followed_.size() > kMostFollowed) followed_.pop_front();
    frames_[static_cast<size_t>(side)] = std::move(frame);
  }
  if (frame_hook_) frame_hook_();
}

bool RenderThread::has_final_size(const Session& session) const {
  if (!request_.resolution_policy.hold_rate || !request_.resolution_policy.full_at_rest) return true;
  const RenderSettings& wanted = request_.settings[0].render;
  return render_settings(session).width == wanted.width && render_settings(session).height == wanted.height;
}

bool RenderThread::goal_reached(int side) {
  const StopSettings& goal = request_.settings[static_cast<size_t>(side)].stop;
  const Session& session = *slots_[static_cast<size_t>(side)].session();
  const bool accurate = error_reached(side);  // first, as it follows every frame
  if (!has_final_size(session)) return false;
  if (goal.spp > 0 && session.image_samples() >= static_cast<double>(goal.spp)) return true;
  if (goal.time_s > 0 && now_s() - changed_s_ >= static_cast<double>(goal.time_s)) return true;
  return accurate;
}

bool RenderThread::error_reached(int side) {
  const float limit = request_.settings[static_cast<size_t>(side)].stop.error;
  const Session& session = *slots_[static_cast<size_t>(side)].session();
  const uint32_t frames = session.frames_since_change();
  ErrorVerdict& verdict = verdicts_[static_cast<size_t>(side)];
  if (frames <= verdict.frames || limit != verdict.limit) verdict = {limit, 0, false};
  verdict.frames = frames;
  if (limit > 0 && !verdict.met && checks_error_at(frames))
    verdict.met = session.estimated_error() <= static_cast<double>(limit);
  return verdict.met;
}

}  // namespace relume::viewer
