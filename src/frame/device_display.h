// Images on their way from a device to a window. Rendering continues meanwhile. These objects also live longer than the
// device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace relume {

class DeviceDisplay;

/// A copy of an image that a device has rendered. One thread at a time uses it, any thread. If the device has failed,
/// its functions report no error, but that they have no pixels: the next frame reports it.
class DeviceImage {
 public:
  virtual ~DeviceImage() = default;

  virtual const std::shared_ptr<DeviceDisplay>& display() const = 0;
  virtual size_t size_bytes() const = 0;
  /// The image in page-locked host memory, once its copy there has ended, valid as long as this object. Empty if the
  /// image is only on the device.
  virtual std::span<const std::byte> bytes() = 0;
  /// Copies `to.size()` bytes from `first` on to the host. Returns false if the device has failed.
  virtual bool read(size_t first, std::span<std::byte> to) = 0;
};

/// A texture of OpenGL that a device writes. The thread that uses and destroys it is that of the texture.
class DeviceTexture {
 public:
  virtual ~DeviceTexture() = default;

  /// Copies an image of the same display into the texture. What OpenGL draws afterwards shows it. Returns false if the
  /// driver refuses; the content of the texture is then undefined.
  virtual bool write(DeviceImage& image) = 0;
};

/// The support of a device for windows. Thread-safe.
class DeviceDisplay {
 public:
  virtual ~DeviceDisplay() = default;

  /// Lets the device write a texture, on the thread whose OpenGL context has it. The texture has one float per texel,
  /// and rows of `row_bytes`. Returns nullptr if the driver refuses: it has no interoperation with this OpenGL.
  virtual std::unique_ptr<DeviceTexture> share(uint32_t texture, size_t row_bytes, size_t rows) = 0;
  /// Whether later images stay on the device, for textures. At first, they are also copied to page-locked memory.
  virtual void keep_on_device(bool keep) = 0;
};

}  // namespace relume
