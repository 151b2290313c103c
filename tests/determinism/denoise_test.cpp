// Tests the denoisers' history buffers: equal bits with any number of threads, after a resume and after an abandoned
// frame. Also tests denoisers with every source of samples.
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <stop_token>
#include <thread>

#include "determinism/same_bits.h"
#include "relume/error.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "techniques/denoise/oidn/oidn_filter.h"

namespace relume::support {
namespace {

/// MSE of the displayed image: radiance clamped to 1.
double shown_mse(Image a, Image b) {
  for (Image* image : {&a, &b}) {
    for (Rgb& pixel : image->pixels) pixel = glm::min(pixel, Rgb(1));
  }
  return mse(a, b);
}

class DenoiseSession : public ::testing::TestWithParam<DenoiseChoice> {};

RenderSettings settings_of(DenoiseChoice denoise, int threads) {
  RenderSettings s = small_settings(85, 47);  // not a multiple of tiles, blocks or lanes
  s.threads = threads;
  s.denoise = denoise;
  s.asvgf.view_changes = true;  // traces gradients while the camera moves
  return s;
}

/// Frames of a camera that rests, moves and rests again.
void play(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) {
    if (i % 4 == 2) {
      CameraPose camera = session.camera();
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

TEST_P(DenoiseSession, AbandonedFramesLeaveNoTrace) {
  const RenderSettings settings = settings_of(GetParam(), 1);
  Session whole(build("cornell"), settings);
  Session stopped(build("cornell"), settings);
  whole.render_frame();
  stopped.render_frame();
  const auto frame_s = std::chrono::duration<double>(stopped.statistics().render_s);
  int abandoned = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {  // wall-clock time determines whether and where it stops
    std::stop_source stop;
    std::jthread later([&] {
      std::this_thread::sleep_for(0.025 * attempt * frame_s);
      stop.request_stop();
    });
    if (stopped.render_frame(stop.get_token())) {
      whole.render_frame();
    } else {
      ++abandoned;
    }
  }
  EXPECT_GT(abandoned, 0);
  EXPECT_TRUE(same_bits(stopped.image(), whole.image()));
}

struct Combination {
  const char* scene;
  EstimatorChoice estimator;
  const char* json;  ///< other settings
  double bmfr;       ///< largest display error relative to that without a denoiser
  double svgf;
  int reference = 64;  ///< samples of the true image, whose noise counts as an error of all
};

// Measured: 1.34 and 0.93, 0.030 and 0.010, 1.05 and 1.02, 0.28 and 0.45, 0.13 and 0.09.
const Combination kCombinations[] = {
    // bdpt has little noise after few frames, so that the filter's blur may weigh slightly more. The same applies to
    // cells.
    {"cornell-water", EstimatorChoice::bdpt, "{}", 1.5, 1.1},
    {"cornell-mirror", EstimatorChoice::light, R"({"history": "none"})", 0.06, 0.03, 128},
    {"cornell", EstimatorChoice::path, R"({"cache": "psf"})", 1.15, 1.15},
    {"mine", EstimatorChoice::path, R"({"allocation": "adaptive"})", 0.4, 0.6},
    {"cornell", EstimatorChoice::path, R"({"allocation": "adaptive", "history": "reproject"})", 0.25, 0.2, 128},
};

Image after_moves(const Combination& c, DenoiseChoice denoise, CameraPose* camera = nullptr) {
  RenderSettings s = settings_of(denoise, 2);
  s.estimator = c.estimator;
  settings_from_json(describe(s), c.json, c.scene);
  Session session(build(c.scene), s);
  play(session, 6);
  if (camera) *camera = session.camera();
  return session.image();
}

TEST(DenoisedCombination, LowersTheErrorWithAnySamplesAndHistory) {
  for (const Combination& c : kCombinations) {
    CameraPose camera;
    const Image plain = after_moves(c, DenoiseChoice::none, &camera);
    RenderSettings many = settings_of(DenoiseChoice::none, 2);
    many.estimator = c.estimator;
    many.seed = 1001;
    Session truth(build(c.scene), many);
    truth.set_camera(camera);
    for (int i = 0; i < c.reference; ++i) truth.render_frame();
    const double before = shown_mse(plain, truth.image());
    EXPECT_LT(shown_mse(after_moves(c, DenoiseChoice::bmfr), truth.image()), c.bmfr * before) << c.scene << c.json;
    EXPECT_LT(shown_mse(after_moves(c, DenoiseChoice::svgf), truth.image()), c.svgf * before) << c.scene << c.json;
  }
}

/// The turntable at a time, without a denoiser; rendered once per process, because no denoiser changes it.
const Image& truth_at(float time_s) {
  static std::map<float, Image> known;
  const auto [found, is_new] = known.try_emplace(time_s);
  if (is_new) {
    RenderSettings s = settings_of(DenoiseChoice::none, 2);
    s.time_s = time_s;
    s.seed = 1001;
    found->second = render(build("turntable"), s, 128);
  }
  return found->second;
}

TEST_P(DenoiseSession, MovingObjectsAndLightsAreFollowed) {
  constexpr int kFrames = 12;
  const auto time_of = [](int frame) { return 0.1f * static_cast<float>(frame); };
  Session session(build("turntable"), settings_of(GetParam(), 2));
  for (int i = 0; i < kFrames; ++i) {
    session.set_time(time_of(i));
    session.render_frame();
  }
  const Image& now = truth_at(time_of(kFrames - 1));
  // At ten frames per second, a lag of half a second would cause most of this difference.
  EXPECT_LT(shown_mse(session.image(), now), 0.25 * shown_mse(truth_at(0), now));
  EXPECT_NEAR(mean_luminance(session.image()) / mean_luminance(now), 1.0, 0.1);
}

TEST(Denoise, ErrorWithoutOidnNamesTheRemedy) {
  if (oidn_missing().empty()) GTEST_SKIP() << "the library is installed";
  try {
    Session session(build("cornell"), settings_of(DenoiseChoice::oidn, 1));
    session.render_frame();
    FAIL() << "rendered without the library";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("openimagedenoise.org"), std::string::npos);
  }
}

std::string denoiser_name(const ::testing::TestParamInfo<DenoiseChoice>& instance) {
  if (instance.param == DenoiseChoice::asvgf) return "asvgf";
  return instance.param == DenoiseChoice::bmfr ? "bmfr" : "svgf";
}

INSTANTIATE_TEST_SUITE_P(Denoisers, DenoiseSession,
                         ::testing::Values(DenoiseChoice::bmfr, DenoiseChoice::svgf, DenoiseChoice::asvgf),
                         denoiser_name);

}  // namespace
}  // namespace relume::support
