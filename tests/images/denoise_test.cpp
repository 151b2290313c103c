// Tests denoised against converged images: the reduction of error against the noisy input, and details that no feature
// contains.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 96;

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

RenderSettings settings_of(DenoiseChoice denoise, EstimatorChoice estimator = EstimatorChoice::path) {
  RenderSettings s = small_settings(kWidth, kHeight);
  s.denoise = denoise;
  s.estimator = estimator;
  return s;
}

struct Region {
  int x0 = 0;
  int y0 = 0;
  int x1 = kWidth;
  int y1 = kHeight;
};

/// Mean squared difference of displayed images: radiance clamped to 1.
double shown_mse(const Image& a, const Image& b, const Region& r = {}) {
  double sum = 0;
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x) {
      const auto i = static_cast<size_t>(int64_t{y} * a.width + x);
      sum += static_cast<double>(length_squared(glm::min(a.pixels[i], Rgb(1)) - glm::min(b.pixels[i], Rgb(1)))) / 3.0;
    }
  }
  return sum / ((r.x1 - r.x0) * (r.y1 - r.y0));
}

CameraPose moved(CameraPose camera, int frames) {
  camera.to_world[3] += 0.04f * static_cast<float>(frames) * camera.to_world[0];
  return camera;
}

/// Reference, rendered once per process.
const Image& reference_of(const char* scene, EstimatorChoice estimator, int moving) {
  static std::map<std::tuple<std::string, EstimatorChoice, int>, Image> known;
  Image& image = known[{scene, estimator, moving}];
  if (image.pixels.empty()) {
    RenderSettings settings = settings_of(DenoiseChoice::none, estimator);
    settings.seed = 77;
    Session session(build(scene), settings);
    session.set_camera(moved(session.camera(), moving));
    for (int i = 0; i < 64; ++i) session.render_frame();
    image = session.image();
  }
  return image;
}

/// A session's images after some frames: the denoised one, the mean of all samples, and the last frame's sample.
struct SessionImages {
  SessionImages(const char* scene, const RenderSettings& settings, int still, int moving)
      : reference(reference_of(scene, settings.estimator, moving)) {
    Session session(build(scene), settings);
    const CameraPose start = session.camera();
    for (int i = 0; i < still; ++i) session.render_frame();
    for (int i = 1; i <= moving; ++i) {
      session.set_camera(moved(start, i));
      session.render_frame();
    }
    denoised = session.image();
    noisy = image(session, kRadiance);
    mean = image(session, kMean);
  }

  static Image image(const Session& session, const BufferKey<Rgb>& buffer) {
    Image image(kWidth, kHeight);
    const auto pixels = buffer_table(session).read(buffer);
    std::copy(pixels.begin(), pixels.end(), image.pixels.begin());
    return image;
  }

  const Image& reference;
  Image denoised;
  Image noisy;
  Image mean;
};

/// Each test runs all denoisers, since references are rendered once per process.
class DenoisedImage : public ::testing::Test {
 protected:
  template <typename Check>
  static void for_each_denoiser(const Check& check) {
    for (const DenoiseChoice denoise : {DenoiseChoice::bmfr, DenoiseChoice::svgf, DenoiseChoice::asvgf}) {
      SCOPED_TRACE(denoise == DenoiseChoice::bmfr ? "bmfr" : denoise == DenoiseChoice::svgf ? "svgf" : "asvgf");
      check(denoise);
    }
  }
};

TEST_F(DenoisedImage, ATenthOfTheErrorWhereNothingMoves) {
  for_each_denoiser([](DenoiseChoice denoise) {
    const SessionImages s("cornell", settings_of(denoise), 8, 0);
    EXPECT_LT(shown_mse(s.denoised, s.reference), 0.1 * shown_mse(s.noisy, s.reference));
  });
}

TEST_F(DenoisedImage, AFifthOfTheErrorWhereTheCameraMoves) {
  for_each_denoiser([](DenoiseChoice denoise) {
    const SessionImages s("cornell", settings_of(denoise), 1, 8);
    EXPECT_LT(shown_mse(s.denoised, s.reference), 0.2 * shown_mse(s.noisy, s.reference));
  });
}

TEST_F(DenoisedImage, IsAsBrightAsTheScene) {
  for_each_denoiser([](DenoiseChoice denoise) {
    const SessionImages s("cornell", settings_of(denoise), 16, 0);
    EXPECT_NEAR(mean_luminance(s.denoised) / mean_luminance(s.reference), 1.0, 0.02);  // the pages' stated bias
  });
}

/// Details that features do not contain survive: the error falls below that of the samples' mean.
TEST_F(DenoisedImage, MirrorImagesSurvive) {
  for_each_denoiser([](DenoiseChoice denoise) {
    const SessionImages s("cornell-mirror", settings_of(denoise, EstimatorChoice::bdpt), 8, 0);
    const Region mirror{16, 16, 80, 60};
    EXPECT_LT(shown_mse(s.denoised, s.reference, mirror), 0.8 * shown_mse(s.mean, s.reference, mirror));
  });
}

TEST_F(DenoisedImage, CausticsSurvive) {
  for_each_denoiser([](DenoiseChoice denoise) {
    const SessionImages s("cornell-glass", settings_of(denoise, EstimatorChoice::bdpt), 16, 0);
    const Region floor{8, 70, 88, 94};
    EXPECT_LT(shown_mse(s.denoised, s.reference, floor), 0.8 * shown_mse(s.mean, s.reference, floor));
  });
}

/// Expects that caches' averaged emission at lamp edges is not added to surfaces there.
TEST_F(DenoisedImage, EdgesOfLampsDoNotShineThroughCaches) {
  for_each_denoiser([](DenoiseChoice denoise) {
    RenderSettings settings = settings_of(denoise);
    settings.cache = CacheChoice::psf;
    const SessionImages s("cornell", settings, 1, 4);
    EXPECT_LT(shown_mse(s.denoised, s.reference), 1.2 * shown_mse(s.noisy, s.reference));
    for (const Rgb& pixel : s.denoised.pixels) ASSERT_GE(std::min({pixel.x, pixel.y, pixel.z}), 0);
  });
}

TEST_F(DenoisedImage, AFurnaceStaysWhite) {
  const double truth = mean_luminance(reference_of("furnace", EstimatorChoice::path, 0));
  for_each_denoiser([&](DenoiseChoice denoise) {
    Session session(build("furnace"), settings_of(denoise));
    for (int i = 0; i < 4; ++i) session.render_frame();
    EXPECT_NEAR(mean_luminance(session.image()) / truth, 1.0, 2e-3);
  });
}

/// First frame of a view, after frames of another view or (0) of none.
Image first_of_a_view(const RenderSettings& settings, int frames_before) {
  Session session(build("cornell-closed"), settings);
  const CameraPose there = session.camera();
  CameraPose elsewhere = there;
  elsewhere.to_world[0] = -there.to_world[0];  // turned by 180°
  elsewhere.to_world[2] = -there.to_world[2];
  session.set_camera(elsewhere);
  for (int i = 0; i < frames_before; ++i) session.render_frame();
  session.set_camera(there);
  session.render_frame();
  return session.image();
}

TEST_F(DenoisedImage, CutsAreFilteredLikeFirstFrames) {
  for_each_denoiser([](DenoiseChoice denoise) {
    const Image& reference = reference_of("cornell-closed", EstimatorChoice::path, 0);
    double first = 0;
    double after_cut = 0;
    for (int seed = 1; seed <= 6; ++seed) {
      RenderSettings settings = settings_of(denoise);
      settings.seed = seed;
      first += shown_mse(first_of_a_view(settings, 0), reference);
      after_cut += shown_mse(first_of_a_view(settings, 4), reference);
    }
    EXPECT_NEAR(after_cut / first, 1.0, 0.25);
  });
}

}  // namespace
}  // namespace relume::support
