// Frames that a GPU writes to a texture, where its driver can.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "frame/device_display.h"

namespace relume::viewer {

/// A texture for the frames of one side. The first image of a GPU shows whether its driver can write the texture. If
/// so, later images stay on the GPU; otherwise they come through page-locked memory.
class FrameTexture {
 public:
  /// `allocate(width, height)`: gives the texture room for that many texels of one float, and returns its name; 0 if it
  /// cannot be that large.
  explicit FrameTexture(std::function<uint32_t(int width, int height)> allocate) : allocate_(std::move(allocate)) {}

  /// Writes an image of RGB floats: red, green and blue of a pixel are three texels beside each other. Returns false if
  /// the image must be shown otherwise.
  bool write(DeviceImage& image, int width, int height);

  /// Ends the access of a GPU to the texture.
  void close() { texture_.reset(); }

 private:
  bool try_write(DeviceImage& image, int width, int height);

  std::function<uint32_t(int, int)> allocate_;
  std::shared_ptr<DeviceDisplay> display_;  ///< of the last image
  std::unique_ptr<DeviceTexture> texture_;  ///< nullptr: none of the last image's size
  bool works_ = true;                       ///< with that display, as far as is known
  int width_ = 0;
  int height_ = 0;
};

}  // namespace relume::viewer
