// Tests the caches' state beyond their buffers: equal bits with any number of threads and after a resume, and
// adaptation to scene changes.
#include <gtest/gtest.h>

#include <algorithm>

#include "determinism/same_bits.h"
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

TEST_P(CacheSession, SameBitsWithAnyNumberOfThreads) {
  const auto rendered = [](int threads) {
    Session session(build("cornell-glass"), settings_of(GetParam(), threads));
    for (int i = 0; i < 4; ++i) session.render_frame();
    EXPECT_TRUE(session.warnings().empty());
    return session.image();
  };
  const Image one = rendered(1);
  EXPECT_TRUE(same_bits(rendered(2), one));
  EXPECT_TRUE(same_bits(rendered(5), one));
}

/// For a scene and an image size where the cells of a voxel, or of the first frame, exceed the table's capacity.
void expect_same_bits_with_many_cells(const char* name, CacheChoice cache) {
  const auto rendered = [&](int threads) {
    RenderSettings settings;
    settings.width = 320;
    settings.height = 180;
    settings.threads = threads;
    settings.cache = cache;
    Session session(build(name), settings);
    for (int i = 0; i < 2; ++i) session.render_frame();
    EXPECT_TRUE(session.warnings().empty()) << name;
    return session.image();
  };
  EXPECT_TRUE(same_bits(rendered(5), rendered(1))) << name;
}

class ManyCells : public CacheSession {};
TEST_P(ManyCells, HaveTheSameBits) { expect_same_bits_with_many_cells("mine", GetParam()); }

class SlowManyCells : public CacheSession {};
TEST_P(SlowManyCells, HaveTheSameBits) {
  for (const char* name : {"mine", "warehouse", "corridor"}) expect_same_bits_with_many_cells(name, GetParam());
}

/// A dim lamp whose edge is detected depending on the brightness of the surrounding cells, including new ones.
TEST_P(CacheSession, SameEdgesOfADimLampWithAnyNumberOfThreads) {
  const auto rendered = [](int threads) {
    Scene scene = build("cornell");
    scene.environment.kind = EnvironmentKind::constant;
    scene.environment.color = Rgb(0.5f);
    for (Material& m : scene.materials) m.emission *= 0.6f / std::max(max_component(m.emission), 0.6f);
    RenderSettings settings = settings_of(GetParam(), threads);
    settings.width = settings.height = 128;
    Session session(std::move(scene), settings);
    session.render_frame();
    return session.image();
  };
  const Image one = rendered(1);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(same_bits(rendered(2 + i), one));
}

TEST_P(CacheSession, ResumedEqualsUninterrupted) {
  expect_resumed_equals_uninterrupted(settings_of(GetParam(), 2), "cache");
}

TEST_P(CacheSession, AChangedLightShowsWithinAFewFrames) {
  RenderSettings settings = settings_of(GetParam(), 2);
  settings.history = HistoryChoice::none;
  Scene scene = build("furnace");
  Environment environment = scene.environment;
  Session session(std::move(scene), settings);
  for (int i = 0; i < 40; ++i) session.render_frame();
  const double before = mean_luminance(session.image());
  environment.color *= 3.0f;
  session.set_environment(environment);
  // Tests the response time stated by the pages. With low variance, adaptive filtering traces only a tenth of the
  // paths, so its cells detect changes later.
  const bool adaptive = GetParam() == CacheChoice::apsf || GetParam() == CacheChoice::apsf_apg;
  const int frames = adaptive ? 24 : 8;
  for (int i = 0; i < frames; ++i) session.render_frame();
  EXPECT_NEAR(mean_luminance(session.image()) / before, 3.0, 0.15);
}

TEST_P(CacheSession, ReportsTheTable) {
  Session session(build("cornell"), settings_of(GetParam(), 2));
  session.render_frame();
  double cells = 0;
  for (const PassStatistic& figure : session.statistics().pass_statistics) {
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

const auto kCaches = ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg);
INSTANTIATE_TEST_SUITE_P(Caches, CacheSession, kCaches, cache_name);
// Together, these two caches execute all code of the others.
INSTANTIATE_TEST_SUITE_P(Caches, ManyCells, ::testing::Values(CacheChoice::psf, CacheChoice::apsf_apg), cache_name);
INSTANTIATE_TEST_SUITE_P(Caches, SlowManyCells, kCaches, cache_name);

}  // namespace
}  // namespace relume::support
