#include "metrics/temporal.h"

#include <gtest/gtest.h>

#include "core/hash.h"
#include "relume/error.h"

namespace relume {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 32;

Image make_noise(uint32_t seed) {
  Image image(kWidth, kHeight);
  uint32_t i = 0;
  for (Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = to_unit_float(hash(seed, ++i));
  }
  return image;
}

/// All surfaces move by `motion` pixels.
SurfaceMotion make_surface(Vec2 motion) {
  const size_t count = size_t{kWidth} * kHeight;
  return {std::vector<Vec2>(count, motion), std::vector<float>(count, 2.0f), std::vector<Vec3>(count, Vec3(0, 1, 0))};
}

Image shifted(const Image& image, int dx, int dy) {
  Image result(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      result.at(x, y) = image.at((x - dx + kWidth) % kWidth, (y - dy + kHeight) % kHeight);
    }
  }
  return result;
}

Image sum(const Image& a, const Image& b) {
  Image result = a;
  for (size_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] += b.pixels[i];
  return result;
}

TEST(TemporalError, ErrorsFixedToSurfacesDoNotFlicker) {
  const Image scene = make_noise(1);
  const Image error = make_noise(2);
  const TemporalError e = temporal_error(shifted(sum(scene, error), 5, -3), shifted(scene, 5, -3),
                                         make_surface({5, -3}), sum(scene, error), scene, make_surface({0, 0}));
  EXPECT_LT(e.mse, 1e-13);  // allows for rounding
  EXPECT_EQ(e.pixels, static_cast<uint64_t>((kWidth - 5) * (kHeight - 3)));
}

TEST(TemporalError, ErrorsFixedToTheScreenFlicker) {
  const Image scene = make_noise(1);
  const Image error = make_noise(2);
  const TemporalError e = temporal_error(sum(shifted(scene, 5, 0), error), shifted(scene, 5, 0), make_surface({5, 0}),
                                         sum(scene, error), scene, make_surface({0, 0}));
  EXPECT_NEAR(e.mse, 2.0 / 12, 0.02);  // two uniform errors of variance 1/12; 4 128 values
}

TEST(TemporalError, IndependentNoiseCountsTwice) {
  const Image black(kWidth, kHeight);
  const TemporalError e =
      temporal_error(make_noise(1), black, make_surface({0, 0}), make_noise(2), black, make_surface({0, 0}));
  EXPECT_NEAR(e.mse, 2.0 / 12, 0.02);
  EXPECT_NEAR(e.rel_mse, e.mse / 0.01, 1e-6 * e.rel_mse);
}

TEST(TemporalError, EstimatesTheNoiseOfReferences) {
  // Images without error against noisy references: all of the temporal error is the references'.
  const Image black(kWidth, kHeight);
  Image variance(kWidth, kHeight);
  for (Rgb& pixel : variance.pixels) pixel = Rgb(1.0f / 12);
  const Image noisy = make_noise(1);
  const TemporalError e =
      temporal_error(black, noisy, make_surface({5, 0}), black, make_noise(2), make_surface({0, 0}));
  const TemporalError noise = temporal_noise(noisy, variance, make_surface({5, 0}), variance, make_surface({0, 0}));
  EXPECT_EQ(noise.pixels, e.pixels);
  EXPECT_NEAR(noise.mse, 2.0 / 12, 1e-7);
  EXPECT_NEAR(e.mse, noise.mse, 0.02);
  EXPECT_THROW(temporal_noise(noisy, Image(2, 2), make_surface({5, 0}), variance, make_surface({0, 0})), Error);
}

TEST(TemporalError, ChangesOfTheReferenceDoNotCount) {
  const Image dark(kWidth, kHeight);
  const Image bright = make_noise(3);
  const TemporalError e = temporal_error(bright, bright, make_surface({0, 0}), dark, dark, make_surface({0, 0}));
  EXPECT_EQ(e.mse, 0);
}

TEST(TemporalError, ExcludesPixelsWithoutHistory) {
  const Image image = make_noise(1);
  const Image black(kWidth, kHeight);
  SurfaceMotion now = make_surface({0, 0});
  SurfaceMotion before = make_surface({0, 0});
  before.depth[0] = 3.0f;
  before.normal[1] = Vec3(1, 0, 0);
  before.depth[2] = 0.0f;
  now.motion[3] = Vec2(kInfinity, 0);
  EXPECT_EQ(temporal_error(image, black, now, image, black, before).pixels,
            static_cast<uint64_t>(kWidth * kHeight - 4));
  EXPECT_THROW(temporal_error(image, Image(2, 2), now, image, black, before), Error);
  now.depth.pop_back();
  EXPECT_THROW(temporal_error(image, black, now, image, black, before), Error);
}

}  // namespace
}  // namespace relume
