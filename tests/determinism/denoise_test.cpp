// Denoisers keep histories in buffers: the same bits with any number of threads, after a resume and after a frame that
// was abandoned; and they work with whatever samples the pixels.
#include <gtest/gtest.h>

#include "core/error.h"
#include "determinism/same_bits.h"
#include "support/measure.h"

namespace relume::support {
namespace {

class DenoiseSession : public ::testing::TestWithParam<DenoiseChoice> {};

RenderSettings settings_of(DenoiseChoice denoise, int threads) {
  RenderSettings s = small_settings(85, 47);  // no multiple of tiles, blocks or lanes
  s.threads = threads;
  s.denoise = denoise;
  return s;
}

/// Frames of a camera that stands, moves and stands again.
void play(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) {
    if (i % 4 == 2) {
      PlacedCamera camera = session.scene().camera();
      camera.to_world[3] += 0.05f * camera.to_world[0];
      session.set_camera(camera);
    }
    session.render_frame();
  }
}

TEST_P(DenoiseSession, SameBitsWithAnyNumberOfThreads) {
  const auto rendered = [](int threads) {
    Session session(build("cornell-glass"), settings_of(GetParam(), threads));
    play(session, 6);
    return session.image();
  };
  const Image one = rendered(1);
  EXPECT_TRUE(same_bits(rendered(2), one));
  EXPECT_TRUE(same_bits(rendered(5), one));
}

TEST_P(DenoiseSession, ResumedEqualsUninterrupted) {
  expect_resumed_equals_uninterrupted(settings_of(GetParam(), 2), "denoise");
}

TEST_P(DenoiseSession, AFrameThatIsAbandonedLeavesNothingBehind) {
  const RenderSettings settings = settings_of(GetParam(), 1);
  Session whole(build("cornell"), settings);
  Session stopped(build("cornell"), settings);
  std::stop_source stop;
  stop.request_stop();
  for (int i = 0; i < 3; ++i) {
    whole.render_frame();
    EXPECT_FALSE(stopped.render_frame(stop.get_token()));
    EXPECT_TRUE(stopped.render_frame());
  }
  EXPECT_TRUE(same_bits(stopped.image(), whole.image()));
}

TEST_P(DenoiseSession, TakesAnySamplesAndAnyHistory) {
  struct Combination {
    const char* scene;
    EstimatorChoice estimator;
    CacheChoice cache;
    AllocationChoice allocation;
    HistoryChoice history;
  };
  for (const Combination& c : {Combination{"cornell-water", EstimatorChoice::bdpt, CacheChoice::none,
                                           AllocationChoice::uniform, HistoryChoice::accumulate},
                               Combination{"cornell-mirror", EstimatorChoice::light, CacheChoice::none,
                                           AllocationChoice::uniform, HistoryChoice::none},
                               Combination{"cornell", EstimatorChoice::path, CacheChoice::psf,
                                           AllocationChoice::uniform, HistoryChoice::accumulate},
                               Combination{"mine", EstimatorChoice::path, CacheChoice::none, AllocationChoice::adaptive,
                                           HistoryChoice::accumulate},
                               Combination{"cornell", EstimatorChoice::path, CacheChoice::none,
                                           AllocationChoice::adaptive, HistoryChoice::reproject}}) {
    RenderSettings s = settings_of(GetParam(), 2);
    s.estimator = c.estimator;
    s.cache = c.cache;
    s.allocation = c.allocation;
    s.history = c.history;
    Session session(build(c.scene), s);
    play(session, 6);
    double sum = 0;
    for (const Rgb& pixel : session.image().pixels) {
      ASSERT_TRUE(is_finite(pixel));
      sum += static_cast<double>(luminance(pixel));
    }
    EXPECT_GT(sum, 0.0);
  }
}

TEST_P(DenoiseSession, MovingObjectsAndLightsAreFollowed) {
  RenderSettings s = settings_of(GetParam(), 2);
  Session session(build("turntable"), s);
  for (int i = 0; i < 6; ++i) {
    session.set_time(0.1f * static_cast<float>(i));
    session.render_frame();
  }
  for (const Rgb& pixel : session.image().pixels) ASSERT_TRUE(is_finite(pixel));
}

TEST(Denoise, SaysWhatToDoWithoutOidn) {
  RenderSettings s = settings_of(DenoiseChoice::oidn, 1);
  try {
    Session session(build("cornell"), s);
    session.render_frame();  // the library is there
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("openimagedenoise.org"), std::string::npos);
  }
}

std::string denoiser_name(const ::testing::TestParamInfo<DenoiseChoice>& instance) {
  return instance.param == DenoiseChoice::bmfr ? "bmfr" : "svgf";
}

INSTANTIATE_TEST_SUITE_P(Denoisers, DenoiseSession, ::testing::Values(DenoiseChoice::bmfr, DenoiseChoice::svgf),
                         denoiser_name);

}  // namespace
}  // namespace relume::support
