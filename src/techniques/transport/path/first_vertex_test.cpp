#include "techniques/transport/path/first_vertex.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 53;  // not a multiple of tiles or batches
constexpr uint32_t kHeight = 47;
constexpr uint32_t kPixels = kWidth * kHeight;

/// First vertices of one sample per allocated pixel of the Cornell box, pixel by pixel or in tiles.
std::vector<FirstVertex> trace(const std::vector<uint32_t>& allocation, bool tiles) {
  const CompiledScene scene(find_builtin_scene("cornell")->build(),
                            CompileOptions{.camera = {}, .width = kWidth, .height = kHeight});
  FirstVertex of_before;
  of_before.light_scale = 7;
  std::vector<FirstVertex> vertices(kPixels, of_before);
  std::vector<Rgb> radiance(kPixels);
  testing::trace_pixels(
      scene,
      {.width = kWidth, .height = kHeight, .tile_size = tiles ? kTileSize : 0, .allocation = view_of(allocation)},
      RadianceOutput{mutable_view_of(radiance)}, FirstVertexOutput{mutable_view_of(vertices)});
  return vertices;
}

TEST(FirstVertex, TilesLeaveWhatElementsLeave) {
  const std::vector<uint32_t> allocation(kPixels, 1);
  const std::vector<FirstVertex> elements = trace(allocation, false);
  const std::vector<FirstVertex> tiles = trace(allocation, true);
  uint32_t different = 0;
  uint32_t lit = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const FirstVertex& a = elements[i];
    const FirstVertex& b = tiles[i];
    ASSERT_EQ(a.scatter, b.scatter) << i;
    ASSERT_EQ(a.to_light, b.to_light) << i;
    ASSERT_EQ(a.light, b.light) << i;
    ASSERT_EQ(a.light_u, b.light_u) << i;
    ASSERT_EQ(a.light_scale, b.light_scale) << i;
    lit += is_black(a.direct) ? 0u : 1u;
    different += a.direct == b.direct && a.indirect == b.indirect && a.light_value == b.light_value ? 0u : 1u;
  }
  EXPECT_GT(lit, kPixels / 4);
  // Packets of shadow rays round differently, with visible effects where rays graze an edge.
  EXPECT_LE(different, kPixels / 500);
}

TEST(FirstVertex, PixelsWithoutAPathLeaveNone) {
  std::vector<uint32_t> allocation(kPixels, 1);
  for (uint32_t i = 0; i < kPixels; i += 3) allocation[i] = 0;
  for (const bool in_tiles : {false, true}) {
    const std::vector<FirstVertex> vertices = trace(allocation, in_tiles);
    for (uint32_t i = 0; i < kPixels; i += 3) {
      EXPECT_EQ(vertices[i].light, kNoLight);
      EXPECT_EQ(vertices[i].light_scale, 0.0f);
      EXPECT_EQ(vertices[i].scatter, Vec3(0));
    }
  }
}

}  // namespace
}  // namespace relume
