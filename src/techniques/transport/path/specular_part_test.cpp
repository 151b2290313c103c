#include "techniques/transport/path/specular_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 53;  // not a multiple of tiles or batches
constexpr uint32_t kHeight = 47;
constexpr uint32_t kPixels = kWidth * kHeight;

struct Parts {
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
  std::vector<Rgb> specular = std::vector<Rgb>(kPixels, Rgb(7));
};

/// Traces one sample per pixel of a compiled scene.
struct Tracer {
  const CompiledScene& scene;
  uint32_t max_bounces = 3;

  template <typename... Outputs>
  void trace(uint32_t sample, bool tiles, const Outputs&... outputs) const {
    testing::trace_pixels(scene,
                          {.width = kWidth,
                           .height = kHeight,
                           .tile_size = tiles ? kTileSize : 0,
                           .max_bounces = max_bounces,
                           .sample = sample},
                          outputs...);
  }

  Parts parts(uint32_t sample, bool tiles) const {
    Parts p;
    trace(sample, tiles, RadianceOutput{mutable_view_of(p.radiance)}, SpecularOutput{mutable_view_of(p.specular)});
    return p;
  }
};

CompiledScene compiled(const Scene& scene) {
  return CompiledScene(scene, CompileOptions{.camera = {}, .width = kWidth, .height = kHeight});
}

/// Means over all pixels of `samples` samples.
struct Means {
  glm::dvec3 radiance{0};
  glm::dvec3 specular{0};
};
Means means_of(const Scene& scene, uint32_t max_bounces, uint32_t samples = 1) {
  const CompiledScene compiled_scene = compiled(scene);
  Means means;
  for (uint32_t sample = 0; sample < samples; ++sample) {
    const Parts p = Tracer{compiled_scene, max_bounces}.parts(sample, true);
    for (uint32_t i = 0; i < kPixels; ++i) {
      means.radiance += glm::dvec3(p.radiance[i]) / double(kPixels * samples);
      means.specular += glm::dvec3(p.specular[i]) / double(kPixels * samples);
    }
  }
  return means;
}

/// A plate under a lamp and a sky.
Scene lit_plate(const Material& material) {
  Scene scene = testing::plate(material, 5, 2);
  testing::add_square_lamp(scene, Rgb(9, 6, 3));
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(0.1f, 0.2f, 0.3f);
  return scene;
}

Material plastic(const Rgb& base, float roughness) {
  Material material = testing::matte(base);
  material.specular = 1;
  material.roughness = roughness;
  return material;
}

TEST(SpecularPart, TilesMatchElements) {
  const CompiledScene scene = compiled(find_builtin_scene("cornell")->build());
  const Parts elements = Tracer{scene}.parts(3, false);
  const Parts tiles = Tracer{scene}.parts(3, true);
  uint32_t different = 0;
  uint32_t specular = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    different += elements.radiance[i] == tiles.radiance[i] && elements.specular[i] == tiles.specular[i] ? 0u : 1u;
    specular += is_black(elements.specular[i]) ? 0u : 1u;
  }
  EXPECT_GT(specular, kPixels / 16);
  EXPECT_EQ(different, 0u);
}

TEST(SpecularPart, KeepsTheRadiance) {
  const CompiledScene scene = compiled(find_builtin_scene("cornell")->build());
  const Parts p = Tracer{scene}.parts(3, true);
  std::vector<Rgb> alone(kPixels);
  Tracer{scene}.trace(3, true, RadianceOutput{mutable_view_of(alone)});
  EXPECT_EQ(p.radiance, alone);
  for (uint32_t i = 0; i < kPixels; ++i) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_GE(p.specular[i][c], 0.0f) << i;
      ASSERT_LE(p.specular[i][c], p.radiance[i][c] * (1 + 1e-5f) + 1e-6f) << i;
    }
  }
}

TEST(SpecularPart, MirrorsAreSpecularAndLambertSurfacesAreNot) {
  Material mirror = testing::matte(Rgb(0.9f));
  mirror.metallic = 1;
  mirror.roughness = 0;
  const Means of_mirror = means_of(lit_plate(mirror), 2);
  EXPECT_GT(of_mirror.radiance.r, 0.01);
  EXPECT_NEAR(of_mirror.specular.r / of_mirror.radiance.r, 1, 1e-6);
  const Means of_lambert = means_of(lit_plate(testing::matte(Rgb(0.5f))), 2);
  EXPECT_GT(of_lambert.radiance.r, 0.01);
  EXPECT_EQ(of_lambert.specular, glm::dvec3(0));
}

/// With a black base, only the interface scatters.
TEST(SpecularPart, AgreesWithTheInterfaceAlone) {
  for (const float roughness : {0.0f, 0.2f, 0.6f}) {
    constexpr uint32_t kSamples = 128;
    const Means both = means_of(lit_plate(plastic(Rgb(0.4f, 0.5f, 0.6f), roughness)), 1, kSamples);
    const Means interface = means_of(lit_plate(plastic(Rgb(0), roughness)), 1, kSamples);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(both.specular[c] / interface.radiance[c], 1, 0.02) << roughness;
      EXPECT_LT(both.specular[c], 0.5 * both.radiance[c]) << roughness;
    }
  }
}

/// Reflection by the coat is specular. The lobes below split the transmitted light.
TEST(SpecularPart, CoatsAreSpecular) {
  Material coated = testing::matte(Rgb(0.5f));
  coated.clearcoat = 1;
  coated.clearcoat_roughness = 0.3f;
  Material coat = coated;
  coat.base_color = Rgb(0);
  constexpr uint32_t kSamples = 128;
  const Means both = means_of(lit_plate(coated), 1, kSamples);
  const Means alone = means_of(lit_plate(coat), 1, kSamples);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(both.specular[c] / alone.radiance[c], 1, 0.02);
}

TEST(SpecularPart, PixelsWithoutAPathHaveNone) {
  Parts p;
  SpecularOutput{mutable_view_of(p.specular)}.leave_out(5);
  EXPECT_EQ(p.specular[5], Rgb(0));
}

}  // namespace
}  // namespace relume
