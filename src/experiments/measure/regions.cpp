#include "experiments/measure/regions.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "metrics/metrics.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

struct PixelRange {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

PixelRange pixels_of(const Image& image, const Rectangle& region) {
  const auto at = [](double share, int size) {
    return std::clamp(static_cast<int>(std::lround(share * static_cast<double>(size))), 0, size);
  };
  return {at(region.x0, image.width), at(region.y0, image.height), at(region.x1, image.width),
          at(region.y1, image.height)};
}

/// Mean over the region of what `value` makes of a pixel's index.
template <typename Value>
double mean_over(const Image& image, const Rectangle& region, const Value& value) {
  const PixelRange r = pixels_of(image, region);
  double sum = 0;
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x) sum += value(static_cast<size_t>(y * image.width + x));
  }
  return sum / std::max(1, (r.x1 - r.x0) * (r.y1 - r.y0));
}

int side_of_square(const ExperimentContext& context, int side) { return context.choose(side, 40); }

double shown_luminance(const Rgb& pixel) { return std::min(static_cast<double>(luminance(pixel)), 1.0); }

}  // namespace

double region_mse(const Image& a, const Image& b, const Rectangle& region) {
  return mean_over(a, region,
                   [&](size_t i) { return static_cast<double>(length_squared(a.pixels[i] - b.pixels[i])) / 3; });
}

double region_mse(const Comparison& comparison, std::string_view name, const Rectangle& region) {
  const auto mean_of = [&region](const Image& squares) {
    return mean_over(squares, region, [&](size_t i) {
      const Rgb& p = squares.pixels[i];
      return (static_cast<double>(p.r) + static_cast<double>(p.g) + static_cast<double>(p.b)) / 3;
    });
  };
  const Image& noise = comparison.reference.squared_error;
  return without_noise(mean_of(contender_named(comparison, name).squared_error),
                       noise.pixels.empty() ? 0 : mean_of(noise));
}

double region_mean(const Image& image, const Rectangle& region) {
  return mean_over(image, region, [&](size_t i) { return static_cast<double>(luminance(image.pixels[i])); });
}

double contrast_kept(const Image& image, const Image& reference, const Rectangle& region) {
  const double mean = mean_over(reference, region, [&](size_t i) { return shown_luminance(reference.pixels[i]); });
  const auto distance = [&](size_t i) { return shown_luminance(reference.pixels[i]) - mean; };
  const double variance = mean_over(reference, region, [&](size_t i) { return distance(i) * distance(i); });
  const double covariance =
      mean_over(reference, region, [&](size_t i) { return distance(i) * shown_luminance(image.pixels[i]); });
  return variance > 0 ? covariance / variance : 1;
}

double detail_kept(const Image& image, const Image& reference, const Rectangle& region) {
  const PixelRange r = pixels_of(reference, region);
  double product = 0;
  double energy = 0;
  const auto add = [&](int x, int y, int u, int v) {
    const auto step = [&](const Image& i) { return shown_luminance(i.at(u, v)) - shown_luminance(i.at(x, y)); };
    product += step(image) * step(reference);
    energy += step(reference) * step(reference);
  };
  for (int y = r.y0; y + 1 < r.y1; ++y) {
    for (int x = r.x0; x + 1 < r.x1; ++x) {
      add(x, y, x + 1, y);
      add(x, y, x, y + 1);
    }
  }
  return energy > 0 ? product / energy : 1;
}

double mean_mse_of(const Comparison& comparison, std::string_view name) {
  return mean(values_of(contender_named(comparison, name), [](const Repetition& r) { return r.mse; }));
}

ViewerBlock region_pictures(const std::string& title, const Comparison& comparison,
                            const std::vector<Rectangle>& regions) {
  ViewerBlock block = comparison_pictures(comparison);
  block.title = title + ": " + block.title;
  const Image& reference = comparison.reference.image;
  const int size = std::max(8, std::min(reference.width, reference.height) / 5);
  for (PictureSet& set : block.sets) {
    set.crops.clear();
    for (const Rectangle& region : regions) {
      const PixelRange r = pixels_of(reference, region);
      set.crops.push_back({std::clamp((r.x0 + r.x1 - size) / 2, 0, reference.width - size),
                           std::clamp((r.y0 + r.y1 - size) / 2, 0, reference.height - size), size});
    }
  }
  return block;
}

void use_square(const ExperimentContext& context, int side, StudyOptions& options) {
  const std::string text = std::to_string(side_of_square(context, side));
  options.common.emplace_back("width", text);
  options.common.emplace_back("height", text);
}

std::string square_text(const ExperimentContext& context, int side) {
  return fmt::format("{0} × {0}", side_of_square(context, side));
}

}  // namespace relume
