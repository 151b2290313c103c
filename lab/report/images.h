// Images and maps of errors for pages.
#pragma once

#include <string>
#include <vector>

#include "framebuffer/tone_map.h"
#include "relume/image_io.h"
#include "report/page.h"

namespace relume {

/// How images are shown and what is put into the page.
struct ImageOptions {
  ToneMap tone_map = ToneMap::agx;
  float exposure = 0;  ///< stops
  bool values = true;  ///< radiance of each pixel for the inspector, 6 bytes a pixel before compression
};

/// What the layers of measured_image() mean, in their order.
std::vector<LayerKind> image_layer_kinds();

/// The image as it is shown.
PageImage plain_image(std::string name, int color, const Image& image, const ImageOptions& options);

/// Values from 0 to 1 of each pixel in the colours of color_map().
PageImage map_image(std::string name, int color, const std::vector<float>& values, int width, int height);

/// The same with maps against `reference`: the relative difference of the luminance with its sign, the relative squared
/// error (logarithmic), and FLIP. Throws Error if the sizes differ.
PageImage measured_image(std::string name, int color, const Image& image, const Image& reference,
                         const ImageOptions& options);

/// The `count` squares in which the images differ most from the reference relative to its brightness, apart from each
/// other.
std::vector<Crop> interesting_crops(const std::vector<const Image*>& images, const Image& reference, int count);

struct MeasuredImage {
  std::string name;
  int color = 0;
  const Image* image = nullptr;
  std::string note = {};
};
/// The reference, then measured_image() of each image, and three of their interesting_crops().
ImageSet measured_set(std::string label, const Image& reference, const std::vector<MeasuredImage>& images,
                      const ImageOptions& options);

/// IEEE 754 binary16, rounded to nearest; what is too large becomes infinite.
uint16_t half_from_float(float x);

std::string base64(const std::vector<uint8_t>& bytes);

}  // namespace relume
