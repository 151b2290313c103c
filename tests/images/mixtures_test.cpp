// Mixtures of materials: direct light is the mean of the parts' light, and all estimators agree.
#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "support/image_test.h"

namespace relume::support {
namespace {

constexpr int kSize = 24;
constexpr int kSeeds = 16;
constexpr float kShare = 0.3f;

Material blue() {
  Material m;
  m.base_color = {0.1f, 0.2f, 0.8f};
  m.metallic = 0;
  return m;
}

Material gold() {
  Material m;
  m.base_color = {1, 0.7f, 0.3f};
  m.roughness = 0.5f;
  return m;
}

/// The Cornell box whose inner boxes are of `material`.
Scene box_of(const Material& material) {
  Scene scene = find_builtin_scene("cornell")->build();
  scene.materials.insert(scene.materials.end(), {blue(), gold(), material});
  for (Mesh& mesh : scene.meshes) {
    if (mesh.name != "tall box" && mesh.name != "short box") continue;
    mesh.material = static_cast<Index>(scene.materials.size()) - 1;
    mesh.uv0.clear();
    for (const Vec3& p : mesh.positions) mesh.uv0.emplace_back(p.x + p.z, p.y);
  }
  return scene;
}

/// The box of a mixture of blue and gold.
Scene mixed_box(float share) {
  const auto first = static_cast<Index>(find_builtin_scene("cornell")->build().materials.size());
  Material mixture;
  mixture.mix_first = first;
  mixture.mix_second = first + 1;
  mixture.mix_share = share;
  return box_of(mixture);
}

RenderSettings direct_light() {
  RenderSettings settings = small_settings(kSize, kSize);
  settings.path.max_bounces = 1;
  return settings;
}

/// Means of images of both parts, weighted by their shares.
Moments weighted_parts() {
  const Moments a = measure(box_of(blue()), direct_light(), 32, kSeeds, 1);
  const Moments b = measure(box_of(gold()), direct_light(), 32, kSeeds, 101);
  std::vector<Image> images = a.images;
  for (size_t i = 0; i < images.size(); ++i) {
    for (size_t p = 0; p < images[i].pixels.size(); ++p)
      images[i].pixels[p] = (1 - kShare) * images[i].pixels[p] + kShare * b.images[i].pixels[p];
  }
  return moments_of(images);
}

TEST(Mixtures, DirectLightIsTheMeanOfTheParts) {
  const Moments parts = weighted_parts();
  expect_same_image("mixture", measure(mixed_box(kShare), direct_light(), 64, kSeeds, 201), parts,
                    {.block_size = kSize / 2, .detectable = 0.1, .detectable_mean = 0.03});
}

/// The box of a mixture of gold and tinted glass, in stripes.
Scene striped_box() {
  Scene scene = mixed_box(0.8f);
  Material& glass = scene.materials[scene.materials.size() - 3];
  glass.base_color = Rgb(1);
  glass.roughness = 0.3f;
  glass.transmission = glass.thickness = glass.attenuation_distance = 1;
  glass.attenuation_color = {0.3f, 0.5f, 0.7f};
  Texture& stripes = scene.textures.emplace_back();
  stripes.width = 4;
  stripes.height = 1;
  stripes.format = PixelFormat::rgba8_linear;
  for (const int code : {0, 255, 100, 255}) stripes.texels.insert(stripes.texels.end(), 4, std::byte(code));
  scene.materials.back().mix_texture.texture = static_cast<Index>(scene.textures.size()) - 1;
  return scene;
}

TEST(Mixtures, EstimatorsAgree) {
  const RenderSettings path = small_settings(kSize, kSize);
  RenderSettings bdpt = path;
  bdpt.estimator = EstimatorChoice::bdpt;
  expect_same_image("mixture-bdpt", measure(striped_box(), path, 96, kSeeds, 1),
                    measure(striped_box(), bdpt, 48, kSeeds, 101),
                    {.block_size = kSize / 2, .detectable = 0.1, .detectable_mean = 0.05});
}

}  // namespace
}  // namespace relume::support
