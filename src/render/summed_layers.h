// Images and layers from the exact sums of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "framebuffer/buffer_table.h"
#include "framebuffer/pixel_sums.h"
#include "relume/image_io.h"

namespace relume {

/// Values of a pixel that follow from its sums.
enum class SummedValue : uint8_t {
  r,
  g,
  b,
  variance,
  albedo_r,
  albedo_g,
  albedo_b,
  normal_x,
  normal_y,
  normal_z,
  depth,
  samples,
  rays,
  nonfinite
};

/// The value that a channel of an EXR file shows; std::nullopt if it does not follow from sums.
std::optional<SummedValue> summed_value(std::string_view channel);

/// The value over `samples` samples per pixel. `correlated_frames`: as Pass::correlated_frames().
float value_of(SummedValue value, const PixelSums& sums, uint32_t samples, uint32_t correlated_frames);

/// Whether a session sums its samples exactly.
bool has_sums(const BufferTable& buffers);

/// Sums of the pixels from `first_pixel` on, with the samples of an incomplete block.
void read_sums(const BufferTable& buffers, uint32_t first_pixel, std::span<PixelSums> sums);

/// Adds the sums of all pixels.
void add_sums(const BufferTable& buffers, std::span<PixelSums> sums);

/// Samples of an image that sums belong to.
struct SummedImage {
  PixelWindow window;  ///< the rendered pixels; not empty
  size_t width = 0;    ///< of the image
  uint32_t samples = 0;
  uint32_t correlated_frames = 1;
};

/// Estimated relative error of the image, as Session::estimated_error().
double relative_error(std::span<const PixelSums> sums, const SummedImage& image);

/// The mean of `samples` samples per pixel.
std::vector<Rgb> summed_image(const BufferTable& buffers, uint32_t samples);

/// Planes of a layer of aov_planes() that consists of means and variances; empty for others.
std::vector<ExrChannel> summed_planes(const BufferTable& buffers, std::string_view layer, uint32_t samples,
                                      uint32_t correlated_frames);

}  // namespace relume
