#include "scene/mixtures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/medium.h"
#include "scene/scene_hash.h"
#include "scene/testing/media.h"
#include "scene/testing/textured_square.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::checkered;
using testing::problem_of;
using testing::Random;
using testing::TexturedSquare;

/// A square of a mixture (material 0) of materials 1 and 2.
TexturedSquare mixed_square(float share) {
  TexturedSquare square(checkered(64));
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.scene.materials.resize(3);
  Material& mixture = square.material();
  mixture.mix_first = 1;
  mixture.mix_second = 2;
  mixture.mix_share = share;
  return square;
}

/// Share of the hits of a part of the square, from (x0, -1) to (x0 + 1, 1), that get `material`.
double share_of(const TexturedSquare& square, uint32_t material, float x0) {
  constexpr int kHits = 20000;
  const CompiledScene compiled(square.scene, CompileOptions{.camera = {}, .width = 16, .height = 16});
  Random random(3);
  int chosen = 0;
  for (int i = 0; i < kHits; ++i) {
    const Ray ray{{x0 + random.next(), 2 * random.next() - 1, 1}, {0, 0, -1}, kInfinity};
    SurfacePoint sp;
    make_surface_point(compiled.view(), ray, intersect(compiled.view().accel, ray, 0), 0, sp);
    SurfacePoint again;
    make_surface_point(compiled.view(), ray, intersect(compiled.view().accel, ray, 0), 1, again);  // a wide footprint
    EXPECT_EQ(sp.material, again.material);
    chosen += sp.material == material ? 1 : 0;
  }
  return double(chosen) / kHits;
}

constexpr double kFourDeviations = 4 * 0.5 / 141;  // of a share of 20,000 hits

TEST(Mixtures, PartsHaveTheirShares) {
  for (const float share : {0.0f, 0.2f, 0.7f, 1.0f}) {
    EXPECT_NEAR(share_of(mixed_square(share), 2, -1), share, share * (1 - share) > 0 ? kFourDeviations : 0.0);
  }
}

TEST(Mixtures, TexturesMultiplyTheShare) {
  TexturedSquare square = mixed_square(0.8f);
  square.material().mix_texture.texture = 0;  // white at the top left and the bottom right
  const double left = share_of(square, 2, -1);
  EXPECT_NEAR(left, 0.4, kFourDeviations);
  EXPECT_NEAR(share_of(square, 1, 0), 0.6, kFourDeviations);
}

TEST(Mixtures, MixturesMayBeParts) {
  TexturedSquare square = mixed_square(0.5f);
  square.scene.materials.resize(5);
  Material& inner = square.scene.materials[2];
  inner.mix_first = 3;
  inner.mix_second = 4;
  inner.mix_share = 0.5f;
  EXPECT_NEAR(share_of(square, 1, -1), 0.5, kFourDeviations);
  EXPECT_NEAR(share_of(square, 3, -1), 0.25, kFourDeviations);  // independent of the first coin
  EXPECT_NEAR(share_of(square, 4, -1), 0.25, kFourDeviations);
}

TEST(Mixtures, TheMixtureEmitsAndPartsReflect) {
  TexturedSquare square = mixed_square(1);
  square.material().emission = Rgb(3);
  square.scene.materials[2].base_color = Rgb(0.25f);
  square.scene.materials[2].metallic = 0;
  square.scene.materials[2].specular = 0;
  square.scene.materials[2].emission = Rgb(7);
  const SurfacePoint sp = square.seen_at({0.3f, 0.4f}, 0);
  EXPECT_EQ(sp.emission, Rgb(3));
  EXPECT_NEAR(eval_pdf(sp, Vec3(0, 0, 1)).f.g, 0.25f * kInvPi, 1e-4f);
}

TEST(Mixtures, NormalMapsOfMixturesCountWherePartsHaveNone) {
  TexturedSquare square = mixed_square(1);
  square.scene.textures.push_back(testing::one_texel({204, 128, 230, 255}));
  square.material().normal_texture.texture = 1;
  EXPECT_GT(square.seen_at({0.3f, 0.4f}, 0).ns.x, 0.3f);
  square.scene.textures.push_back(testing::one_texel({128, 204, 230, 255}));
  square.scene.materials[2].normal_texture.texture = 2;
  EXPECT_LT(std::fabs(square.seen_at({0.3f, 0.4f}, 0).ns.x), 0.02f);
}

TEST(Mixtures, NormalMapsOfInnerMixturesCountFirst) {
  TexturedSquare square = mixed_square(1);
  square.scene.materials.resize(5);
  square.scene.materials[2].mix_first = 3;
  square.scene.materials[2].mix_second = 4;
  square.scene.materials[2].normal_texture.texture = 1;
  square.scene.textures.push_back(testing::one_texel({204, 128, 230, 255}));
  EXPECT_GT(square.seen_at({0.3f, 0.4f}, 0).ns.x, 0.3f);
}

TEST(Mixtures, PartsHaveTexturesOfTheirOwn) {
  TexturedSquare square = mixed_square(1);
  square.scene.materials[2].base_color_texture.texture = 0;  // the mixture has none
  square.scene.materials[2].metallic = 0;
  square.scene.materials[2].specular = 0;
  EXPECT_NEAR(eval_pdf(square.seen_at({-0.5f, 0.5f}, 0), Vec3(0, 0, 1)).f.g, kInvPi, 1e-4f);
  EXPECT_EQ(eval_pdf(square.seen_at({0.5f, 0.5f}, 0), Vec3(0, 0, 1)).f.g, 0);
}

TEST(Mixtures, UnlitMixturesHideTheirParts) {
  TexturedSquare square = mixed_square(1);
  square.material().unlit = true;
  square.material().base_color = {0.1f, 0.2f, 0.3f};
  const SurfacePoint sp = square.seen_at({0.3f, 0.4f}, 0);
  EXPECT_EQ(sp.emission, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(sp.material, 0u);
}

TEST(Mixtures, DispersionOfAPartCounts) {
  TexturedSquare square = mixed_square(0.5f);
  const auto disperses = [&] {
    return CompiledScene(square.scene, CompileOptions{.camera = {}, .width = 16, .height = 16}).view().disperses;
  };
  EXPECT_FALSE(disperses());
  Material& glass = square.scene.materials[2];
  glass.transmission = glass.thickness = glass.dispersion = 1;
  EXPECT_TRUE(disperses());
}

/// Entry and exit of a mixture may show other parts, so that no medium around the camera is known.
TEST(Mixtures, CamerasAreOutsideOfThem) {
  Scene scene;
  testing::add_slab(scene, testing::tint(Rgb(2)), 1, -1);
  Material& mixture = scene.materials.emplace_back();
  mixture.mix_first = mixture.mix_second = 0;
  const auto around = [](const Scene& s) {
    const CompiledScene compiled(s, CompileOptions{.camera = {}, .width = 16, .height = 16});
    return absorption_around(compiled.view(), {Vec3(0.1f, 0, 0.2f), Vec3(0, 1, 0), kInfinity});
  };
  EXPECT_NEAR(around(scene).r, 2, 1e-4f);
  scene.meshes[0].material = 1;
  EXPECT_EQ(around(scene), Rgb(0));
}

TEST(Mixtures, PartsChangeTheHashOfTheScene) {
  TexturedSquare square = mixed_square(0.5f);
  const uint64_t before = scene_hash(square.scene);
  std::swap(square.material().mix_first, square.material().mix_second);
  EXPECT_NE(scene_hash(square.scene), before);
}

TEST(Mixtures, RejectsMissingPartsAndCircles) {
  TexturedSquare square = mixed_square(0.5f);
  const auto problem = [&] { return problem_of([&] { validate(square.scene, "a"); }); };
  EXPECT_EQ(problem(), "");
  square.material().mix_second = 3;
  EXPECT_EQ(problem(), "a: material 0 mixes the missing material 3; use existing ones");
  square.material().mix_second = kNone;
  EXPECT_NE(problem().find("mixes the missing material -1"), std::string::npos);
  square.material().mix_second = 0;
  EXPECT_NE(problem().find("is part of itself"), std::string::npos);
  square.material().mix_second = 2;
  square.material().mix_share = kInfinity;
  EXPECT_NE(problem().find("share of the second material"), std::string::npos);
}

TEST(Mixtures, LimitsTheirDepth) {
  const auto chain = [](int length) {
    const auto parts_of = [length](size_t i) {
      const auto next = static_cast<Index>(i) + 1;
      return static_cast<int>(i) < length ? std::pair(next, next) : std::pair(kNone, kNone);
    };
    return problem_of([&] { check_mixtures(static_cast<size_t>(length) + 1, parts_of, "a"); });
  };
  EXPECT_EQ(chain(kMaxMixDepth), "");
  EXPECT_NE(chain(kMaxMixDepth + 1).find("more than 16 mixtures are nested"), std::string::npos);
  EXPECT_NE(chain(100000).find("more than 16 mixtures are nested"), std::string::npos);
}

TEST(Mixtures, EditsKeepThemValid) {
  const TexturedSquare square = mixed_square(0.5f);
  CompiledScene compiled(square.scene, CompileOptions{.camera = {}, .width = 16, .height = 16});
  Material circle;
  circle.mix_first = circle.mix_second = 0;
  EXPECT_NE(problem_of([&] { compiled.set_material(1, circle); }).find("part of itself"), std::string::npos);
  circle.mix_second = 9;
  EXPECT_NE(problem_of([&] { compiled.add_material(circle); }).find("missing material 9"), std::string::npos);
  circle.mix_second = 1;
  EXPECT_EQ(compiled.add_material(circle), 3);
}

}  // namespace
}  // namespace relume
