#include "techniques/accumulate/accumulate_pass.h"

#include <limits>
#include <numeric>

#include "techniques/accumulate/accumulate.h"

namespace relume {
namespace {

void add_film(PassDeclaration& declaration, Change reset) {
  const auto add = [&](const char* name, BufferType type, const char* help) {
    declaration.owns.push_back(
        {.name = name, .type = type, .help = help, .persistent = true, .reset = reset, .follows_surface = true});
  };
  add("light-mean", BufferType::rgb32f, "mean radiance that light paths brought");
  add("light-m2", BufferType::f32, "weighted sum of squared distances of their luminance from its mean");
  add("light-paths", BufferType::f32, "light paths a pixel behind that mean");
  add("light-frames", BufferType::u32, "frames behind it");
  declaration.reads.push_back("light-radiance");
}

LightFilm film_of(const FrameContext& frame) {
  const View<const uint32_t> allocation = frame.view<const uint32_t>("allocation");
  const uint64_t traced = std::accumulate(allocation.begin(), allocation.end(), uint64_t{0});
  return {.splats = frame.view<const Rgb>("light-radiance"),
          .mean = frame.view<Rgb>("light-mean"),
          .m2 = frame.view<float>("light-m2"),
          .weight = frame.view<float>("light-paths"),
          .frames = frame.view<uint32_t>("light-frames"),
          .paths = static_cast<float>(traced) / static_cast<float>(frame.pixels())};
}

}  // namespace

PassDeclaration AccumulatePass::declaration() const {
  const Change reset = invalidated_by_;
  PassDeclaration declaration{.name = "accumulate",
                              .stage = Stage::present,
                              .owns = {{.name = "mean",
                                        .type = BufferType::rgb32f,
                                        .help = "mean radiance of the samples that the pixel keeps",
                                        .persistent = true,
                                        .reset = reset,
                                        .follows_surface = true},
                                       {.name = "m2",
                                        .type = BufferType::f32,
                                        .help = "sum of squared distances of their luminance from its mean",
                                        .persistent = true,
                                        .reset = reset,
                                        .follows_surface = true},
                                       {.name = "samples",
                                        .type = BufferType::u32,
                                        .help = "samples that the pixel keeps",
                                        .persistent = true,
                                        .reset = reset,
                                        .follows_surface = true,
                                        .display = BufferDisplay::value},
                                       {.name = "heatmap",
                                        .type = BufferType::u32,
                                        .help = "rays traced for the pixel, a frame",
                                        .persistent = true,
                                        .reset = Change::any,
                                        .display = BufferDisplay::mean},
                                       {.name = "nonfinite",
                                        .type = BufferType::u32,
                                        .help = "samples that were not finite",
                                        .persistent = true,
                                        .display = BufferDisplay::value}},
                              .reads = {"radiance", "rays"},
                              .reads_if_any = {"allocation"},
                              .writes_if_any = {"adaptive-m2", "sequence-samples"}};
  if (film_) add_film(declaration, reset);
  return declaration;
}

bool AccumulatePass::run(const FrameContext& frame) {
  AccumulateKernel kernel;
  kernel.radiance = frame.view<const Rgb>("radiance");
  kernel.rays = frame.view<const uint32_t>("rays");
  kernel.allocation = frame.view<const uint32_t>("allocation");
  kernel.mean = frame.view<Rgb>("mean");
  kernel.m2 = frame.view<float>("m2");
  kernel.m2_rgb = frame.view<Rgb>("adaptive-m2");
  kernel.count = frame.view<uint32_t>("samples");
  kernel.taken = frame.view<uint32_t>("sequence-samples");
  kernel.ray_sum = frame.view<uint32_t>("heatmap");
  kernel.nonfinite = frame.view<uint32_t>("nonfinite");
  if (film_) kernel.film = film_of(frame);
  kernel.keep = keep_;
  kernel.width = frame.width();
  // Not to be stopped: sums change only after a complete frame, so that one that is stopped leaves nothing behind.
  return launch(frame.backend, "accumulate", kernel, frame.width(), frame.height());
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
