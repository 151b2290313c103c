// Dispersive media with images known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builtin_scenes/shapes.h"
#include "scene/testing/media.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume::testing {
namespace {

constexpr float kIor = 1.5f;
constexpr float kThickness = 1;
constexpr float kGap = 0.2f;  // distance between slab and plate, metres
constexpr float kAngle = kPi / 3;

Material dispersive_glass(float dispersion) {
  Material m = matte(Rgb(1));
  m.specular = 1;
  m.transmission = 1;
  m.roughness = 0;
  m.ior = kIor;
  m.thickness = 1;
  m.dispersion = dispersion;
  return m;
}

std::vector<Rgb> render(const Scene& source, uint32_t size, uint32_t samples, uint32_t max_bounces) {
  const CompiledScene scene(source, {.camera = {}, .width = static_cast<int>(size), .height = static_cast<int>(size)});
  std::vector<Rgb> sum(size_t{size} * size, Rgb(0));
  std::vector<Rgb> radiance(sum.size());
  for (uint32_t i = 0; i < samples; ++i) {
    trace_pixels(scene, {.width = size, .height = size, .max_bounces = max_bounces, .sample = i},
                 RadianceOutput{mutable_view_of(radiance)});
    for (size_t p = 0; p < sum.size(); ++p) sum[p] += radiance[p] / static_cast<float>(samples);
  }
  return sum;
}

Rgb mean_of(const std::vector<Rgb>& image) {
  glm::dvec3 sum(0);
  for (const Rgb& p : image) sum += glm::dvec3(p);
  return Rgb(sum / static_cast<double>(image.size()));
}

void look(Scene& scene, float angle, const Vec3& from) {
  scene.nodes[1].transform.translation = from;
  scene.nodes[1].transform.rotation = glm::angleAxis(angle, Vec3(0, 0, 1)) * glm::angleAxis(-kPi / 2, Vec3(1, 0, 0));
}

/// A slab above a plate of radiance 0.5 + 5 x. Every ray enters the slab at x = −1 m, 60° off its normal.
Scene slab_above_scale() {
  Material scale = matte(Rgb(1));
  scale.unlit = true;
  Scene scene = plate(scale, 0.1f, 1e-3f);
  scene.meshes[0].colors = {Vec4(0, 0, 0, 1), Vec4(0, 0, 0, 1), Vec4(1), Vec4(1)};
  look(scene, kAngle, {-1 - std::tan(kAngle), kGap + kThickness + 1, 0});
  Material glass = dispersive_glass(2);
  glass.specular = 0;  // no reflection between the faces
  add_slab(scene, glass, kGap + kThickness, kGap);
  return scene;
}

/// Position where a ray through the slab meets the plate by Snell's law, metres.
double landing(double index) {
  const double sine = std::sin(double{kAngle}) / index;
  return -1 + double{kThickness} * sine / std::sqrt(1 - sine * sine) + double{kGap} * std::tan(double{kAngle});
}

double index_of(float wavelength_nm) {
  return kIor + (kIor - 1.0) / 10.0 * (523655.0 / (double{wavelength_nm} * wavelength_nm) - 1.5168);
}

/// ∫ s_c(λ) f(λ) dλ per channel.
template <typename F>
glm::dvec3 seen_by_channels(const F& f) {
  constexpr int kSteps = 4000;
  constexpr double kStepNm = double{kLongestWavelength - kShortestWavelength} / kSteps;
  glm::dvec3 sum(0);
  for (int i = 0; i < kSteps; ++i) {
    const auto nm = static_cast<float>(kShortestWavelength + (i + 0.5) * kStepNm);
    sum += glm::dvec3(channel_response(nm)) * (f(nm) * kStepNm);
  }
  return sum;
}

TEST(Dispersion, ChannelsArriveWhereSnellsLawSays) {
  const Rgb mean = mean_of(render(slab_above_scale(), 4, 1024, 4));
  const glm::dvec3 expected = seen_by_channels([](float nm) { return landing(index_of(nm)); });
  const glm::dvec3 wavelength = seen_by_channels([](float nm) { return double{nm}; });
  EXPECT_GT(expected.r - expected.b, 0.03);
  for (int c = 0; c < 3; ++c) {
    const double x = (double{mean[c]} - 0.5) / 5;
    EXPECT_NEAR(x, expected[c], 5e-4) << "channel " << c;
    EXPECT_NEAR(x, landing(index_of(static_cast<float>(wavelength[c]))), 2e-3) << "channel " << c;
  }
}

TEST(Dispersion, WithoutDispersionAllChannelsArriveTogether) {
  Scene scene = slab_above_scale();
  scene.materials.back().dispersion = 0;
  const Rgb mean = mean_of(render(scene, 4, 16, 4));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR((double{mean[c]} - 0.5) / 5, landing(kIor), 1e-4);
}

TEST(Dispersion, FurnaceIsWhiteInAllChannels) {
  Scene scene = plate(matte(Rgb(1)), 3, 1);
  scene.meshes[0].triangles = {};
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1);
  look(scene, 0.7f, {-1.2f, 1.5f, 0.1f});
  add_mesh(scene, dispersive_glass(1), box({-1, -0.5f, -1}, {1, 0.5f, 1}));
  for (const float diffuse : {0.0f, 1.0f}) {  // with diffuse transmission, too
    scene.materials.back().diffuse_transmission = diffuse;
    scene.materials.back().transmission = 1 - 0.5f * diffuse;
    const Rgb mean = mean_of(render(scene, 32, 256, 256));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 1.0f, 1.5e-3f) << "channel " << c << ", diffuse " << diffuse;
  }
}

/// Seen from inside a medium. Short wavelengths are reflected totally, to a plate of radiance 1. Long ones reach the
/// sky, whose radiance grows by n² on entry.
TEST(Dispersion, TotalReflectionChoosesColors) {
  constexpr float kInside = 0.73f;
  Material glow = matte(Rgb(1));
  glow.unlit = true;
  Scene scene = plate(glow, 3, 1e-3f);
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1);
  look(scene, kPi - kInside, {0, 0.25f, 0});
  Material glass = dispersive_glass(2);
  glass.specular = 0;
  add_slab(scene, glass, 0.5f, -0.5f);
  const Rgb mean = mean_of(render(scene, 4, 1024, 4));
  const glm::dvec3 expected = seen_by_channels([](float nm) {
    const double index = index_of(nm);
    return index * std::sin(double{kInside}) < 1 ? index * index : 1.0;
  });
  EXPECT_GT(expected.r - expected.b, 0.5);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 0.01) << "channel " << c;
}

/// Thin walls do not refract: dispersion changes no bit of their images, and no wavelengths are drawn.
TEST(Dispersion, ThinWallsDoNotDisperse) {
  Scene scene = slab_above_scale();
  scene.materials.back().thickness = 0;
  const std::vector<Rgb> with = render(scene, 8, 4, 4);
  scene.materials.back().dispersion = 0;
  EXPECT_EQ(render(scene, 8, 4, 4), with);
}

}  // namespace
}  // namespace relume::testing
