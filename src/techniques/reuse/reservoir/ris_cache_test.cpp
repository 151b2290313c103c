// Tests `ris` with radiance caches: the mean of each channel is unchanged under textured lamps, and at a dispersive
// interface.
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "scene/testing/light_scene.h"
#include "scene/testing/media.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

using testing::Measured;

constexpr int kSize = 20;
constexpr int kSeeds = 12;
constexpr int kFrames = 24;

/// Adds four textured lamps of different colours at a height. `up`: whether they emit upwards.
void add_lamps(Scene& scene, float height, bool up) {
  constexpr float kEdge = 0.6f;
  scene.textures.push_back(testing::noise_texture(8));
  const auto texture = static_cast<Index>(scene.textures.size()) - 1;
  const Rgb colors[4] = {Rgb(8, 2, 1), Rgb(1, 4, 1), Rgb(1, 1, 2), Rgb(1)};
  for (int i = 0; i < 4; ++i) {
    const Vec3 corner(i % 2 == 0 ? -1.0f : 1.0f - kEdge, height, i < 2 ? -1.0f : 1.0f - kEdge);
    const Vec3 u(kEdge, 0, 0);
    const Vec3 v(0, 0, kEdge);
    Material lamp = testing::matte(Rgb(0));
    lamp.emission = 5.0f * colors[i];
    lamp.emission_texture.texture = texture;
    testing::add_mesh(scene, lamp, up ? quad(corner, v, u) : quad(corner, u, v));
  }
}

/// A matte plate under textured lamps.
Scene textured_lamps() {
  Scene scene = testing::plate(testing::matte(Rgb(0.8f)), 2, 1);
  add_lamps(scene, 1, false);
  return scene;
}

/// The rough surface of a dispersive medium, which reflects lamps and refracts the light of others below.
Scene dispersive_interface() {
  Material glass = testing::matte(Rgb(1));
  glass.specular = 1;
  glass.transmission = 1;
  glass.roughness = 0.5f;
  glass.thickness = 1;
  glass.dispersion = 3;
  Scene scene = testing::plate(glass, 2, 1);
  add_lamps(scene, 1, false);
  add_lamps(scene, -1, true);
  return scene;
}

using ChannelMeans = std::array<std::vector<double>, 3>;

/// Mean of each channel after kFrames frames, by seed.
ChannelMeans means_of(Scene scene, CacheChoice cache, ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.path.max_bounces = 1;
  settings.cache = cache;
  settings.reuse = reuse;
  settings.psf.edge_rays = 0;
  Session session(std::move(scene), settings);
  ChannelMeans means;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    session.restart(seed);
    for (int i = 0; i < kFrames; ++i) session.render_frame();
    glm::dvec3 sum(0);
    const Image image = session.image();
    for (const Rgb& pixel : image.pixels) sum += glm::dvec3(pixel);
    for (int c = 0; c < 3; ++c) means[static_cast<size_t>(c)].push_back(sum[c] / (kSize * kSize));
  }
  return means;
}

/// Compares within a seed, where the directions of paths and their wavelengths are the same. The mean of the cache
/// without the choice has the same bias.
void expect_equal_means(const Scene& scene, CacheChoice cache) {
  const ChannelMeans expected = means_of(scene, cache, ReuseChoice::none);
  const ChannelMeans found = means_of(scene, cache, ReuseChoice::ris);
  for (size_t c = 0; c < 3; ++c) {
    std::vector<double> differences;
    for (size_t i = 0; i < kSeeds; ++i) differences.push_back(found[c][i] - expected[c][i]);
    const double mean = testing::measured_over(expected[c]).mean;
    const Measured difference = testing::measured_over(differences);
    EXPECT_GT(difference.error, 0) << "channel " << c << ": no choice was made";
    EXPECT_LT(difference.error, 0.02 * mean) << "channel " << c;
    EXPECT_NEAR(difference.mean, 0, 0.01 * mean + 4.5 * difference.error) << "channel " << c;
  }
}

class RisInCaches : public ::testing::TestWithParam<CacheChoice> {};

TEST_P(RisInCaches, KeepsTheMeanUnderTexturedLamps) { expect_equal_means(textured_lamps(), GetParam()); }

/// A weight of the wavelength that counted twice would make channels up to 2.6 times too bright.
TEST_P(RisInCaches, KeepsTheMeanOfDispersion) { expect_equal_means(dispersive_interface(), GetParam()); }

INSTANTIATE_TEST_SUITE_P(Caches, RisInCaches,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::sharc));

}  // namespace
}  // namespace relume
