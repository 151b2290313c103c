#include "report/images.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/srgb.h"
#include "framebuffer/auto_exposure.h"
#include "relume/lab/flip.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

// Range of the map of relative squared error, powers of ten.
constexpr float kLowestExponent = -4;
constexpr float kHighestExponent = 1;

std::string png_text(const Image& display) { return base64(encode_png(display)); }

/// Display-linear colour of t: -1 blue, 0 nearly black, 1 orange.
Rgb diverging_color(float t) {
  const auto srgb = [](int code) {
    return Rgb(static_cast<float>(code >> 16), static_cast<float>(code >> 8 & 255), static_cast<float>(code & 255)) /
           255.0f;
  };
  const Rgb middle = srgb(0x17181a);
  const Rgb half = t < 0 ? srgb(0x124a86) : srgb(0x94400d);
  const Rgb full = t < 0 ? srgb(0x5ab0ff) : srgb(0xffab5c);
  const float s = std::min(std::fabs(t), 1.0f) * 2.0f;
  const Rgb code = s < 1.0f ? middle + (half - middle) * s : half + (full - half) * (s - 1.0f);
  return linear_from_srgb(code);
}

Image difference_map(const Image& image, const Image& reference) {
  Image map(image.width, image.height);
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    const float expected = luminance(reference.pixels[i]);
    const float relative = (luminance(image.pixels[i]) - expected) / (expected + static_cast<float>(kRelativeEpsilon));
    map.pixels[i] = std::isfinite(relative) ? diverging_color(relative) : Rgb(0, 1, 0);
  }
  return map;
}

Image logarithmic_map(std::vector<float> values, int width, int height) {
  for (float& x : values) {
    x = (std::log10(std::max(x, 1e-12f)) - kLowestExponent) / (kHighestExponent - kLowestExponent);
    if (!std::isnan(x)) x = std::clamp(x, 0.0f, 1.0f);
  }
  return color_map(values, width, height);
}

/// High and low bytes of the values as two opaque images, which browsers decode exactly.
std::vector<std::string> value_planes(const Image& image) {
  std::vector<uint8_t> high(image.pixels.size() * 3);
  std::vector<uint8_t> low(high.size());
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const uint16_t half = half_from_float(image.pixels[i][static_cast<int>(c)]);
      high[3 * i + c] = static_cast<uint8_t>(half >> 8);
      low[3 * i + c] = static_cast<uint8_t>(half & 255);
    }
  }
  return {base64(encode_png(high, image.width, image.height)), base64(encode_png(low, image.width, image.height))};
}

}  // namespace

float metered_exposure(const Image& image) { return auto_exposure(image.pixels); }

uint16_t half_from_float(float x) {
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  const uint32_t sign = bits >> 16 & 0x8000u;
  const uint32_t magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return static_cast<uint16_t>(sign | 0x7e00u);   // NaN
  if (magnitude >= 0x47800000u) return static_cast<uint16_t>(sign | 0x7c00u);  // 65536 and above
  if (magnitude < 0x38800000u) {                                               // below 2^-14: subnormal
    const float scaled = std::bit_cast<float>(magnitude) * 0x1p24f;
    return static_cast<uint16_t>(sign | static_cast<uint32_t>(std::nearbyint(scaled)));
  }
  const uint32_t rounded = magnitude + 0xfffu + (magnitude >> 13 & 1u);  // ties to even; may carry into the exponent
  return static_cast<uint16_t>(sign | ((rounded - 0x38000000u) >> 13));
}

std::string base64(const std::vector<uint8_t>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t left = bytes.size() - i;
    const uint32_t group = static_cast<uint32_t>(bytes[i]) << 16 |
                           (left > 1 ? static_cast<uint32_t>(bytes[i + 1]) << 8 : 0u) |
                           (left > 2 ? static_cast<uint32_t>(bytes[i + 2]) : 0u);
    text += kDigits[group >> 18];
    text += kDigits[group >> 12 & 63u];
    text += left > 1 ? kDigits[group >> 6 & 63u] : '=';
    text += left > 2 ? kDigits[group & 63u] : '=';
  }
  return text;
}

std::vector<LayerKind> image_layer_kinds() {
  return {{"Image"},
          {"Difference", "diverging", "−100 % too dark", "+100 % too bright"},
          {"relMSE", "magma", "0.0001", "10"},
          {"FLIP", "magma", "0", "1"}};
}

PageImage plain_image(std::string name, int color, const Image& image, const ImageOptions& options) {
  PageImage page_image{.name = std::move(name), .color = color, .note = {}, .layers = {}, .values = {}};
  page_image.layers.push_back({"Image", png_text(tone_map(image, options.tone_map, options.exposure))});
  if (options.values) page_image.values = value_planes(image);
  return page_image;
}

PageImage map_image(std::string name, int color, const std::vector<float>& values, int width, int height) {
  return {.name = std::move(name),
          .color = color,
          .note = {},
          .layers = {{"Image", png_text(color_map(values, width, height))}},
          .values = {}};
}

PageImage measured_image(std::string name, int color, const Image& image, const Image& reference,
                         const ImageOptions& options) {
  check_same_size(image, reference);
  PageImage page_image = plain_image(std::move(name), color, image, options);
  page_image.layers.push_back({"Difference", png_text(difference_map(image, reference))});
  page_image.layers.push_back(
      {"relMSE", png_text(logarithmic_map(relative_error_map(image, reference), image.width, image.height))});
  const std::vector<float> flip = flip_map(tone_map(image, options.tone_map, options.exposure),
                                           tone_map(reference, options.tone_map, options.exposure));
  page_image.layers.push_back({"FLIP", png_text(color_map(flip, image.width, image.height))});
  return page_image;
}

std::vector<Crop> interesting_crops(const std::vector<const Image*>& images, const Image& reference, int count) {
  const int size = std::max(8, std::min(reference.width, reference.height) / 7);
  const int columns = reference.width / size;
  const int rows = reference.height / size;
  std::vector<std::pair<double, Crop>> found;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double worst = 0;
      for (const Image* image : images) {
        double sum = 0;
        for (int y = row * size; y < (row + 1) * size; ++y) {
          for (int x = column * size; x < (column + 1) * size; ++x) {
            const Rgb& b = reference.at(x, y);
            const Rgb d = image->at(x, y) - b;
            const float squared = glm::dot(d, d) / (glm::dot(b, b) + static_cast<float>(kRelativeEpsilon));
            sum += std::isfinite(squared) ? std::min(squared, 4.0f) : 4.0f;  // limits the influence of fireflies
          }
        }
        worst = std::max(worst, sum);
      }
      found.push_back({worst, {column * size, row * size, size}});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Crop> crops;
  for (const auto& candidate : found) {
    const Crop& crop = candidate.second;
    if (static_cast<int>(crops.size()) == count) break;
    const bool apart = std::none_of(crops.begin(), crops.end(), [&](const Crop& other) {
      return std::abs(other.x - crop.x) < 2 * size && std::abs(other.y - crop.y) < 2 * size;
    });
    if (apart) crops.push_back(crop);
  }
  return crops;
}

ImageSet measured_set(std::string label, const Image& reference, const std::vector<MeasuredImage>& images,
                      const ImageOptions& options) {
  ImageSet set{.label = std::move(label),
               .width = reference.width,
               .height = reference.height,
               .images = {plain_image("reference", kNeutralColor, reference, options)},
               .crops = {}};
  std::vector<const Image*> measured;
  for (const MeasuredImage& image : images) {
    set.images.push_back(measured_image(image.name, image.color, *image.image, reference, options));
    set.images.back().note = image.note;
    measured.push_back(image.image);
  }
  set.crops = interesting_crops(measured, reference, 3);
  return set;
}

}  // namespace relume
