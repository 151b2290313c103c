// Tests error, bias and variance of hash grid caches.
#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/lab/metrics.h"
#include "render/session.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kSize = 80;

Scene cornell() { return find_builtin_scene("cornell")->build(); }

RenderSettings settings_of(CacheChoice cache, HistoryChoice history) {
  RenderSettings s = small_settings(kSize, kSize);
  s.cache = cache;
  s.history = history;
  return s;
}

/// Reference for images of the box. Pixels with the lamp are excluded: emission is not filtered, and the noise of the
/// lamp's edges would dominate.
struct Truth {
  Image image;
  std::vector<bool> counts;
};

/// Rendered once per process: CMakeLists.txt runs all tests of SharedCacheErrors in one.
const Truth& truth() {
  static const Truth result = [] {
    RenderSettings s = settings_of(CacheChoice::none, HistoryChoice::accumulate);
    Truth t{render(cornell(), s, 512), {}};
    s.path.max_bounces = 0;
    for (const Rgb& emission : render(cornell(), s, 64).pixels) t.counts.push_back(is_black(emission));
    return t;
  }();
  return result;
}

double error_of(const Image& image) {
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    if (!truth().counts[i]) continue;
    sum += static_cast<double>(length_squared(image.pixels[i] - truth().image.pixels[i]));
    count += 3;
  }
  return sum / count;
}

/// Mean error of each of the first frames, and the number of rays of all of them.
struct Course {
  std::vector<double> error;
  double rays = 0;
};
Course course(CacheChoice cache, HistoryChoice history, int frames) {
  constexpr int kSeeds = 3;
  Course result{std::vector<double>(static_cast<size_t>(frames), 0.0)};
  RenderSettings s = settings_of(cache, history);
  for (s.seed = 1; s.seed <= kSeeds; ++s.seed) {
    Session session(cornell(), s);
    for (double& error : result.error) {
      session.render_frame();
      error += error_of(session.image()) / kSeeds;
    }
    result.rays += static_cast<double>(session.statistics().rays) / kSeeds;
  }
  return result;
}

TEST(SharedCacheErrors, PsfHalvesThatOfAFirstFrame) {
  EXPECT_LT(course(CacheChoice::psf, HistoryChoice::none, 1).error[0],
            0.5 * course(CacheChoice::none, HistoryChoice::none, 1).error[0]);
}

TEST(SharedCacheErrors, PsfHalvesThatOfImagesWithLamps) {
  RenderSettings s = settings_of(CacheChoice::none, HistoryChoice::none);
  const double path = compute_metrics(render(cornell(), s, 1), truth().image, {.flip = false}).mse;
  s.cache = CacheChoice::psf;
  EXPECT_LT(compute_metrics(render(cornell(), s, 1), truth().image, {.flip = false}).mse, 0.5 * path);
}

TEST(SharedCacheErrors, PsfStaysBelowAccumulationForEightFrames) {
  const Course plain = course(CacheChoice::none, HistoryChoice::accumulate, 8);
  for (const HistoryChoice history : {HistoryChoice::none, HistoryChoice::accumulate}) {
    const Course psf = course(CacheChoice::psf, history, 8);
    for (size_t i = 0; i < 8; ++i) EXPECT_LT(psf.error[i], plain.error[i]) << i;
  }
}

TEST(SharedCacheErrors, ApsfHasThatOfPsfWithFewerRays) {
  const Course psf = course(CacheChoice::psf, HistoryChoice::none, 24);
  const Course apsf = course(CacheChoice::apsf, HistoryChoice::none, 24);
  EXPECT_LT(apsf.rays, 0.8 * psf.rays);
  for (size_t i = 0; i < 24; ++i) EXPECT_LT(apsf.error[i], 1.1 * psf.error[i]) << i;
}

/// For frames after cells have settled: squared difference of their mean from the reference, and variance of a frame.
struct Settled {
  double bias2 = 0;
  double variance = 0;
};
Settled settle(CacheChoice cache, float constant) {
  constexpr int kSkip = 24;
  constexpr int kFrames = 128;
  RenderSettings s = settings_of(cache, HistoryChoice::none);
  s.apg.variance_constant = constant;
  Settled result;
  std::vector<Image> means;
  double count = 0;
  for (const bool counts : truth().counts) count += counts ? 3 : 0;
  for (s.seed = 1; s.seed <= 2; ++s.seed) {
    Session session(cornell(), s);
    std::vector<Image> frames;
    for (int i = 0; i < kSkip + kFrames; ++i) {
      session.render_frame();
      if (i >= kSkip) frames.push_back(session.image());
    }
    const Moments m = moments_of(std::move(frames));
    for (size_t i = 0; i < m.variance.size(); ++i) {
      if (truth().counts[i])
        result.variance += static_cast<double>(m.variance[i].r + m.variance[i].g + m.variance[i].b);
    }
    means.push_back(m.mean_image());
  }
  result.variance /= 2 * count;
  // The product of two independent differences contains only the noise of the reference, which is equal for all.
  for (size_t i = 0; i < truth().counts.size(); ++i) {
    if (!truth().counts[i]) continue;
    const glm::dvec3 a(means[0].pixels[i] - truth().image.pixels[i]);
    const glm::dvec3 b(means[1].pixels[i] - truth().image.pixels[i]);
    result.bias2 += glm::dot(a, b) / count;
  }
  return result;
}

TEST(CacheErrorsSlow, PathGraphsTradeBiasForVariance) {
  const Settled path = settle(CacheChoice::none, 0);
  const Settled psf = settle(CacheChoice::psf, 0);
  std::vector<Settled> graphs;
  for (const float constant : {0.0f, 0.01f, 0.1f, 1.0f, 10.0f, 1000.0f})
    graphs.push_back(settle(CacheChoice::apg, constant));
  bool better = false;
  for (size_t i = 0; i < graphs.size(); ++i) {
    better = better || (graphs[i].variance <= 0.5 * path.variance && graphs[i].bias2 < psf.bias2);
    if (i == 0) continue;
    EXPECT_GE(graphs[i].variance, 0.98 * graphs[i - 1].variance) << i;
    EXPECT_LE(graphs[i].bias2, 1.02 * graphs[i - 1].bias2) << i;
  }
  EXPECT_TRUE(better);
  // With a constant of 0, graphs also display cells, whose samples hold the means of deeper ones: slightly less noise.
  EXPECT_LT(graphs[0].variance, 1.02 * psf.variance);
  EXPECT_GT(graphs[0].variance, 0.85 * psf.variance);
  for (size_t i = 2; i < graphs.size(); ++i) EXPECT_GT(graphs[i].variance, psf.variance) << i;
}

}  // namespace
}  // namespace relume::support
