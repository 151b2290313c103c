#include "metrics/ensemble.h"

#include <cmath>

#include "core/error.h"
#include "metrics/metrics.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr int kBlock = 16;

struct BlockSums {
  double bias2 = 0;
  double variance = 0;
  uint64_t pixels = 0;
};

}  // namespace

void Ensemble::add(const Image& image) {
  if (count_ == 0) {
    mean_ = Image(image.width, image.height);
    m2_.assign(mean_.pixels.size(), Rgb(0));
  }
  check_same_size(mean_, image);
  ++count_;
  for (size_t i = 0; i < m2_.size(); ++i) {
    const Rgb before = mean_.pixels[i];
    mean_.pixels[i] += (image.pixels[i] - before) / static_cast<float>(count_);
    m2_[i] += (image.pixels[i] - before) * (image.pixels[i] - mean_.pixels[i]);
  }
}

Image Ensemble::squared_error(const Image& reference) const {
  if (count_ < 1) throw Error("an error needs at least one repetition");
  check_same_size(mean_, reference);
  Image result(mean_.width, mean_.height);
  for (size_t i = 0; i < m2_.size(); ++i) {
    const Rgb difference = mean_.pixels[i] - reference.pixels[i];
    result.pixels[i] = difference * difference + m2_[i] / static_cast<float>(count_);
  }
  return result;
}

ErrorSplit Ensemble::split(const Image& reference, double reference_mse) const {
  if (count_ < 2) throw Error("bias and variance need at least two repetitions; repeat with another seed");
  check_same_size(mean_, reference);
  const double n = count_;
  const auto block_columns = static_cast<size_t>((mean_.width + kBlock - 1) / kBlock);
  const auto block_rows = static_cast<size_t>((mean_.height + kBlock - 1) / kBlock);
  std::vector<BlockSums> blocks(block_columns * block_rows);
  for (int y = 0; y < mean_.height; ++y) {
    for (int x = 0; x < mean_.width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(mean_.width) + static_cast<size_t>(x);
      const Rgb difference = mean_.pixels[i] - reference.pixels[i];
      if (!is_finite(difference) || !is_finite(m2_[i])) continue;
      BlockSums& block = blocks[static_cast<size_t>(y / kBlock) * block_columns + static_cast<size_t>(x / kBlock)];
      for (int c = 0; c < 3; ++c) {
        const double variance = m2_[i][c] / (n - 1);
        block.variance += variance / 3;
        block.bias2 += (double(difference[c]) * difference[c] - variance / n) / 3;
      }
      ++block.pixels;
    }
  }
  ErrorSplit result;
  std::vector<double> block_means;
  for (const BlockSums& block : blocks) {
    if (block.pixels == 0) continue;
    result.pixels += block.pixels;
    result.bias2 += block.bias2;
    result.variance += block.variance;
    block_means.push_back(block.bias2 / static_cast<double>(block.pixels));
  }
  if (result.pixels == 0) throw Error("no pixel is finite in all images; check what made them");
  result.bias2 = result.bias2 / static_cast<double>(result.pixels) - reference_mse;
  result.variance /= static_cast<double>(result.pixels);
  result.bias2_error = standard_deviation(block_means) / std::sqrt(static_cast<double>(block_means.size()));
  return result;
}

}  // namespace relume
