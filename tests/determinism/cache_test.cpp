// Caches keep a state beyond their buffers: it, too, gives the same bits with any number of threads and after a resume,
// and follows what changes in the scene.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <string>

#include "render/session.h"
#include "scene/builtin.h"
#include "support/measure.h"

namespace relume::support {
namespace {

class CacheSession : public ::testing::TestWithParam<CacheChoice> {};

RenderSettings settings_of(CacheChoice cache, int threads) {
  RenderSettings s = small_settings(45, 37);
  s.threads = threads;
  s.cache = cache;
  s.apsf.min_samples = 16;
  return s;
}

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

std::vector<Rgb> shown(const Session& session) { return session.image().pixels; }

bool same_bits(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

TEST_P(CacheSession, SameBitsWithAnyNumberOfThreads) {
  const auto rendered = [](int threads) {
    Session session(build("cornell-glass"), settings_of(GetParam(), threads));
    for (int i = 0; i < 4; ++i) session.render_frame();
    EXPECT_TRUE(session.warnings().empty());
    return shown(session);
  };
  const std::vector<Rgb> one = rendered(1);
  EXPECT_TRUE(same_bits(rendered(2), one));
  EXPECT_TRUE(same_bits(rendered(5), one));
}

TEST_P(CacheSession, ResumedEqualsUninterrupted) {
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / ("relume_cache_" + std::to_string(::getpid()) + ".ckpt");
  const RenderSettings settings = settings_of(GetParam(), 2);
  Session whole(build("cornell"), settings);
  for (int i = 0; i < 3; ++i) whole.render_frame();
  whole.save_checkpoint(file);
  Session resumed(build("cornell"), settings);
  resumed.load_checkpoint(file);
  for (int i = 0; i < 2; ++i) {
    whole.render_frame();
    resumed.render_frame();
  }
  EXPECT_TRUE(same_bits(shown(resumed), shown(whole)));
  std::filesystem::remove(file);
}

double mean_of(const std::vector<Rgb>& pixels) {
  double sum = 0;
  for (const Rgb& p : pixels) sum += static_cast<double>(luminance(p));
  return sum / static_cast<double>(pixels.size());
}

TEST_P(CacheSession, AChangedLightShowsWithinAFewFrames) {
  RenderSettings settings = settings_of(GetParam(), 2);
  settings.history = HistoryChoice::none;
  Scene scene = build("furnace");
  Environment environment = scene.environment;
  Session session(std::move(scene), settings);
  for (int i = 0; i < 40; ++i) session.render_frame();
  const double before = mean_of(shown(session));
  environment.color *= 3.0f;
  session.set_environment(environment);
  // What the pages promise. Where the variance is low, adaptive filtering follows but a tenth of the paths, so its
  // cells hear later of a change.
  const bool adaptive = GetParam() == CacheChoice::apsf || GetParam() == CacheChoice::apsf_apg;
  const int frames = adaptive ? 24 : 8;
  for (int i = 0; i < frames; ++i) session.render_frame();
  EXPECT_NEAR(mean_of(shown(session)) / before, 3.0, 0.15);
}

TEST_P(CacheSession, ReportsTheTable) {
  Session session(build("cornell"), settings_of(GetParam(), 2));
  session.render_frame();
  double cells = 0;
  for (const PassFigure& figure : session.statistics().figures) {
    if (figure.name == "cells.cells") cells = figure.value;
  }
  EXPECT_GT(cells, 10.0);
  RenderSettings tight = settings_of(GetParam(), 2);
  tight.psf.grid.max_cells = 64;
  Session crowded(build("cornell"), tight);
  crowded.render_frame();
  EXPECT_EQ(crowded.warnings().size(), 1u);
}

std::string cache_name(const ::testing::TestParamInfo<CacheChoice>& instance) {
  const char* names[] = {"none", "psf", "apsf", "apg", "apsf_apg"};
  return names[static_cast<int>(instance.param)];
}

INSTANTIATE_TEST_SUITE_P(Caches, CacheSession,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg,
                                           CacheChoice::apsf_apg),
                         cache_name);

}  // namespace
}  // namespace relume::support
