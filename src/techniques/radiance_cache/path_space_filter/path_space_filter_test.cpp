#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>

#include "builtin_scenes/builtin.h"
#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

CachedFrameSettings small(int size) {
  CachedFrameSettings s;
  s.width = s.height = size;
  return s;
}

glm::dvec3 mean_of(const std::vector<Rgb>& pixels) {
  glm::dvec3 sum(0);
  for (const Rgb& p : pixels) sum += glm::dvec3(p);
  return sum / static_cast<double>(pixels.size());
}

/// Mean squared error of reflected radiance. Pixels that see any of the lamp are excluded.
double mse(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += max_component(b[i]) < 1.0f ? length_squared(a[i] - b[i]) : 0.0f;
  return sum / static_cast<double>(a.size());
}

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

TEST(PathSpaceFilter, CellsHoldTheSamplesOfTheirPixels) {
  CachedFrames frames(build("cornell"), small(48));
  frames.trace();
  const HashGridView grid = frames.grid().view(frames.scene().view().camera);
  struct Sum {
    glm::dvec3 value{0};
    double square = 0;
    double count = 0;
  };
  std::map<uint32_t, Sum> expected;
  for (const FilteredPixel& p : frames.pixels()) {
    if (p.slot == kNoCell) continue;
    ASSERT_EQ(grid.find(grid.keys.address(p.point)), p.slot);
    // No albedo of this scene is 0, so division recovers the demodulated sample, with one rounding.
    const Rgb sample = p.traced / p.factor;
    Sum& s = expected[p.slot];
    s.value += glm::dvec3(sample);
    s.square += static_cast<double>(sqr(luminance(sample)));
    s.count += 1;
  }
  EXPECT_GT(expected.size(), 50u);
  for (const auto& [slot, s] : expected) {
    const CellMoments m = grid.sums[slot].moments();
    ASSERT_EQ(m.count, s.count);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(m.mean[c], s.value[c] / s.count, 1e-5 * (s.value[c] / s.count) + 1e-9);
    ASSERT_NEAR(m.mean_square, s.square / s.count, 1e-5 * (s.square / s.count) + 1e-9);
  }
}

TEST(PathSpaceFilter, HalvesTheErrorOfOneSample) {
  CachedFrameSettings settings = small(48);
  settings.kind = CacheKind::none;
  settings.seed = 77;
  CachedFrames reference(build("cornell"), settings);
  std::vector<Rgb> expected(48 * 48, Rgb(0));
  for (int i = 0; i < 128; ++i) {
    const std::vector<Rgb>& frame = reference.render();
    for (size_t p = 0; p < frame.size(); ++p) expected[p] += frame[p] / 128.0f;
  }
  settings.seed = 0;
  CachedFrames plain(build("cornell"), settings);
  settings.kind = CacheKind::psf;
  CachedFrames filtered(build("cornell"), settings);
  EXPECT_LT(mse(filtered.render(), expected), 0.5 * mse(plain.render(), expected));
}

TEST(PathSpaceFilter, JitterKeepsTheMean) {
  const auto mean = [](bool jitter) {
    CachedFrameSettings settings = small(48);
    settings.psf.grid.jitter = jitter;
    CachedFrames frames(build("cornell"), settings);
    glm::dvec3 sum(0);
    for (int i = 0; i < 32; ++i) sum += mean_of(frames.render()) / 32.0;
    return sum;
  };
  const glm::dvec3 with = mean(true);
  const glm::dvec3 without = mean(false);
  // The same paths in other cells. Cells reach over edges by a pixel or two of 48.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(with[c] / without[c], 1.0, 0.02);
}

TEST(PathSpaceFilter, KeepsTheMeanOfPathTracing) {
  const auto mean = [](CacheKind kind) {
    CachedFrameSettings settings = small(48);
    settings.kind = kind;
    CachedFrames frames(build("cornell"), settings);
    glm::dvec3 sum(0);
    for (int i = 0; i < 32; ++i) sum += mean_of(frames.render()) / 32.0;
    return sum;
  };
  const glm::dvec3 filtered = mean(CacheKind::psf);
  const glm::dvec3 plain = mean(CacheKind::none);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(filtered[c] / plain[c], 1.0, 0.02);
}

TEST(PathSpaceFilter, ReplacementsOfUndersampledCellsKeepTheMean) {
  const auto mean = [](CacheKind kind, UndersampledCells undersampled_cells) {
    CachedFrameSettings settings = small(48);
    settings.kind = kind;
    settings.psf.grid.undersampled_cells = undersampled_cells;
    settings.psf.grid.cell_size = 1;  // one to two samples per cell
    settings.psf.grid.max_count = 4;  // cells stay undersampled
    CachedFrames frames(build("cornell"), settings);
    glm::dvec3 sum(0);
    for (int i = 0; i < 24; ++i) sum += mean_of(frames.render()) / 24.0;
    return sum;
  };
  const glm::dvec3 plain = mean(CacheKind::none, UndersampledCells::keep);
  for (const UndersampledCells mode : {UndersampledCells::neighbours, UndersampledCells::neighbours_coarser}) {
    const glm::dvec3 filtered = mean(CacheKind::psf, mode);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(filtered[c] / plain[c], 1.0, 0.02) << static_cast<int>(mode);
  }
}

TEST(PathSpaceFilter, DoesNotFilterEmission) {
  // Emission seen directly has the same bits with and without a filter, so edges of emitters stay sharp.
  CachedFrameSettings settings = small(64);
  settings.max_bounces = 0;
  CachedFrames filtered(build("cornell"), settings);
  settings.kind = CacheKind::none;
  CachedFrames plain(build("cornell"), settings);
  EXPECT_EQ(filtered.render(), plain.render());
  settings.kind = CacheKind::psf;
  settings.max_bounces = 4;
  CachedFrames more(build("cornell"), settings);
  const std::vector<Rgb>& direct = plain.radiance();
  more.render();
  for (size_t i = 0; i < direct.size(); ++i) {
    if (direct[i].r > 1.0f) {
      EXPECT_EQ(more.pixels()[i].unfiltered, direct[i]);
    }
  }
}

/// Rays of the second frame.
uint64_t count_rays(ReuseChoice reuse, CacheChoice cache, int edge_rays) {
  RenderSettings settings;
  settings.width = settings.height = 32;
  settings.threads = 1;
  settings.reuse = reuse;
  settings.cache = cache;
  settings.psf.edge_rays = edge_rays;
  Session session(build("cornell"), settings);
  for (int i = 0; i < 2; ++i) session.render_frame();
  const View<const uint32_t> rays = buffer_table(session).read(kRays);
  return std::accumulate(rays.begin(), rays.end(), uint64_t{0});
}

/// Only pixels that show cells trace more rays at edges. All paths of this frame are otherwise the same.
TEST(PathSpaceFilter, TracesNoEdgeRaysWithReservoirsOfPaths) {
  for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apg}) {
    EXPECT_GT(count_rays(ReuseChoice::none, cache, 16), count_rays(ReuseChoice::none, cache, 0));
    EXPECT_EQ(count_rays(ReuseChoice::restir_pt, cache, 16), count_rays(ReuseChoice::restir_pt, cache, 0));
  }
}

TEST(PathSpaceFilter, WaitsForAVertexThatIsNotNearlySpecular) {
  CachedFrames frames(build("cornell-mirror"), small(64));
  frames.render();
  size_t behind_mirror = 0;
  for (const FilteredPixel& p : frames.pixels()) {
    if (!p.filtered) continue;
    behind_mirror += p.point.position.z > 3.0f ? 1 : 0;  // behind the camera: visible only in the mirror
  }
  EXPECT_GT(behind_mirror, 20u);
}

Material coated(const Rgb& color) {
  Material m = testing::matte(color);
  m.clearcoat = 1;
  m.clearcoat_roughness = 0;
  return m;
}

TEST(PathSpaceFilter, DeltaLobesBypassTheCells) {
  // A smooth coat over a red base: the sky's reflection is the same with and without the filter.
  const Scene scene = testing::plate_under_sky(coated({0.5f, 0, 0}));
  CachedFrameSettings settings = small(16);
  CachedFrames filtered(scene, settings);
  settings.kind = CacheKind::none;
  CachedFrames plain(scene, settings);
  glm::dvec3 a(0);
  glm::dvec3 b(0);
  for (int i = 0; i < 400; ++i) {
    a += mean_of(filtered.render()) / 400.0;
    b += mean_of(plain.render()) / 400.0;
  }
  EXPECT_NEAR(b.g, 0.04, 0.002);  // Fresnel reflection at normal incidence
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 0.01 * b[c]);
}

TEST(PathSpaceFilter, BlackTexelsDoNotDarkenTheirCells) {
  // The left half is black in green, the right half white, and cells span both. The white half shows all of the light.
  Scene scene = testing::plate_under_sky(testing::matte(Rgb(0.9f, 0, 0.9f)));
  Mesh right;
  right.positions = {{0, 1e-4f, -5}, {0, 1e-4f, 5}, {5, 1e-4f, 5}, {5, 1e-4f, -5}};
  right.triangles = {{0, 1, 2}, {0, 2, 3}};
  testing::add_mesh(scene, testing::matte(Rgb(0.9f)), right);
  CachedFrameSettings settings = small(16);
  settings.psf.grid.cell_size = 8;
  CachedFrames frames(scene, settings);
  frames.render();
  const std::vector<Rgb>& image = frames.render();
  for (size_t i = 0; i < image.size(); ++i) {
    const bool white = i % 16 >= 8;
    EXPECT_NEAR(image[i].r, 0.9f, 1e-3f) << i;
    EXPECT_NEAR(image[i].g, white ? 0.9f : 0.0f, 1e-3f) << i;
  }
}

/// Mean luminance of the glossy left half of a plate over that of its matte right half, under a lamp at the side whose
/// highlight the camera does not see.
double glossy_over_matte(int roughness_bins) {
  Material gloss = testing::matte(Rgb(0.5f));
  gloss.metallic = 1;
  gloss.roughness = 0.3f;
  Scene scene = testing::plate_under_sky(gloss);
  scene.environment = {};
  Mesh right;
  right.positions = {{0, 1e-4f, -5}, {0, 1e-4f, 5}, {5, 1e-4f, 5}, {5, 1e-4f, -5}};
  right.triangles = {{0, 1, 2}, {0, 2, 3}};
  testing::add_mesh(scene, testing::matte(Rgb(0.5f)), right);
  Material lamp = testing::matte(Rgb(0));
  lamp.emission = Rgb(10);
  lamp.double_sided = true;
  testing::add_mesh(scene, lamp, quad({4, 1, 1}, {0, 0, -2}, {0, 2, 0}));
  CachedFrameSettings settings = small(16);
  settings.psf.grid.cell_size = 64;  // larger than the image
  settings.psf.grid.roughness_bins = roughness_bins;
  CachedFrames frames(scene, settings);
  for (int i = 0; i < 4; ++i) frames.render();
  double halves[2] = {};
  for (size_t i = 0; i < frames.radiance().size(); ++i)
    halves[i % 16 >= 8 ? 1 : 0] += static_cast<double>(luminance(frames.radiance()[i]));
  return halves[0] / halves[1];
}

TEST(PathSpaceFilter, RoughnessBinsSeparateGlossyFromMatteTexels) {
  EXPECT_GT(glossy_over_matte(0), 0.7);
  EXPECT_LT(glossy_over_matte(8), 0.4);
}

TEST(PathSpaceFilter, PixelsReadTheSlotsThatTheirPathsFound) {
  CachedFrameSettings settings = small(32);
  settings.psf.grid.undersampled_cells = UndersampledCells::keep;
  CachedFrames frames(build("cornell"), settings);
  std::vector<uint32_t> identity(32 * 32);
  frames.layers().identity = mutable_view_of(identity);
  frames.trace();
  frames.resolve();
  std::vector<Rgb> radiance(32 * 32);
  std::vector<uint32_t> by_slot(32 * 32);
  ResolveCellsKernel kernel;
  kernel.grid = frames.grid().view(frames.scene().view().camera);
  ASSERT_FALSE(kernel.grid.renumbered);
  kernel.grid.keys.cell_size *= 4;  // from other keys, pixels would find other cells
  kernel.pixels = view_of(frames.pixels());
  kernel.radiance = mutable_view_of(radiance);
  kernel.layers.identity = mutable_view_of(by_slot);
  kernel.width = 32;
  size_t known = 0;
  for (uint32_t i = 0; i < 32 * 32; ++i) {
    kernel(i % 32, i / 32);
    if (frames.pixels()[i].slot == kNoCell) continue;
    ++known;
    EXPECT_EQ(radiance[i], frames.radiance()[i]) << i;
    EXPECT_EQ(by_slot[i], identity[i]) << i;
  }
  EXPECT_GT(known, 500u);
}

TEST(PathSpaceFilter, LayersDescribeTheCells) {
  CachedFrames frames(build("cornell"), small(32));
  std::vector<float> count(32 * 32);
  std::vector<float> level(32 * 32);
  std::vector<float> occupancy(32 * 32);
  std::vector<uint32_t> identity(32 * 32);
  frames.layers().count = mutable_view_of(count);
  frames.layers().level = mutable_view_of(level);
  frames.layers().occupancy = mutable_view_of(occupancy);
  frames.layers().identity = mutable_view_of(identity);
  frames.render();
  const float before = *std::max_element(count.begin(), count.end());
  frames.render();
  EXPECT_GT(*std::max_element(count.begin(), count.end()), before);
  EXPECT_GT(occupancy[16 * 32 + 16], 0.0f);
  EXPECT_NE(identity[16 * 32 + 4], identity[16 * 32 + 28]);
  // The power of two nearest to eight footprints of a pixel.
  const CameraView camera = frames.scene().view().camera;
  const float distance = glm::length(frames.pixels()[16 * 32 + 16].point.position - camera.position);
  EXPECT_EQ(level[16 * 32 + 16], std::round(std::log2(8 * camera.cone_spread() * distance)));
}

}  // namespace
}  // namespace relume
