// A session's image on a device, for windows.
#include "frame/primitives/fill.h"
#include "framebuffer/auto_exposure.h"
#include "render/session.h"
#include "render/session_access.h"
#include "render/session_state.h"

namespace relume {
namespace {

/// The session's image for kernels; empty if it is not in a buffer of a device.
template <typename State>
View<const Rgb> image_on_device(const State& s) {
  const bool is_on_host = !s.device || !s.replacement.empty() || s.shows_kept_image || has_sums(*s.buffers);
  if (is_on_host || s.counters.frames == s.first_frame()) return {};
  const BufferTable& buffers = *s.buffers;
  return buffers.view(s.image_buffer());
}

}  // namespace

std::shared_ptr<DeviceImage> copy_device_image(Session& session) {
  auto& s = SessionAccess::state(session);
  const View<const Rgb> image = image_on_device(s);
  if (image.empty()) return nullptr;
  return s.device->copy_image(image.data, size_t{image.size} * sizeof(Rgb));
}

float meter_device_image(Session& session) {
  auto& s = SessionAccess::state(session);
  const View<const Rgb> image = image_on_device(s);
  if (image.empty()) return 0;
  const auto stride = static_cast<uint32_t>(metering_stride(image.size));
  s.metered.reset((image.size - 1) / stride + 1, kUninitialized);
  take_elements(*s.backend, kBetweenFrames, image, stride, s.metered.mutable_view());
  return auto_exposure(s.metered.read());
}

}  // namespace relume
