#include "experiments/measure/regions.h"

#include <algorithm>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "metrics/ensemble.h"
#include "metrics/statistics.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

int side_of_square(const ExperimentContext& context, int side) { return context.choose(side, 24); }

/// The region's pixels.
Image cropped(const Image& image, const Rectangle& region) {
  const PixelRange r = pixels_of(region, image.width, image.height);
  Image result(r.x1 - r.x0, r.y1 - r.y0);
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x) result.at(x - r.x0, y - r.y0) = image.at(x, y);
  }
  return result;
}

double shown_luminance(const Rgb& pixel) { return std::min(static_cast<double>(luminance(pixel)), 1.0); }

}  // namespace

std::vector<double> region_errors(const Comparison& comparison, std::string_view name, const Rectangle& region) {
  const Image& reference = comparison.reference.image;
  const PixelMask mask = mask_of(region, reference.width, reference.height);
  std::vector<double> errors;
  for (const Image& image : contender_named(comparison, name).images)
    errors.push_back(frame_mse(image, reference, mask) - reference_noise(comparison.reference, mask));
  return errors;
}

Ratio region_ratio(const Comparison& comparison, std::string_view a, std::string_view b, const Rectangle& region) {
  return error_ratio(region_errors(comparison, a, region), region_errors(comparison, b, region));
}

std::vector<double> region_variances(const Comparison& comparison, std::string_view name, const Rectangle& region) {
  const std::vector<Image>& images = contender_named(comparison, name).images;
  const auto n = static_cast<float>(images.size());
  Image sum = images.front();
  const PixelMask mask = mask_of(region, sum.width, sum.height);
  for (size_t k = 1; k < images.size(); ++k) {
    for (size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] += images[k].pixels[i];
  }
  std::vector<double> variances;
  for (const Image& image : images) {
    Image others = sum;
    for (size_t i = 0; i < sum.pixels.size(); ++i) others.pixels[i] = (sum.pixels[i] - image.pixels[i]) / (n - 1);
    // The mean of the others has its own variance: 1 / (n − 1) of a single image's.
    variances.push_back(frame_mse(image, others, mask) * static_cast<double>((n - 1) / n));
  }
  return variances;
}

Estimate region_bias2(const Comparison& comparison, std::string_view name, const Rectangle& region) {
  const Image& reference = comparison.reference.image;
  const double noise = reference_noise(comparison.reference, mask_of(region, reference.width, reference.height));
  const Image truth = cropped(reference, region);
  std::vector<Image> parts;
  for (const Image& image : contender_named(comparison, name).images) parts.push_back(cropped(image, region));
  if (parts.size() > 2) return squared_bias(parts, truth, noise);
  Ensemble ensemble;
  for (const Image& part : parts) ensemble.add(part);
  return {ensemble.split(truth, noise).bias2, {}};
}

double region_mean(const Image& image, const Rectangle& region) {
  return mean_over(mask_of(region, image.width, image.height),
                   [&](size_t i) { return static_cast<double>(luminance(image.pixels[i])); });
}

std::vector<double> region_means(const Comparison& comparison, std::string_view name, const Rectangle& region) {
  std::vector<double> means;
  for (const Image& image : contender_named(comparison, name).images) means.push_back(region_mean(image, region));
  return means;
}

double contrast_kept(const Image& image, const Image& reference, const Rectangle& region) {
  const PixelMask mask = mask_of(region, reference.width, reference.height);
  const double mean = mean_over(mask, [&](size_t i) { return shown_luminance(reference.pixels[i]); });
  const auto distance = [&](size_t i) { return shown_luminance(reference.pixels[i]) - mean; };
  const double variance = mean_over(mask, [&](size_t i) { return distance(i) * distance(i); });
  const double covariance = mean_over(mask, [&](size_t i) { return distance(i) * shown_luminance(image.pixels[i]); });
  return variance > 0 ? covariance / variance : 1;
}

double detail_kept(const Image& image, const Image& reference, const Rectangle& region) {
  const PixelRange r = pixels_of(region, reference.width, reference.height);
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

ViewerBlock region_images(const std::string& title, const Comparison& comparison,
                          const std::vector<Rectangle>& regions) {
  ViewerBlock block = comparison_images(comparison);
  block.title = title + ": " + block.title;
  const Image& reference = comparison.reference.image;
  const int size = std::max(8, std::min(reference.width, reference.height) / 5);
  for (ImageSet& set : block.sets) {
    set.crops.clear();
    for (const Rectangle& region : regions) {
      const PixelRange r = pixels_of(region, reference.width, reference.height);
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
