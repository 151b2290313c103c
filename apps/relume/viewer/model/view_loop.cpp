#include "viewer/model/view_loop.h"

#include <algorithm>
#include <utility>

#include "viewer/model/actions.h"

namespace relume::viewer {
namespace {

constexpr double kNumbers_s = 0.5;       // interval at which displayed rates change, to be readable
constexpr double kLongestFrame_s = 0.1;  // by which animations advance

}  // namespace

void ViewLoop::begin_frame(double now_s) {
  state_.now_s = now_s;
  passed_s_ = std::min(now_s - last_s_, kLongestFrame_s);
  last_s_ = now_s;
  std::erase_if(state_.toasts, [&](const Toast& toast) { return toast.until_s < state_.now_s; });
  take_frames();
  take_notices();
}

void ViewLoop::advance() {
  follow_files(state_);
  finish_loading(state_);
  finish_pick(state_);
  update_animation(state_, passed_s_);
  update_path(state_);
}

void ViewLoop::take_frames() {
  for (int side = 0; side < kSides; ++side) {
    const auto s = static_cast<size_t>(side);
    if (side >= state_.sides()) {
      state_.frames[s].reset();
      state_.times[s] = {};
      continue;
    }
    std::shared_ptr<const ViewerFrame> frame = renderer_.frame(side);
    if (!frame || (state_.frames[s] && frame->serial == state_.frames[s]->serial)) continue;
    state_.frames[s] = std::move(frame);
    state_.times[s].add(*state_.frames[s]);
    if (side > 0) continue;
    monitor_.rendered_frame(state_.now_s);
    newest_frame_s_ = state_.now_s;
    if (state_.document) choose_mode(state_);
    if (state_.frame()->request_version >= release_version_) state_.awaits_camera = false;
  }
  const auto shows_document = [&](const auto& frame) { return frame && frame->scene == state_.document->loaded(); };
  if (state_.document && std::all_of(state_.frames.begin(), state_.frames.begin() + state_.sides(), shows_document))
    state_.previous.reset();
  for (; !camera_moves_.empty(); camera_moves_.pop_front()) {
    const uint64_t seen = renderer_.first_frame_following(camera_moves_.front().first);
    if (seen == 0) break;
    monitor_.camera_seen(seen - camera_moves_.front().second);
  }
  if (state_.now_s - numbers_s_ < kNumbers_s) return;
  numbers_s_ = state_.now_s;
  state_.frames_per_s = monitor_.frames_per_s();
  state_.interface_hz = monitor_.interface_hz();
}

void ViewLoop::take_notices() {
  for (const Notice& notice : renderer_.take_notices()) {
    if (notice.problem && first_problem_.empty()) first_problem_ = notice.text;
    if (notice.failed_task && failed_task_.empty()) failed_task_ = notice.text;
    if (notice.device_lost && device_loss_.empty()) device_loss_ = notice.text;
    state_.notify(notice.text, notice.problem);
    if (notice.refused_scene && state_.document && notice.refused_scene == state_.document->loaded())
      revert_document(state_);
  }
}

void ViewLoop::post() {
  if (!state_.request_changed || !state_.document) return;
  if (state_.image_changed) ++image_version_;
  state_.request_changed = state_.image_changed = false;
  const uint64_t camera = state_.document->edits().camera.version;
  ++version_;
  if (std::exchange(state_.camera_released, false)) {
    state_.awaits_camera = true;
    release_version_ = version_;
  }
  const auto newest = renderer_.frame(0);  // may be newer than the displayed one
  if (camera != camera_version_ && newest) camera_moves_.emplace_back(version_, newest->serial);
  camera_version_ = camera;
  state_.navigation.pace.posted(version_);
  renderer_.post(make_request(state_, version_, image_version_));
}

}  // namespace relume::viewer
