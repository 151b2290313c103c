// Filling, reading and maintaining the table at the sizes of 1080p and 4K.
#include <benchmark/benchmark.h>

#include "techniques/spatial/hash_grid/hash_grid_table.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 960;
/// Rows of the launch: 1080p and 4K have 2 and 8 million pixels.
constexpr uint32_t kRows1080p = 2160;
constexpr uint32_t kRows4K = 8640;

/// A camera whose pixels are 1/1000 rad wide, one metre above the plane of plane_point().
CameraView camera() {
  CameraView c;
  c.half_extent = Vec2(0.5f);
  c.resolution = Vec2(1000);
  return c;
}

CellPoint plane_point(uint32_t x, uint32_t y) {
  const float depth = 2.0f + 1e-3f * static_cast<float>(y);
  const Vec3 p(static_cast<float>(x) * 1e-3f * depth, -1.0f, depth);
  return {p, CellKeys::bins(Vec3(0, 1, 0), 2), 0, 0};
}

struct FillKernel {
  HashGridView grid;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    CellPoint p = plane_point(x, y);
    const uint32_t h = hash(x, y);
    p.position = grid.keys.jittered(p.position, Vec3(0, 1, 0), {to_unit_float(h), to_unit_float(hash(h))});
    grid.insert(p, Rgb(1), 1.0f, to_unit_float(hash(h, 1u)));
  }
};

struct LookUpKernel {
  HashGridView grid;
  View<Rgb> out;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    out[y * kWidth + x] = grid.moments(plane_point(x, y)).mean;
  }
};

/// Expected number of cells for an image of kWidth × rows pixels, as sessions estimate it.
uint64_t expected_cells(uint32_t rows) { return uint64_t{kWidth} * rows / 16; }

void bm_hash_grid_fill(benchmark::State& state) {
  const auto rows = static_cast<uint32_t>(state.range(0));
  HashGrid grid(HashGridSettings{}, expected_cells(rows));
  Backend backend(static_cast<int>(state.range(1)));
  for (auto _ : state) {
    launch(backend, "fill", FillKernel{grid.view(camera())}, kWidth, rows);
    state.PauseTiming();
    grid.end_frame(backend);
    state.ResumeTiming();
  }
  const HashGridStatistics s = grid.statistics();
  if (s.dropped > 0 || s.samples < uint64_t{kWidth} * rows) state.SkipWithError("samples are missing");
  state.SetItemsProcessed(state.iterations() * kWidth * rows);
  state.counters["cells"] = static_cast<double>(s.cells);
  state.counters["MB"] = static_cast<double>(s.memory_bytes) * 1e-6;
}
BENCHMARK(bm_hash_grid_fill)
    ->ArgNames({"rows", "threads"})
    ->Args({kRows1080p, 1})
    ->Args({kRows1080p, 2})
    ->Args({kRows4K, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void bm_hash_grid_look_up(benchmark::State& state) {
  const auto rows = static_cast<uint32_t>(state.range(0));
  HashGrid grid(HashGridSettings{}, expected_cells(rows));
  Backend backend(1);
  launch(backend, "fill", FillKernel{grid.view(camera())}, kWidth, rows);
  grid.end_frame(backend);
  std::vector<Rgb> out(size_t{kWidth} * rows);
  for (auto _ : state)
    launch(backend, "look-up", LookUpKernel{grid.view(camera()), mutable_view_of(out)}, kWidth, rows);
  if (out[out.size() / 2] != Rgb(1)) state.SkipWithError("a cell is missing");
  state.SetItemsProcessed(state.iterations() * kWidth * rows);
}
BENCHMARK(bm_hash_grid_look_up)->ArgNames({"rows"})->Arg(kRows1080p)->Unit(benchmark::kMillisecond);

/// Pooling and eviction in a filled table.
void bm_hash_grid_end_frame(benchmark::State& state) {
  const auto rows = static_cast<uint32_t>(state.range(0));
  HashGrid grid(HashGridSettings{}, expected_cells(rows));
  Backend backend(1);
  for (auto _ : state) {
    state.PauseTiming();
    launch(backend, "fill", FillKernel{grid.view(camera())}, kWidth, rows);
    state.ResumeTiming();
    grid.end_frame(backend);
  }
  if (grid.statistics().cells == 0) state.SkipWithError("no cells");
  state.counters["slots"] = static_cast<double>(grid.statistics().slots);
}
BENCHMARK(bm_hash_grid_end_frame)->ArgNames({"rows"})->Arg(kRows1080p)->Arg(kRows4K)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
