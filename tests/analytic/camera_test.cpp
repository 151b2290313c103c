// Tests where cameras project the scene.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

/// Share of the image covered by a white unlit rectangle on black.
double covered_share(Scene scene, int width, int height, int spp) {
  RenderSettings settings = small_settings(width, height);
  settings.path.max_bounces = 0;
  return static_cast<double>(estimate_of(render(std::move(scene), settings, spp)).mean.x);
}

Scene card(const Vec3& low, const Vec3& size) {
  Scene scene;
  add(scene, quad(low, {size.x, 0, 0}, {0, size.y, 0}), unlit(Rgb(1)));
  return scene;
}

TEST(Camera, OrthographicKeepsSizes) {
  for (const float z : {-1.0f, -50.0f}) {
    Scene scene = card({-0.5f, -0.25f, z}, {1.5f, 0.75f, 0});
    add_camera(scene, {.name = "", .projection = Projection::orthographic, .half_height = 1}, Vec3(0), {0, 0, -1});
    EXPECT_NEAR(covered_share(std::move(scene), 64, 32, 64), 1.5 * 0.75 / (4 * 2), 5e-4);  // the image is 4 m by 2 m
  }
}

TEST(Camera, PerspectiveKeepsAngles) {
  const float fov = 0.9f;
  Scene scene = card({-0.5f, -0.5f, -2}, {1, 1, 0});
  add_camera(scene, {.name = "", .fov_y_rad = fov}, Vec3(0), {0, 0, -1});
  const double half = 2 * std::tan(0.45);
  EXPECT_NEAR(covered_share(std::move(scene), 64, 32, 64), 1 / (4 * half * 2 * half), 5e-4);
}

TEST(Camera, RowsRunDownAndColumnsRight) {
  Scene scene = card({0, 0, -2}, {5, 5, 0});  // the upper right quarter
  add_camera(scene, {.name = "", .fov_y_rad = 0.9f}, Vec3(0), {0, 0, -1});
  RenderSettings settings = small_settings(8, 8);
  settings.path.max_bounces = 0;
  const Image image = render(std::move(scene), settings, 4);
  for (int i = 0; i < 64; ++i)
    EXPECT_EQ(image.pixels[static_cast<size_t>(i)].x, i % 8 >= 4 && i / 8 < 4 ? 1.0f : 0.0f) << i;
}

TEST(Camera, PanoramaReproducesTheEnvironmentMap) {
  Scene scene;
  Environment& e = scene.environment;
  e.kind = EnvironmentKind::map;
  e.width = 64;
  e.height = 32;
  for (int i = 0; i < 64 * 32; ++i) {
    const float phi = (static_cast<float>(i % 64) + 0.5f) / 64 * 2 * kPi;
    const float v = (static_cast<float>(i / 64) + 0.5f) / 32;
    e.map.emplace_back(2 + std::sin(phi), 2 + std::cos(phi), 1 + v);
  }
  const std::vector<Rgb> map = e.map;
  add(scene, quad({0, -1e5f, 0}, {1e-3f, 0, 0}, {0, 0, 1e-3f}), matte("far away", Rgb(0)));
  add_camera(scene, {.name = "", .projection = Projection::panoramic}, Vec3(0), {0, 0, -1});
  const Image image = render(std::move(scene), small_settings(64, 32), 256);
  double worst = 0;
  for (size_t i = 64; i < map.size() - 64; ++i)
    worst = std::fmax(worst, glm::length(glm::dvec3(image.pixels[i] - map[i])));
  EXPECT_LT(worst, 0.01);  // box filter over a pixel, and residual noise
}

/// Image of a bright square card at `distance`, with a lens of radius 0.1 m focused at 2 m.
Image photograph(float distance, float card_size) {
  Scene scene = card({-0.5f * card_size, -0.5f * card_size, -distance}, {card_size, card_size, 0});
  add_camera(scene, {.name = "", .fov_y_rad = 2 * std::atan(0.1f), .lens_radius = 0.1f, .focus_distance = 2}, Vec3(0),
             {0, 0, -1});
  RenderSettings settings = small_settings(40, 40);
  settings.path.max_bounces = 0;
  return render(std::move(scene), settings, 128);
}

/// Largest distance of a non-black pixel from the image centre, in pixels.
double spread(const Image& image) {
  double radius = 0;
  for (int i = 0; i < 1600; ++i) {
    if (image.pixels[static_cast<size_t>(i)].x > 0)
      radius = std::fmax(radius, std::hypot(i % 40 - 19.5, i / 40 - 19.5));
  }
  return radius;
}

TEST(Camera, LensIsSharpInFocusAndBlursElsewhere) {
  // In focus, the image is 0.4 m wide at 2 m: 1 cm per pixel, so that a card of 2 cm covers the four central pixels.
  const Image sharp = photograph(2, 0.02f);
  EXPECT_NEAR(sharp.at(19, 19).x + sharp.at(20, 19).x + sharp.at(19, 20).x + sharp.at(20, 20).x, 4, 1e-3);
  EXPECT_LT(spread(sharp), 1);
  EXPECT_NEAR(static_cast<double>(estimate_of(sharp).mean.x), 4.0 / 1600, 1e-5);
  // At 4 m, each point spreads over a disk of radius 0.1 · (4 - 2) / 4 = 5 cm in the focal plane, where the card
  // appears half as large.
  EXPECT_NEAR(spread(photograph(4, 0.02f)), 5.2, 0.7);
  // Blur conserves energy: a card of 10 cm still covers 5 · 5 pixels in total. 3000 samples hit it.
  EXPECT_NEAR(static_cast<double>(estimate_of(photograph(4, 0.1f)).mean.x), 25.0 / 1600, 0.05 * 25 / 1600);
}

}  // namespace
}  // namespace relume::support
