#include "serve/model.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <exception>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/clock.h"
#include "relume/error.h"
#include "serve/documents.h"
#include "serve/frame_encoder.h"
#include "viewer/model/actions.h"

namespace relume::serve {
namespace {

using viewer::kSides;

constexpr float kImageHeight = 1000;    // units of navigate() per height of the image
constexpr double kHeld_s = 1;           // until held keys count as released
constexpr double kLeastTurn_s = 0.008;  // between turns
constexpr double kMovingTurn_s = 1.0 / 60;
constexpr double kIdleTurn_s = 0.1;
constexpr double kStatus_s = 0.25;  // between texts of the status
constexpr size_t kMostPending = 256;

/// Whether the text is three numbers with commas between them.
bool is_radiance(std::string_view text) {
  for (int channel = 0; channel < 3; ++channel) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    float value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{}) return false;
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    if (channel == 2) return text.empty();
    if (!text.starts_with(',')) return false;
    text.remove_prefix(1);
  }
  return false;
}

void check_side(const std::string& name, const std::string& value) {
  int side = 0;
  const auto [end, failure] = std::from_chars(value.data(), value.data() + value.size(), side);
  if (failure == std::errc{} && end == value.data() + value.size() && side <= kMostSide) return;
  throw Error(fmt::format("{} is '{}', but must be an integer up to {} in a page", name, value, kMostSide));
}

bool same_images(const ShownImage& a, const ShownImage& b) {
  return a.frames == b.frames && a.transforms == b.transforms && a.split_at == b.split_at;
}

}  // namespace

void check_page_value(const AllSettings& start, const std::string& name, const std::string& value) {
  if (name == "width" || name == "height") return check_side(name, value);
  if (name != "env" || value.empty() || value == start.scene.env || is_radiance(value)) return;
  for (const char* known : {"studio", "sky", "sun_sky", "none"}) {
    if (value == known) return;
  }
  throw Error(fmt::format("env: a page cannot name the file '{}'; start the server with --env", value));
}

IVec2 image_size(const Resize& area) {
  return {std::clamp(area.width / 2 * 2, kLeastSide, kMostSide),
          std::clamp(area.height / 2 * 2, kLeastSide, kMostSide)};
}

Model::Model(const ModelOptions& options, std::shared_ptr<const viewer::LoadedScene> scene, viewer::OcioDisplay ocio,
             Inbox& inbox, Publisher& publisher)
    : inbox_(inbox),
      publisher_(publisher),
      start_(options.settings),
      renders_unwatched_(options.renders_unwatched),
      loop_(state_, renderer_) {
  state_.renderer = &renderer_;
  renderer_.on_frame([this] { inbox_.wake(); });
  state_.settings = {options.settings, options.settings};
  state_.ocio = std::move(ocio);
  state_.follow_window = !options.fixed_size;
  state_.resolution_policy.target_hz = options.target_hz;
  state_.watches = options.watch;
  state_.now_s = now_s();
  show_document(state_, std::move(scene), true);
  loop_.start(state_.now_s);
  publisher_.tell(Topic::declarations, declarations_text(state_));
}

void Model::run(const std::stop_token& stop) {
  const std::stop_callback wakes(stop, [this] { inbox_.wake(); });
  double turned_s = 0;
  while (!stop.stop_requested()) {
    const double early_s = turned_s + kLeastTurn_s - now_s();
    if (early_s > 0) std::this_thread::sleep_for(std::chrono::duration<double>(early_s));
    turned_s = now_s();
    turn(turned_s);
    if (!loop_.device_loss().empty()) throw Error(ErrorCode::device, loop_.device_loss());
    if (!edited_ && !state_.frame() && !loop_.first_problem().empty()) throw Error(loop_.first_problem());
    inbox_.wait(wait_s());
  }
}

double Model::wait_s() const {
  if (state_.unwatched) return kIdleTurn_s;
  const bool moves = held_.axes != Vec3(0) || state_.animating || state_.path.playing;
  return moves ? kMovingTurn_s : kIdleTurn_s;
}

void Model::turn(double now_s) {
  loop_.begin_frame(now_s);
  follow_viewers();
  if (!state_.unwatched) loop_.advance();
  newest_number_ = 0;
  for (const Input& input : inbox_.take()) take(input);
  if (now_s > held_until_s_) held_ = {};
  if (state_.document) navigate(state_, held_.axes, held_.fast, kImageHeight);
  loop_.post();
  loop_.monitor().interface_frame(now_s);
  follow_inputs();
  show_image();
  tell_texts();
}

/// Pauses while no viewer is connected. The rendering thread still renders one frame of each request, so that errors of
/// the scene appear at the start, and the next viewer has an image at once.
void Model::follow_viewers() {
  const bool unwatched = !renders_unwatched_ && inbox_.viewers() == 0;
  if (unwatched == state_.unwatched) return;
  state_.unwatched = unwatched;
  state_.request_changed = true;
}

void Model::take(const Input& input) {
  if (input.message.number > 0) {
    newest_viewer_ = input.viewer;
    newest_number_ = input.message.number;
  }
  if (std::holds_alternative<Fly>(input.message.body)) held_by_ = input.viewer;
  if (std::holds_alternative<Left>(input.message.body) && input.viewer != held_by_) return;
  try {
    act(input.message.body);
  } catch (const std::exception& error) {
    state_.notify(error.what(), true);
    has_news_ = true;
  }
}

void Model::act(const MessageBody& body) {
  if (const auto* drag = std::get_if<Drag>(&body)) {
    (drag->pan ? state_.navigation.pan_px : state_.navigation.turn_px) += drag->by * kImageHeight;
    return;
  }
  if (const auto* wheel = std::get_if<Wheel>(&body)) {
    state_.navigation.notches = std::clamp(state_.navigation.notches + wheel->notches, -50.0f, 50.0f);
    return;
  }
  if (const auto* fly = std::get_if<Fly>(&body)) {
    held_ = *fly;
    held_until_s_ = state_.now_s + kHeld_s;
    return;
  }
  if (std::holds_alternative<Left>(body)) held_ = {};
  has_news_ = true;
  edited_ = edited_ || std::holds_alternative<ChangeSetting>(body) || std::holds_alternative<ApplyPreset>(body);
  if (const auto* setting = std::get_if<ChangeSetting>(&body)) change(*setting);
  if (const auto* preset = std::get_if<ApplyPreset>(&body)) apply_preset(state_, preset->side, preset->name);
  if (const auto* size = std::get_if<Resize>(&body)) resize(*size);
  if (const auto* use = std::get_if<UseBookmark>(&body)) use_bookmark(*use);
  if (const auto* pressed = std::get_if<Press>(&body)) press(pressed->button);
  if (const auto* split = std::get_if<MoveSplit>(&body)) state_.split_at = std::clamp(split->at, 0.02f, 0.98f);
  if (const auto* buffer = std::get_if<ShowBuffer>(&body)) {
    state_.buffer = buffer->name;
    state_.inspector.automatic = true;
    state_.request_changed = true;
  }
}

void Model::change(const ChangeSetting& change) {
  check_page_value(start_, change.name, change.value);
  // B's settings can be edited before it is shown.
  change_setting(state_, change.side, change.name, change.value);
}

void Model::press(Button button) {
  const auto expose = [&](float stops) {
    for (size_t side = 0; side < state_.settings.size(); ++side) {
      std::optional<float>& exposure = state_.settings[side].output.exposure;
      exposure = clamp(exposure.value_or(state_.automatic_exposure[side]) + stops, -64, 64);
    }
  };
  switch (button) {
    case Button::pause:
      state_.paused = !state_.paused;
      state_.request_changed = true;
      return;
    case Button::home: return release_camera(state_);
    case Button::split: return set_split(state_, !state_.split);
    case Button::orbit:
      return set_mode(state_, state_.navigation.mode == viewer::CameraMode::orbit ? viewer::CameraMode::fly
                                                                                  : viewer::CameraMode::orbit);
    case Button::frame: return frame_selection(state_);
    case Button::animate: state_.animating = !state_.animating; return;
    case Button::darker: return expose(-0.5f);
    case Button::brighter: return expose(0.5f);
    case Button::copy: state_.settings[1] = state_.settings[0]; return state_.touch();
    case Button::swap: std::swap(state_.settings[0], state_.settings[1]); return state_.touch();
  }
}

void Model::use_bookmark(const UseBookmark& use) {
  const auto slot = static_cast<size_t>(use.slot);
  if (use.verb == BookmarkVerb::go) return go_to_bookmark(state_, slot);
  if (use.verb == BookmarkVerb::store) {
    if (std::min(slot, state_.bookmarks.size()) >= kMostBookmarks)
      throw Error(fmt::format("there are {} bookmarks; remove one first", kMostBookmarks));
    return store_bookmark(state_, slot);
  }
  if (slot >= state_.bookmarks.size()) return;
  state_.bookmarks.erase(state_.bookmarks.begin() + use.slot);
  save_bookmarks(state_);
}

void Model::resize(const Resize& size) {
  if (!state_.follow_window) return;
  const IVec2 wanted = image_size(size);
  if (IVec2(state_.settings[0].render.width, state_.settings[0].render.height) == wanted) return;
  for (AllSettings& settings : state_.settings) {
    settings.render.width = wanted.x;
    settings.render.height = wanted.y;
  }
  state_.touch();
}

void Model::follow_inputs() {
  if (newest_number_ > 0) {
    pending_.push_back({loop_.version(), newest_viewer_, newest_number_});
    if (pending_.size() > kMostPending) pending_.pop_front();
  }
  const uint64_t shown = state_.frame() ? state_.frame()->request_version : 0;
  for (; !pending_.empty() && pending_.front().version <= shown; pending_.pop_front()) {
    followed_viewer_ = pending_.front().viewer;
    followed_number_ = pending_.front().number;
  }
}

void Model::show_image() {
  if (!state_.frame() || !state_.ocio.ready()) return;
  auto image = std::make_shared<ShownImage>();
  for (int side = 0; side < state_.sides(); ++side) {
    const auto s = static_cast<size_t>(side);
    if (!state_.frames[s]) continue;
    display_.update(state_, side);
    image->frames[s] = state_.frames[s];
    image->transforms[s] = display_.transform(state_, side);
  }
  image->split_at = state_.split && image->frames[1] ? state_.split_at : 1;
  if (image_ && same_images(*image, *image_)) return;
  image->ocio = state_.ocio;
  image->version = image_ ? image_->version + 1 : 1;
  image->viewer = followed_viewer_;
  image->input = followed_number_;
  image_ = image;
  publisher_.show(image_);
}

void Model::tell_texts() {
  if (!has_news_ && state_.now_s - status_s_ < kStatus_s) return;
  has_news_ = false;
  status_s_ = state_.now_s;
  if (std::string key = values_key(state_); key != values_) {
    values_ = std::move(key);
    publisher_.tell(Topic::values, values_text(state_));
  }
  publisher_.tell(Topic::status, status_text(state_));
}

}  // namespace relume::serve
