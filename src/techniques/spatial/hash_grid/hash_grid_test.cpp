#include "techniques/spatial/hash_grid/hash_grid_table.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "techniques/spatial/hash_grid/testing/grid_camera.h"
#include "testing/random.h"

namespace relume {
namespace {

CellPoint point(uint32_t i) {
  const Vec3 p(to_unit_float(hash(i, 1u)), to_unit_float(hash(i, 2u)), 2.0f);
  return {p, CellKeys::bins(Vec3(0, 0, -1), 2), 0, 0};
}

Rgb value(uint32_t i) {
  return {std::exp2(16.0f * to_unit_float(hash(i, 3u)) - 8.0f), to_unit_float(hash(i, 4u)), 1.0f};
}

/// Inserts one sample per element.
struct FillKernel {
  HashGridView grid;
  uint32_t first = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = first + y * 64 + x;
    grid.insert(point(i), value(i), 1.0f, to_unit_float(hash(i, 5u)));
  }
};

void fill(HashGrid& grid, Backend& backend, uint32_t rows, uint32_t first = 0) {
  launch(backend, "fill", FillKernel{grid.view(grid_camera()), first}, 64, rows);
}

HashGridSettings plain() {
  HashGridSettings s;
  s.undersampled_cells = UndersampledCells::keep;
  s.change_detection = 0;
  return s;
}

TEST(HashGrid, MomentsOfEveryCellEqualBruteForce) {
  HashGrid grid(plain(), 1 << 14);
  Backend backend(2);
  fill(grid, backend, 256);
  struct Sum {
    glm::dvec3 value{0};
    double square = 0;
    double count = 0;
    CellPoint p;
  };
  std::map<uint64_t, Sum> expected;
  const HashGridView v = grid.view(grid_camera());
  for (uint32_t i = 0; i < 64 * 256; ++i) {
    Sum& s = expected[v.keys.address(point(i)).fingerprint];
    s.value += glm::dvec3(value(i));
    s.square += static_cast<double>(sqr(luminance(value(i))));
    s.count += 1;
    s.p = point(i);
  }
  EXPECT_GT(expected.size(), 1000u);
  EXPECT_EQ(v.moments(expected.begin()->second.p).count, 0.0f);  // no moments before advance()
  grid.advance(backend);
  for (const auto& [key, s] : expected) {
    const CellMoments m = v.moments(s.p);
    ASSERT_EQ(m.count, s.count);
    // Sums of up to thousands of floats with 24 bits are exact in double; one rounding to float remains.
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(m.mean[c] / (s.value[c] / s.count), 1.0, 3e-7);
    ASSERT_NEAR(m.mean_square / (s.square / s.count), 1.0, 5e-7);
  }
  EXPECT_EQ(grid.statistics().cells, expected.size());
  EXPECT_EQ(grid.statistics().samples, 64u * 256u);
  EXPECT_EQ(grid.statistics().dropped, 0u);
}

/// Moments of points 0 to count − 1, looked up by key.
std::vector<CellMoments> everything(HashGrid& grid, uint32_t count) {
  const HashGridView v = grid.view(grid_camera());
  std::vector<CellMoments> all;
  for (uint32_t i = 0; i < count; ++i) all.push_back(v.moments(point(i)));
  return all;
}

/// Moments of all cells after four frames, each with twice the samples of the previous one.
std::vector<CellMoments> four_frames(const HashGridSettings& settings, int threads, HashGridStatistics& statistics) {
  HashGrid grid(settings, 2048);
  Backend backend(threads);
  for (uint32_t frame = 0; frame < 4; ++frame) {
    fill(grid, backend, 64 << frame, frame * 500);
    grid.end_frame(backend);
  }
  statistics = grid.statistics();
  return everything(grid, 36000);
}

/// Whether each slot is occupied after one frame.
std::vector<bool> taken_slots(const HashGridSettings& settings, int threads) {
  HashGrid grid(settings, 64);
  Backend backend(threads);
  fill(grid, backend, 256);
  grid.advance(backend);
  std::vector<bool> taken;
  for (const uint64_t fingerprint : grid.view(grid_camera()).fingerprints) taken.push_back(fingerprint != 0);
  return taken;
}

void expect_same_bits_with_any_number_of_threads(const HashGridSettings& settings, HashGridStatistics& first) {
  const std::vector<CellMoments> one = four_frames(settings, 1, first);
  for (const int threads : {2, 3, 8}) {
    HashGridStatistics statistics;
    const std::vector<CellMoments> many = four_frames(settings, threads, statistics);
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(CellMoments)), 0) << threads;
    EXPECT_EQ(statistics.cells, first.cells);
    EXPECT_EQ(statistics.discarded, first.discarded);
    EXPECT_EQ(statistics.dropped, 0u);
  }
  EXPECT_EQ(first.dropped, 0u);
}

HashGridSettings with_coarser_cells() {
  HashGridSettings settings = plain();
  settings.undersampled_cells = UndersampledCells::coarser;
  settings.change_detection = 3;
  return settings;
}

TEST(HashGrid, SameBitsWithAnyNumberOfThreads) {
  HashGridStatistics statistics;
  expect_same_bits_with_any_number_of_threads(with_coarser_cells(), statistics);
  EXPECT_GT(statistics.rebuilds, 0u);
  EXPECT_EQ(statistics.discarded, 0u);
}

TEST(HashGrid, SameSlotsWithAnyNumberOfThreads) {
  const std::vector<bool> one = taken_slots(with_coarser_cells(), 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(taken_slots(with_coarser_cells(), threads), one) << threads;
}

TEST(HashGrid, SameBitsWhereTheTableIsTooSmall) {
  for (const int max_cells : {1, 256, 4096}) {
    HashGridSettings settings = with_coarser_cells();
    settings.max_cells = max_cells;
    HashGridStatistics statistics;
    expect_same_bits_with_any_number_of_threads(settings, statistics);
    EXPECT_EQ(statistics.slots, static_cast<uint64_t>(max_cells));
    EXPECT_GT(statistics.discarded, 0u) << max_cells;
  }
}

TEST(HashGrid, EvictsByAgeAndReusesSlots) {
  HashGridSettings settings = plain();
  settings.max_age = 3;
  settings.max_cells = 1 << 13;
  HashGrid grid(settings, 1 << 11);
  Backend backend(1);
  fill(grid, backend, 16);
  grid.end_frame(backend);
  const uint64_t cells = grid.statistics().cells;
  for (int frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(grid.statistics().cells, cells);
    grid.end_frame(backend);
  }
  grid.end_frame(backend);
  EXPECT_EQ(grid.statistics().cells, 0u);
  EXPECT_EQ(grid.statistics().evicted, cells);
  // New cells in each frame, in total more than fit into the table.
  for (uint32_t frame = 0; frame < 60; ++frame) {
    fill(grid, backend, 8, 100'000 + frame * 512);
    grid.end_frame(backend);
  }
  EXPECT_EQ(grid.statistics().dropped, 0u);
  EXPECT_LE(grid.statistics().slots, 1u << 13);
}

TEST(HashGrid, FollowsTheNumberOfCells) {
  HashGrid grid(plain(), 64);
  Backend backend(1);
  const uint64_t small = grid.statistics().slots;
  for (int frame = 0; frame < 6; ++frame) {
    fill(grid, backend, 512);
    grid.end_frame(backend);
  }
  EXPECT_GT(grid.statistics().slots, 2 * grid.statistics().cells);
  EXPECT_GT(grid.statistics().slots, small);
  EXPECT_LT(grid.statistics().mean_probes, 3.0f);
  const std::vector<CellMoments> before = everything(grid, 1000);
  EXPECT_EQ(before[0].mean.b, 1.0f);
}

TEST(HashGrid, ManyOrientationsInAVoxelAreFoundSoon) {
  // A bumpy surface with 24 normals in each of 500 voxels. The table is a third full.
  HashGrid grid(plain(), 9000);
  Backend backend(1);
  const HashGridView v = grid.view(grid_camera());
  const float edge = std::exp2(static_cast<float>(v.keys.level_of_detail(point(0).position)));
  for (uint32_t i = 0; i < 500 * 24; ++i) {
    CellPoint p = point(0);
    p.position.x = edge * static_cast<float>(i / 24 % 25);
    p.position.y = edge * static_cast<float>(i / 24 / 25);
    p.normal = 1 + i % 24;
    v.insert(p, Rgb(1), 1.0f, 0.5f);
  }
  grid.advance(backend);
  EXPECT_GT(grid.statistics().occupancy, 0.25f);
  EXPECT_LT(grid.statistics().mean_probes, 6.0f);  // at least 12.5 if all of a voxel began at one slot
}

TEST(HashGrid, ResumesFromCheckpoint) {
  HashGridSettings settings = plain();
  settings.undersampled_cells = UndersampledCells::coarser;
  Backend backend(2);
  HashGrid grid(settings, 1 << 12);
  fill(grid, backend, 64);
  grid.end_frame(backend);
  const std::vector<std::byte> bytes = grid.save();
  HashGrid other(settings, 64);
  ASSERT_TRUE(other.load(bytes));
  for (HashGrid* g : {&grid, &other}) {
    fill(*g, backend, 64, 1234);
    g->end_frame(backend);
  }
  const auto a = everything(grid, 4096);
  const auto b = everything(other, 4096);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(CellMoments)), 0);
  EXPECT_EQ(grid.statistics().slots, other.statistics().slots);
}

TEST(HashGrid, RejectsInvalidCheckpoints) {
  HashGrid grid(plain(), 64);
  const std::vector<std::byte> bytes = grid.save();
  EXPECT_FALSE(grid.load({}));
  EXPECT_FALSE(grid.load(std::span(bytes).first(bytes.size() - 1)));
  const std::vector<std::byte> zeros(bytes.size());
  EXPECT_FALSE(grid.load(zeros));
}

TEST(HashGrid, DropsNonFiniteAndClampsLargeSamples) {
  HashGrid grid(plain(), 64);
  const HashGridView v = grid.view(grid_camera());
  EXPECT_EQ(v.insert(point(0), Rgb(std::numeric_limits<float>::quiet_NaN()), 1, 0.9f), kNoCell);
  EXPECT_EQ(v.insert(point(0), Rgb(kInfinity), 1, 0.9f), kNoCell);
  EXPECT_NE(v.insert(point(0), Rgb(1e30f), 1, 0.9f), kNoCell);
  EXPECT_EQ(grid.statistics().nonfinite, 2u);
  EXPECT_EQ(grid.statistics().saturated, 1u);
}

TEST(HashGrid, ClampsFirefliesToAMultipleOfTheMean) {
  HashGridSettings settings = plain();
  settings.clamp = 4;
  HashGrid grid(settings, 64);
  Backend backend(1);
  for (int i = 0; i < 10; ++i) grid.view(grid_camera()).insert(point(0), Rgb(1), 1, 0.9f);
  grid.end_frame(backend);
  grid.view(grid_camera()).insert(point(0), Rgb(1000), 1, 0.9f);
  grid.end_frame(backend);
  EXPECT_NEAR(grid.view(grid_camera()).moments(point(0)).mean.r, (10.0 + 4.0) / 11.0, 1e-5);
}

TEST(HashGrid, NewCellsInheritFromTheNeighbouringLevel) {
  HashGridSettings settings = plain();
  settings.inherited_count = 16;
  Backend backend(1);
  for (const float scale : {0.5f, 2.0f}) {  // cells were twice or half as large before
    HashGrid grid(settings, 1 << 12);
    CameraView before = grid_camera();
    before.resolution *= scale;
    // The centre of the new cell decides.
    const CellKeys keys = grid.view(grid_camera()).keys;
    CellPoint p = point(0);
    p.position = Vec3(keys.middle(p.position, keys.level_of_detail(p.position)));
    for (int i = 0; i < 40; ++i) grid.view(before).insert(p, Rgb(3), 1, 0.9f);
    grid.end_frame(backend);
    for (int i = 0; i < 16; ++i) grid.view(grid_camera()).insert(p, Rgb(1), 1, 0.9f);
    grid.end_frame(backend);
    const CellMoments m = grid.view(grid_camera()).moments(p);
    EXPECT_EQ(m.count, 32.0f);  // 16 inherited of 40, and 16 new ones
    EXPECT_NEAR(m.mean.r, 2.0f, 1e-6f);
    EXPECT_EQ(grid.statistics().inherited, 1u);
  }
}

TEST(HashGrid, IsolatedCellsShareNoSamples) {
  HashGridSettings settings = plain();
  settings.undersampled_cells = UndersampledCells::coarser;
  settings.inherited_count = 128;
  Backend backend(1);
  const auto neighbour_inherits = [&](bool alone) {
    HashGrid grid(settings, 1 << 12);
    const float edge = std::exp2(static_cast<float>(grid.view(grid_camera()).keys.level_of_detail(point(0).position)));
    CellPoint beside = point(0);
    beside.position.x += 1.25f * edge;
    for (int frame = 0; frame < 2; ++frame) {
      // The neighbour is new in the second frame and could inherit.
      const HashGridView v = grid.view(grid_camera());
      for (int i = 0; i < 64; ++i) v.insert(point(0), Rgb(2), 1, 0.0f, kNoCell, alone);
      if (frame == 1) v.insert(beside, Rgb(0), 1, 0.9f, kNoCell, alone);
      grid.end_frame(backend);
    }
    return grid.view(grid_camera()).moments(beside).mean != Rgb(0);
  };
  EXPECT_TRUE(neighbour_inherits(false));
  EXPECT_FALSE(neighbour_inherits(true));
}

TEST(HashGrid, UndersampledCellsReadCoarserCells) {
  HashGridSettings settings = plain();
  settings.undersampled_cells = UndersampledCells::coarser;
  settings.min_count = 8;
  HashGrid grid(settings, 1 << 12);
  Backend backend(1);
  const HashGridView v = grid.view(grid_camera());
  // One sample per cell over several coarser cells; u = 0 adds each to all coarser levels.
  const float edge = std::exp2(static_cast<float>(v.keys.level_of_detail(point(0).position)));
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      CellPoint p = point(0);
      p.position += edge * Vec3(static_cast<float>(x) - 8.0f, static_cast<float>(y) - 8.0f, 0);
      v.insert(p, Rgb(2), 1, 0.0f);
    }
  }
  grid.end_frame(backend);
  const CellMoments m = grid.view(grid_camera()).moments(point(0));
  EXPECT_GE(m.count, 8.0f);  // a cell two levels coarser covers 4² cells
  EXPECT_EQ(m.mean, Rgb(2));
  // A cell without samples is pooled, too.
  CellPoint lone = point(0);
  lone.position += edge * Vec3(0.4f, 8.2f, 0);
  EXPECT_GT(grid.view(grid_camera()).moments(lone).count, 0.0f);
}

TEST(HashGrid, CoarserCellsGetTheirShare) {
  HashGridSettings settings = plain();
  settings.undersampled_cells = UndersampledCells::coarser;
  HashGrid grid(settings, 1 << 12);
  const HashGridView v = grid.view(grid_camera());
  constexpr int kSamples = 80000;
  for (uint32_t i = 0; i < kSamples; ++i) v.insert(point(0), Rgb(1), 1, to_unit_float(hash(i)));
  double expected = kSamples;
  for (int k = 0; k <= kCoarserLevels; ++k, expected *= 0.125) {
    const uint32_t slot = v.find(v.keys.address(point(0), k));
    ASSERT_NE(slot, kNoCell);
    EXPECT_NEAR(v.sums[slot].count, expected, 5 * std::sqrt(expected) + 1);  // five standard errors
  }
}

TEST(HashGrid, UndersampledCellsPoolTheirNeighbours) {
  HashGridSettings settings = plain();
  settings.undersampled_cells = UndersampledCells::neighbours;
  HashGrid grid(settings, 1 << 12);
  Backend backend(1);
  const HashGridView v = grid.view(grid_camera());
  const int level = v.keys.level_of_detail(point(0).position);
  const float edge = std::exp2(static_cast<float>(level));
  double sum = 0;
  for (int i = 0; i < 9; ++i) {  // the cell and the eight around it in the plane
    CellPoint p = point(0);
    p.position += edge * Vec3(static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 - 1), 0);
    v.insert(p, Rgb(static_cast<float>(i)), 1, 0.0f);
  }
  grid.end_frame(backend);
  // The quarter of the cell that contains the point determines the nearest neighbours.
  const glm::dvec3 x = v.keys.grid_position(glm::dvec3(point(0).position), level);
  const int dx = x.x - std::floor(x.x) < 0.5 ? -1 : 1;
  const int dy = x.y - std::floor(x.y) < 0.5 ? -1 : 1;
  for (const int i : {4, 4 + dx, 4 + 3 * dy, 4 + dx + 3 * dy}) sum += i;
  const CellMoments m = grid.view(grid_camera()).moments(point(0));
  EXPECT_EQ(m.count, 4.0f);
  EXPECT_NEAR(m.mean.r, sum / 4.0, 1e-5);
}

}  // namespace
}  // namespace relume
