#include "techniques/transport/path/indirect_sample.h"

#include <gtest/gtest.h>

#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 32;
constexpr uint32_t kPixels = kSize * kSize;

/// Follows the radiance of the whole path through changes of units.
struct WholePathPolicy : NoPolicy {
  Rgb before{0};
  Rgb unit{1};
  Rgb total{0};

  void rebased(const Rgb& found, const Rgb& next_unit) {
    before += unit * found;
    unit = next_unit;
  }
  void finished(const PathState& path) { total = before + unit * path.radiance; }
};

struct WholePathOutput {
  using Policy = WholePathPolicy;

  View<Rgb> total;

  WholePathPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t) const { return {}; }
  void finish(uint32_t pixel, const WholePathPolicy& policy, const PathState&) const { total[pixel] = policy.total; }
  void leave_out(uint32_t) const {}
};

class IndirectSamples : public ::testing::TestWithParam<uint32_t> {
 protected:
  template <typename... Outputs>
  void trace(const Outputs&... outputs) const {
    // Roulette depends on the throughput, which differs.
    testing::trace_pixels(
        scene_, {.width = kSize, .height = kSize, .tile_size = GetParam(), .max_bounces = 4, .russian_roulette = false},
        outputs...);
  }

  const CompiledScene scene_{find_builtin_scene("cornell-spheres")->build(),
                             CompileOptions{.camera = {}, .width = kSize, .height = kSize}};
};

TEST_P(IndirectSamples, ReportTheirUnitsToEarlierPolicies) {
  std::vector<Rgb> plain(kPixels);
  std::vector<Rgb> rest(kPixels);
  std::vector<Rgb> whole(kPixels);
  std::vector<IndirectSample> samples(kPixels);
  trace(RadianceOutput{mutable_view_of(plain)});
  trace(RadianceOutput{mutable_view_of(rest)}, WholePathOutput{mutable_view_of(whole)},
        IndirectSampleOutput{mutable_view_of(samples)});
  int removed = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_NEAR(whole[i][c], plain[i][c], 1e-3f * (1.0f + plain[i][c])) << "pixel " << i;
      ASSERT_LE(rest[i][c], plain[i][c] * 1.001f) << "pixel " << i;
    }
    removed += luminance(rest[i]) < 0.99f * luminance(plain[i]) ? 1 : 0;
  }
  EXPECT_GT(removed, 300);
}

TEST_P(IndirectSamples, ExistBeyondNonDeltaLobesOnly) {
  std::vector<Rgb> radiance(kPixels);
  std::vector<IndirectSample> samples(kPixels);
  std::vector<FirstVertex> vertices(kPixels);
  trace(RadianceOutput{mutable_view_of(radiance)}, FirstVertexOutput{mutable_view_of(vertices)},
        IndirectSampleOutput{mutable_view_of(samples)});
  int found = 0;
  int without = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const IndirectVertex& vertex = samples[i].vertex;
    if (!(samples[i].weight > 0.0f)) {
      ++without;
      continue;
    }
    ++found;
    ASSERT_GT(length_squared(vertices[i].scatter), 0.0f) << "a delta lobe";
    ASSERT_LT(vertex.instance, scene_.view().instances.size);
    EXPECT_EQ(vertex.pixel, i);
    EXPECT_EQ(vertex.element, 3u);
    EXPECT_TRUE(vertex.alpha >= 0.0f && vertex.alpha <= 1.0f);
    if (vertex.has(IndirectVertex::kLambert)) {
      EXPECT_EQ(vertex.alpha, 1.0f);
    }
  }
  EXPECT_GT(found, 500);
  EXPECT_GT(without, 50) << "mirror, glass and the open front";
}

INSTANTIATE_TEST_SUITE_P(Forms, IndirectSamples, ::testing::Values(0u, kTileSize));

}  // namespace
}  // namespace relume
