#include "scene/emission_table.h"

#include <gtest/gtest.h>

#include "core/hash.h"
#include "scene/testing/light_scene.h"

namespace relume {
namespace {

constexpr int kEdge = 16;  // quads per side of the plate

/// Almost black noise, as from lossy compression, with a bright square in one corner.
Texture dim_texture(int size, int bright) {
  Texture t{"dim", size, size, PixelFormat::rgba8_srgb, WrapMode::repeat, WrapMode::repeat, FilterMode::linear, {}, {}};
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const uint32_t noise = 1 + hash(static_cast<uint32_t>(x), static_cast<uint32_t>(y)) % 2;
      const auto code = static_cast<std::byte>(x < bright && y < bright ? 255 : noise);
      for (int c = 0; c < 4; ++c) t.texels.push_back(code);
    }
  }
  return t;
}

/// A plate whose triangles cover equal parts of the texture.
Scene glowing_plate(Texture texture) {
  Scene scene;
  Material glow;
  glow.emission = Rgb(2);
  glow.emission_texture.texture = 0;
  scene.materials.push_back(glow);
  scene.textures.push_back(std::move(texture));
  Mesh plate;
  plate.material = 0;
  for (int y = 0; y <= kEdge; ++y) {
    for (int x = 0; x <= kEdge; ++x) {
      plate.uv0.push_back(Vec2(static_cast<float>(x), static_cast<float>(y)) / static_cast<float>(kEdge));
      plate.positions.emplace_back(plate.uv0.back(), 0.0f);
    }
  }
  for (uint32_t y = 0; y < kEdge; ++y) {
    for (uint32_t x = 0; x < kEdge; ++x) {
      const uint32_t a = y * (kEdge + 1) + x;
      const uint32_t b = a + kEdge + 1;
      plate.triangles.insert(plate.triangles.end(), {UVec3(a, a + 1, b), UVec3(a + 1, b + 1, b)});
    }
  }
  scene.meshes.push_back(std::move(plate));
  Node node;
  node.meshes = {0};
  scene.add_node(std::move(node));
  return scene;
}

TEST(EmissionTable, TexelsHaveSeparateEntriesIfFew) {
  const CompiledScene scene(glowing_plate(dim_texture(128, 16)), {.width = 8, .height = 8});
  const TexturedEmission& e = scene.view().lights.textured;
  ASSERT_EQ(e.triangles.size, 2u * kEdge * kEdge);
  for (const TexturedTriangle& t : e.triangles) EXPECT_EQ(t.grid, 8u);  // twice the 8 · 8 / 2 texels, rounded up
}

TEST(EmissionTable, LargeTexturesShareEntriesByPower) {
  constexpr int kSize = 1024;
  constexpr int kBright = kSize / kEdge;  // one quad
  const CompiledScene scene(glowing_plate(dim_texture(kSize, kBright)), {.width = 8, .height = 8});
  const TexturedEmission& e = scene.view().lights.textured;
  ASSERT_EQ(e.triangles.size, 2u * kEdge * kEdge) << "noise is no black";
  EXPECT_LE(e.entries.size, kMostEmissionEntries + e.triangles.size);
  double mean = 0;
  for (const TexturedTriangle& t : e.triangles) {
    const bool bright = t.emission_uv[0].x < 0.5f / kEdge && t.emission_uv[0].y < 0.5f / kEdge;
    if (bright) {
      EXPECT_GT(t.grid, 60u);
      EXPECT_NEAR(luminance(t.mean_emission), 1, 0.1);
    }
    mean += static_cast<double>(luminance(t.mean_emission)) / e.triangles.size;
  }
  const double expected = 1.0 / (kEdge * kEdge);  // dim texels add a ninth of it
  EXPECT_NEAR(mean / expected, 1, 0.2);
}

/// The same with columns of half a quad removed by a mask.
Scene masked_plate(int size, int bright) {
  Texture texture = dim_texture(size, bright);
  const int column = size / kEdge / 2;
  for (int i = 0; i < size * size; ++i)
    texture.texels[static_cast<size_t>(4 * i + 3)] = static_cast<std::byte>(i % size / column % 2 == 0 ? 255 : 0);
  Scene scene = glowing_plate(std::move(texture));
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].base_color_texture.texture = 0;
  return scene;
}

TEST(EmissionTable, MaskedMaterialsShareEntriesToo) {
  const CompiledScene scene(masked_plate(1024, 64), {.width = 8, .height = 8});
  const TexturedEmission& e = scene.view().lights.textured;
  ASSERT_EQ(e.triangles.size, 2u * kEdge * kEdge);
  EXPECT_LE(e.entries.size, kMostEmissionEntries + e.triangles.size);
  for (const TexturedTriangle& t : e.triangles) {
    const bool bright = t.emission_uv[0].x < 0.5f / kEdge && t.emission_uv[0].y < 0.5f / kEdge;
    if (!bright) continue;
    EXPECT_NEAR(luminance(t.mean_emission), 0.75, 0.1) << "the mask leaves its wider half";
  }
}

TEST(EmissionTable, EveryEntryHasAPositiveProbability) {
  for (const bool is_masked : {false, true}) {
    const CompiledScene scene(is_masked ? masked_plate(1024, 64) : glowing_plate(dim_texture(1024, 64)),
                              {.width = 8, .height = 8});
    const TexturedEmission& e = scene.view().lights.textured;
    for (const TexturedTriangle& t : e.triangles) {
      if (is_masked && t.grid >= 64) continue;  // each texel has separate entries, and none where it is removed
      const AliasTable table = e.table(t);
      for (uint32_t i = 0; i < table.entries.size; ++i) ASSERT_GT(table.pmf(i), 0.0f);
    }
  }
}

}  // namespace
}  // namespace relume
