#include "viewer/render/frame_texture.h"

#include <cstddef>

namespace relume::viewer {

bool FrameTexture::write(DeviceImage& image, int width, int height) {
  if (image.display() != display_) {
    texture_.reset();
    display_ = image.display();
    works_ = true;
  }
  if (!works_) return false;
  works_ = try_write(image, width, height);
  if (!works_) texture_.reset();
  display_->keep_on_device(works_);
  return works_;
}

bool FrameTexture::try_write(DeviceImage& image, int width, int height) {
  if (!texture_ || width != width_ || height != height_) {
    texture_.reset();  // before the texture changes
    width_ = width;
    height_ = height;
    const uint32_t name = allocate_(3 * width, height);
    if (name == 0) return false;
    const auto row_bytes = 3 * sizeof(float) * static_cast<size_t>(width);
    texture_ = display_->share(name, row_bytes, static_cast<size_t>(height));
  }
  return texture_ && texture_->write(image);
}

}  // namespace relume::viewer
