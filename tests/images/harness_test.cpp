// Tests the statistical image test: whether it can fail, and its rate of rejections.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "builtin_scenes/builtin.h"
#include "support/image_test.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kSeeds = 16;

Scene cornell() { return find_builtin_scene("cornell")->build(); }

/// The same room with the lamp's radiance times `factor`.
Scene cornell_with_lamp(float factor) {
  Scene scene = cornell();
  for (Material& m : scene.materials) m.emission *= factor;
  return scene;
}

Moments images(const Scene& scene, int first_seed, int spp = 16) {
  return measure(scene, small_settings(32, 32), spp, kSeeds, first_seed);
}

/// Images of the room, rendered once per process.
const Moments& some_images() {
  static const Moments moments = images(cornell(), 1);
  return moments;
}
/// The same with other seeds.
const Moments& other_images() {
  static const Moments moments = images(cornell(), 101);
  return moments;
}

TEST(ImageTest, StudentsDistribution) {
  // With one and two degrees of freedom, the distribution has a closed form.
  for (const double t : {0.1, 1.0, 3.0, 40.0}) {
    EXPECT_NEAR(student_two_sided_p(t, 1), 1 - 2 / M_PI * std::atan(t), 1e-12);
    EXPECT_NEAR(student_two_sided_p(t, 2), 1 - t / std::sqrt(2 + t * t), 1e-12);
    EXPECT_NEAR(student_two_sided_p(t, 1e8), std::erfc(t / std::sqrt(2.0)), 1e-6);
    for (const double degrees : {1.0, 5.0, 30.0})
      EXPECT_NEAR(student_two_sided_quantile(student_two_sided_p(t, degrees), degrees), t, 1e-6 * t);
  }
}

TEST(ImageTest, AcceptsTheSameSceneUnderOtherSeeds) {
  const ImageTest test = compare(some_images(), other_images());
  EXPECT_TRUE(test.agree()) << test.report();
}

TEST(ImageTest, FalseAlarmRateIsAsStated) {
  const ImageTest test = compare(some_images(), other_images());
  // p is the lowest of three channels, between nearly independent and fully dependent: between 5 and 14 %.
  const auto below = std::count_if(test.p.begin(), test.p.end(), [](float p) { return p < 0.05f; });
  const double share = static_cast<double>(below) / static_cast<double>(test.p.size());
  EXPECT_GT(share, 0.03);
  EXPECT_LT(share, 0.16);
}

TEST(ImageTest, RejectsALampThatIsTwoPercentBrighter) {
  const Moments reference = images(cornell(), 1, 128);
  const ImageTest test = compare(images(cornell_with_lamp(1.02f), 101, 128), reference);
  EXPECT_FALSE(test.agree()) << test.report();
  EXPECT_GT(test.rejected_blocks, 0);
  EXPECT_GT(test.rejected_means, 0);
  EXPECT_NEAR(test.worst_mean, 0.02, 0.005);
  EXPECT_LT(test.detectable_mean, 0.02);
}

/// Expects the stated detectable errors to be detected.
TEST(ImageTest, RejectsDetectableDifferences) {
  const Moments reference = images(cornell(), 1, 8);
  const double detectable = compare(images(cornell(), 101, 8), reference).detectable_mean;
  const auto factor = static_cast<float>(1 + 1.5 * detectable);
  const ImageTest test = compare(images(cornell_with_lamp(factor), 101, 8), reference);
  EXPECT_GT(test.rejected_means, 0) << test.report();
}

TEST(ImageTest, CannotTellAnythingInTheDark) {
  const Moments black = moments_of(std::vector<Image>(kSeeds, Image(32, 32)));
  EXPECT_EQ(compare(black, black).detectable, INFINITY);
}

TEST(ImageTest, RefusesToTellAlmostNothing) {
  EXPECT_NONFATAL_FAILURE(expect_same_image("refused", some_images(), some_images(), {.detectable = kMostDetectable}),
                          "black block");
}

TEST(ImageTest, RejectsOneWrongPixel) {
  const Moments& reference = some_images();
  std::vector<Image> others = other_images().images;
  const Rgb spread = glm::sqrt(reference.variance[17]);
  for (Image& image : others) image.pixels[17] += 4.0f * spread;
  const ImageTest test = compare(moments_of(std::move(others)), reference);
  EXPECT_EQ(test.rejected_pixels, 1);
  EXPECT_LT(test.p[17], test.pixel_threshold);
}

}  // namespace
}  // namespace relume::support
