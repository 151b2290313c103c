#include "experiments/measure/frame_correlation.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

/// Mean of frames [begin, end) by pixel.
std::vector<double> mean_of_frames(const RunFrames& run, size_t begin, size_t end) {
  std::vector<double> means(run.front().size());
  for (size_t f = begin; f < end; ++f) {
    for (size_t p = 0; p < means.size(); ++p) means[p] += static_cast<double>(run[f][p]);
  }
  for (double& value : means) value /= static_cast<double>(end - begin);
  return means;
}

/// Mean over the runs of mean_of_frames().
std::vector<double> mean_of_runs(const std::vector<RunFrames>& runs, size_t begin, size_t end) {
  std::vector<double> means(runs.front().front().size());
  for (const RunFrames& run : runs) {
    const std::vector<double> of_run = mean_of_frames(run, begin, end);
    for (size_t p = 0; p < means.size(); ++p) means[p] += of_run[p] / static_cast<double>(runs.size());
  }
  return means;
}

/// Quotients by the first value.
std::vector<double> normalized(std::vector<double> sums) {
  const double first = sums.front();
  for (double& sum : sums) sum = first > 0 ? sum / first : 0;
  return sums;
}

}  // namespace

std::vector<std::vector<double>> run_means(const std::vector<RunFrames>& runs, size_t frames) {
  std::vector<std::vector<double>> means;
  for (const RunFrames& run : runs) means.push_back(mean_of_frames(run, 0, frames));
  return means;
}

double variance_over_runs(const std::vector<std::vector<double>>& means) {
  const size_t pixels = means.front().size();
  const auto n = static_cast<double>(means.size());
  double sum = 0;
  for (size_t p = 0; p < pixels; ++p) {
    double mean = 0;
    for (const std::vector<double>& run : means) mean += run[p] / n;
    for (const std::vector<double>& run : means) sum += (run[p] - mean) * (run[p] - mean) / (n - 1);
  }
  return sum / static_cast<double>(pixels);
}

double variance_by_blocks(const RunFrames& run, size_t frames, size_t block) {
  const size_t count = frames / block;
  std::vector<std::vector<double>> blocks;
  for (size_t b = 0; b < count; ++b) blocks.push_back(mean_of_frames(run, b * block, (b + 1) * block));
  return variance_over_runs(blocks) / static_cast<double>(count);
}

std::vector<double> frame_correlations(const std::vector<RunFrames>& runs, size_t begin, size_t most) {
  const size_t end = runs.front().size();
  const std::vector<double> mean = mean_of_runs(runs, begin, end);
  std::vector<double> sums;
  for (size_t lag = 0; lag <= std::min(most, end - begin - 1); ++lag) {
    double sum = 0;
    for (const RunFrames& run : runs) {
      for (size_t f = begin; f + lag < end; ++f) {
        for (size_t p = 0; p < mean.size(); ++p)
          sum += (static_cast<double>(run[f][p]) - mean[p]) * (static_cast<double>(run[f + lag][p]) - mean[p]);
      }
    }
    sums.push_back(sum / static_cast<double>(end - begin - lag));
  }
  return normalized(std::move(sums));
}

std::vector<double> pixel_correlations(const std::vector<RunFrames>& runs, const std::vector<size_t>& pixels,
                                       size_t width, size_t most) {
  const size_t end = runs.front().size();
  const std::vector<double> mean = mean_of_runs(runs, end - 1, end);
  std::vector<double> sums;
  for (size_t lag = 0; lag <= most; ++lag) {
    double covariance = 0;
    double variance = 0;
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto found = std::lower_bound(pixels.begin(), pixels.end(), pixels[i] + lag);
      if (found == pixels.end() || *found != pixels[i] + lag || *found / width != pixels[i] / width) continue;
      const auto j = static_cast<size_t>(found - pixels.begin());
      for (const RunFrames& run : runs) {
        const double a = static_cast<double>(run.back()[i]) - mean[i];
        const double b = static_cast<double>(run.back()[j]) - mean[j];
        covariance += a * b;
        variance += 0.5 * (a * a + b * b);
      }
    }
    sums.push_back(variance > 0 ? covariance / variance : 0);
  }
  return sums;
}

}  // namespace relume
