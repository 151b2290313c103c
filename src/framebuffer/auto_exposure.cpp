#include "framebuffer/auto_exposure.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relume {
namespace {

constexpr float kMiddleGrey = 0.18f;
constexpr float kHighlightStops = 4;  // above middle grey
constexpr float kMostStops = 16;

/// Histogram of the log2 luminance of pixels.
class StopHistogram {
 public:
  explicit StopHistogram(std::span<const Rgb> radiance) {
    const size_t stride = metering_stride(radiance.size());
    for (size_t i = 0; i < radiance.size(); i += stride) {
      const float y = luminance(radiance[i]);
      if (!is_finite(y) || !(y > 0)) continue;
      const float place = (std::log2(y) - kLowest) * kBinsPerStop;
      ++bins_[static_cast<size_t>(clamp(place, 0.0f, kBins - 1.0f))];
      ++count_;
    }
  }

  bool empty() const { return count_ == 0; }

  /// Mean stops between two fractions of the pixels, ordered from dark to bright.
  float mean(double first, double last) const {
    const double low = first * count_;
    const double high = last * count_;
    double sum = 0;
    double below = 0;
    for (size_t i = 0; i < kBins; ++i) {
      const double above = below + bins_[i];
      sum += std::max(0.0, std::min(above, high) - std::max(below, low)) * static_cast<double>(stops(i));
      below = above;
    }
    return static_cast<float>(sum / (high - low));
  }

  /// Stops of the pixel with this fraction of all pixels below it.
  float percentile(double share) const {
    double below = 0;
    for (size_t i = 0; i < kBins; ++i) {
      below += bins_[i];
      if (below >= share * count_) return stops(i);
    }
    return stops(kBins - 1);
  }

 private:
  static constexpr float kLowest = -40;  ///< log2
  static constexpr float kBinsPerStop = 8;
  static constexpr size_t kBins = 8 * 80;

  static float stops(size_t bin) { return kLowest + (static_cast<float>(bin) + 0.5f) / kBinsPerStop; }

  std::array<uint32_t, kBins> bins_{};
  uint32_t count_ = 0;
};

}  // namespace

size_t metering_stride(size_t pixels) {
  constexpr size_t kEnoughPixels = 1 << 16;
  return (pixels / kEnoughPixels) | 1;  // odd, to sample alternating columns equally
}

float auto_exposure(std::span<const Rgb> radiance) {
  const StopHistogram histogram(radiance);
  if (histogram.empty()) return 0;
  const float grey = std::log2(kMiddleGrey);
  const float wanted = grey - histogram.mean(0.10, 0.95);
  const float most = grey + kHighlightStops - histogram.percentile(0.99);
  return clamp(std::min(wanted, most), -kMostStops, kMostStops);
}

}  // namespace relume
