#include "viewer/render/frame_pixels.h"

#include <span>

namespace relume::viewer {

Rgb radiance_at(const ViewerFrame& frame, size_t pixel) {
  if (!frame.device_image) return frame.radiance[pixel];
  Rgb radiance(0);
  const bool is_read = frame.device_image->read(pixel * sizeof(Rgb), std::as_writable_bytes(std::span(&radiance, 1)));
  return is_read ? radiance : Rgb(0);
}

std::vector<Rgb> radiance_of(const ViewerFrame& frame) {
  if (!frame.device_image) return frame.radiance;
  std::vector<Rgb> pixels(frame.device_image->size_bytes() / sizeof(Rgb));
  const bool is_read = frame.device_image->read(0, std::as_writable_bytes(std::span(pixels)));
  return is_read ? pixels : std::vector<Rgb>();
}

}  // namespace relume::viewer
