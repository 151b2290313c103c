// Material layers at surface points: their textures and directions.
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "scene/testing/textured_square.h"

namespace relume {
namespace {

using testing::checkered;
using testing::one_texel;
using testing::TexturedSquare;

TEST(SurfaceLayers, CoatsDimEmissionAsTheirTexturesSay) {
  TexturedSquare square(checkered(64));
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.material().emission = Rgb(2);
  square.material().clearcoat = 1;
  square.material().clearcoat_texture.texture = 0;
  const CompiledScene compiled(square.scene, CompileOptions{.camera = {}, .width = 16, .height = 16});
  const LightsView& lights = compiled.view().lights;
  for (const auto& [x, below_coat] : {std::pair{-0.5f, 0.96f}, std::pair{0.5f, 1.0f}}) {
    const SurfacePoint sp = square.seen_at({x, 0.5f}, 0);
    EXPECT_NEAR(sp.emission.x, 2 * below_coat, 1e-5f);
    const TriangleLight& light = lights.lights[sp.light].triangle;
    EXPECT_NEAR(emitted_radiance(light, lights.textured, sp.barycentric, 1).x, 2 * below_coat, 1e-5f);
  }
}

/// World-space direction of anisotropy at a point of the square.
Vec3 highlight_direction(const TexturedSquare& square) {
  const SurfacePoint sp = square.seen_at({0.3f, 0.4f}, 0);
  const Vec2 tangent = sp.bsdf.detail.anisotropy.tangent;
  const Vec3 along = sp.frame.to_world({tangent.x, tangent.y, 0});
  return along * (along.x + along.y < 0 ? -1.0f : 1.0f);  // the sign is irrelevant
}

TEST(SurfaceLayers, AnisotropyTurnsCounterclockwise) {
  TexturedSquare square(checkered(2));
  square.mesh().uv0 = TexturedSquare::uv(1);  // u grows along +X, v along −Y: the bitangent is +Y
  square.material().anisotropy = 0.5f;
  square.material().metallic = 1;
  for (const float angle : {0.0f, 0.3f, kPi / 2}) {
    square.material().anisotropy_rotation_rad = angle;
    EXPECT_LT(glm::distance(highlight_direction(square), Vec3(std::cos(angle), std::sin(angle), 0)), 1e-4f) << angle;
  }
}

/// Directions in red and green turn with the tangents of the mesh; blue scales the strength.
TEST(SurfaceLayers, AnisotropyHasATexture) {
  TexturedSquare square(one_texel({128, 255, 51, 255}));  // along the bitangent
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.material().anisotropy = 0.5f;
  square.material().anisotropy_texture.texture = 0;
  EXPECT_LT(glm::distance(highlight_direction(square), Vec3(0, 1, 0)), 0.01f);
  EXPECT_NEAR(square.seen_at({0.3f, 0.4f}, 0).bsdf.detail.anisotropy.strength, 0.1f, 1e-4f);
}

TEST(SurfaceLayers, AnisotropyFollowsTheNormalTexture) {
  TexturedSquare square(one_texel({128, 128, 255, 255}));  // flat
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.mesh().uv1 = {Vec2(1, 1), Vec2(1, 0), Vec2(0, 0), Vec2(0, 1)};  // u grows along −Y
  square.material().anisotropy = 0.5f;
  EXPECT_LT(glm::distance(highlight_direction(square), Vec3(1, 0, 0)), 1e-4f);
  square.material().normal_texture = {.texture = 0, .uv_set = 1};
  EXPECT_LT(glm::distance(highlight_direction(square), Vec3(0, 1, 0)), 0.02f);
}

/// The scale affects the tilt of the coat, not its base.
TEST(SurfaceLayers, CoatsHaveNormalTextures) {
  TexturedSquare square(one_texel({204, 128, 230, 255}));
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.material().clearcoat = 1;
  square.material().clearcoat_normal_texture.texture = 0;
  for (const float scale : {1.0f, 0.5f}) {
    square.material().clearcoat_normal_scale = scale;
    const SurfacePoint sp = square.seen_at({0.3f, 0.4f}, 0);
    ASSERT_TRUE(sp.bsdf.coat_has_normal);
    EXPECT_LT(glm::distance(sp.frame.n, Vec3(0, 0, 1)), 1e-5f);
    const auto coordinate = [](int code) { return 2 * static_cast<float>(code) / 255 - 1; };
    const Vec3 expected = glm::normalize(Vec3(scale * coordinate(204), scale * coordinate(128), coordinate(230)));
    EXPECT_LT(glm::distance(sp.frame.to_world(sp.bsdf.detail.coat_normal), expected), 1e-3f) << scale;
  }
}

/// Green interpolates from minimum to maximum thickness.
TEST(SurfaceLayers, FilmsHaveThicknessTextures) {
  TexturedSquare square(one_texel({255, 51, 255, 255}));
  square.mesh().uv0 = TexturedSquare::uv(1);
  square.material().iridescence = 1;
  square.material().iridescence_thickness_min_nm = 200;
  square.material().iridescence_thickness_nm = 700;
  EXPECT_FLOAT_EQ(square.seen_at({0.3f, 0.4f}, 0).bsdf.detail.film.thickness_nm, 700);
  square.material().iridescence_thickness_texture.texture = 0;
  EXPECT_NEAR(square.seen_at({0.3f, 0.4f}, 0).bsdf.detail.film.thickness_nm, 300, 0.1f);
}

}  // namespace
}  // namespace relume
