// Images and error maps for pages.
#pragma once

#include <string>
#include <vector>

#include "framebuffer/tone_map.h"
#include "relume/image_io.h"
#include "report/page.h"

namespace relume {

/// Display of images, and data included in the page.
struct ImageOptions {
  ToneMap tone_map = ToneMap::agx;
  float exposure = 0;  ///< stops
  bool values = true;  ///< radiance per pixel for the inspector, 6 bytes each before compression
};

/// Exposure in stops that suits the image, as a camera meters it.
float metered_exposure(const Image& image);

/// Meanings of the layers of measured_image(), in order.
std::vector<LayerKind> image_layer_kinds();

/// The image with its display transform.
PageImage plain_image(std::string name, int color, const Image& image, const ImageOptions& options);

/// Values in [0, 1] per pixel in the colours of color_map().
PageImage map_image(std::string name, int color, const std::vector<float>& values, int width, int height);

/// plain_image() with maps against `reference`: relative signed luminance difference, relative squared error
/// (logarithmic), and FLIP. Throws Error if the sizes differ.
PageImage measured_image(std::string name, int color, const Image& image, const Image& reference,
                         const ImageOptions& options);

/// The `count` disjoint squares with the largest differences from the reference relative to its brightness.
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

/// IEEE 754 binary16, rounded to nearest; values out of range become infinite.
uint16_t half_from_float(float x);

std::string base64(const std::vector<uint8_t>& bytes);

}  // namespace relume
