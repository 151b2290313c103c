#include "techniques/temporal/accumulate/accumulate_pass.h"

#include <limits>
#include <numeric>

#include "techniques/temporal/accumulate/accumulate.h"

namespace relume {
namespace {

constexpr BufferKey<uint32_t> kHeatmap{"heatmap"};

void add_film(PassDeclaration& declaration, Change reset) {
  const auto add = [&](const BufferId& id, const char* help) {
    declaration.owns.push_back({.id = id, .help = help, .persistent = true, .reset = reset, .follows_surface = true});
  };
  add(kLightMean, "mean radiance that light paths brought");
  add(kLightM2, "weighted sum of squared distances of their luminance from its mean");
  add(kLightPaths, "light paths a pixel behind that mean");
  add(kLightFrames, "frames behind it");
  declaration.reads.push_back(kLightRadiance);
}

LightFilm film_of(const FrameContext& frame) {
  const View<const uint32_t> allocation = frame.read(kAllocation);
  const uint64_t traced = std::accumulate(allocation.begin(), allocation.end(), uint64_t{0});
  return {.splats = frame.read(kLightRadiance),
          .mean = frame.write(kLightMean),
          .m2 = frame.write(kLightM2),
          .weight = frame.write(kLightPaths),
          .frames = frame.write(kLightFrames),
          .paths = static_cast<float>(traced) / static_cast<float>(frame.pixels())};
}

}  // namespace

PassDeclaration AccumulatePass::declaration() const {
  const Change reset = invalidated_by_;
  PassDeclaration declaration{.name = "accumulate",
                              .stage = Stage::present,
                              .owns = {{.id = kMean,
                                        .help = "mean radiance of the samples that the pixel keeps",
                                        .persistent = true,
                                        .reset = reset,
                                        .follows_surface = true},
                                       {.id = kM2,
                                        .help = "sum of squared distances of their luminance from its mean",
                                        .persistent = true,
                                        .reset = reset,
                                        .follows_surface = true},
                                       {.id = kSamples,
                                        .help = "samples that the pixel keeps",
                                        .persistent = true,
                                        .reset = reset,
                                        .follows_surface = true,
                                        .display = BufferDisplay::value},
                                       {.id = kHeatmap,
                                        .help = "rays traced for the pixel, a frame",
                                        .persistent = true,
                                        .reset = Change::any,
                                        .display = BufferDisplay::mean},
                                       {.id = kNonfinite,
                                        .help = "samples that were not finite",
                                        .persistent = true,
                                        .display = BufferDisplay::value}},
                              .reads = {kRadiance, kRays},
                              .reads_if_any = {kAllocation},
                              .writes_if_any = {kM2Rgb, kSequenceSamples}};
  if (film_) add_film(declaration, reset);
  return declaration;
}

bool AccumulatePass::run(const FrameContext& frame) {
  AccumulateKernel kernel;
  kernel.radiance = frame.read(kRadiance);
  kernel.rays = frame.read(kRays);
  kernel.allocation = frame.read(kAllocation);
  kernel.mean = frame.write(kMean);
  kernel.m2 = frame.write(kM2);
  kernel.m2_rgb = frame.write(kM2Rgb);
  kernel.count = frame.write(kSamples);
  kernel.taken = frame.write(kSequenceSamples);
  kernel.ray_sum = frame.write(kHeatmap);
  kernel.nonfinite = frame.write(kNonfinite);
  if (film_) kernel.film = film_of(frame);
  kernel.keep = keep_;
  kernel.width = frame.width();
  // Not to be stopped: sums change only after a complete frame, so that one that is stopped leaves nothing behind.
  frame.launch("accumulate", kernel);
  return true;
}

double relative_error(View<const Rgb> mean, View<const float> m2, View<const uint32_t> samples,
                      const LightFilmBuffers& film) {
  double variance = 0;
  double luminance_sum = 0;
  for (uint32_t i = 0; i < mean.size; ++i) {
    if (samples[i] < 2) return std::numeric_limits<double>::infinity();
    variance += variance_of_mean(m2[i], samples[i]);
    if (!film.m2.empty()) variance += film_variance(film.m2[i], film.weight[i], film.frames[i]);
    luminance_sum += luminance(mean[i]);
  }
  if (luminance_sum <= 0) return 0;
  return std::sqrt(variance / mean.size) / (luminance_sum / mean.size);
}

}  // namespace relume
