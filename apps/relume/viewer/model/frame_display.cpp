#include "viewer/model/frame_display.h"

#include <string>

#include "render/display.h"

namespace relume::viewer {
namespace {

/// Colours and range that suit the buffer of a frame.
void choose_automatically(const ViewerFrame& frame, DisplayTransform& d) {
  d.range = frame.value_range;
  d.channel = frame.channels.size() == 1 ? 0 : -1;
  const bool color = frame.channels == "RGB";
  d.mode = frame.channels == "XYZ" ? DisplayMode::direction : color ? DisplayMode::color : DisplayMode::false_color;
  if (frame.buffer == "radiance") d.mode = DisplayMode::radiance;
  if (frame.channels == "XY") d.range = {0, max(1.0f, frame.value_range.y)};
  if (color) d.range = {0, max(1.0f, frame.value_range.y)};
}

}  // namespace

/// Exposes a new scene at once; afterwards, the exposure adapts to the frames.
void FrameDisplay::adapt_exposure(State& state, size_t side) {
  const ViewerFrame& frame = *state.frames[side];
  float& exposure = state.automatic_exposure[side];
  const bool is_new = exposed_scene_[side] != frame.scene.get();
  const auto seconds = static_cast<float>(state.now_s - exposed_s_[side]);
  exposure = is_new ? frame.metered_exposure : adapted_exposure(exposure, frame.metered_exposure, seconds);
  exposed_scene_[side] = frame.scene.get();
  exposed_s_[side] = state.now_s;
}

bool FrameDisplay::update(State& state, int side) {
  const auto s = static_cast<size_t>(side);
  adapt_exposure(state, s);
  const ViewerFrame& frame = *state.frames[s];
  if (frame.serial == serials_[s]) return false;
  serials_[s] = frame.serial;
  shows_buffer_[s] = !frame.values.empty();
  if (side == 0 && state.inspector.automatic && shows_buffer_[s])
    choose_automatically(frame, state.inspector.display_transform);
  return true;
}

DisplayTransform FrameDisplay::transform(const State& state, int side) const {
  const auto s = static_cast<size_t>(side);
  const AllSettings& settings = state.settings[s];
  DisplayTransform d = shows_buffer_[s] ? state.inspector.display_transform : DisplayTransform{};
  const ViewerFrame* frame = state.frames[s].get();
  const bool in_studio = frame != nullptr && frame->in_studio;
  const Display display = display_for(settings.output, state.automatic_exposure[s], in_studio);
  d.table = state.ocio.table();
  if (!d.table) d.tone_map = display.tone_map;
  d.exposure = display.exposure;
  return d;
}

}  // namespace relume::viewer
