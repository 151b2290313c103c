#include "techniques/light_sampling/adaptive_tiles/learned_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/scan.h"

namespace relume {
namespace {

constexpr uint32_t kMostProxies = 1u << 30;  // above those of any scene

/// Tiles along an edge of `size` pixels, for every offset.
uint32_t tiles_along(uint32_t size, uint32_t tile_size) { return (size + tile_size - 1) / tile_size + 1; }

TileGrid make_grid(const FrameFeedback& feedback, const TileOptions& options, uint32_t seed) {
  TileGrid grid;
  grid.camera = feedback.camera;
  grid.camera.resolution = {static_cast<float>(feedback.width), static_cast<float>(feedback.height)};
  grid.tile_size = options.tile_size;
  grid.list_size = options.list_size;
  grid.columns = tiles_along(feedback.width, options.tile_size);
  grid.rows = tiles_along(feedback.height, options.tile_size);
  if (options.jitter) grid.offset = {hash(seed, 1u) % options.tile_size, hash(seed, 2u) % options.tile_size};
  return grid;
}

bool is_valid(const TileGrid& grid, uint32_t width, uint32_t height) {
  constexpr uint32_t kMost = 1 << 16;  // far above the settings
  if (!is_undamaged(grid.camera) || grid.tile_size == 0 || grid.list_size == 0) return false;
  if (grid.tile_size > kMost || grid.list_size > kMost) return false;
  if (grid.offset.x >= grid.tile_size || grid.offset.y >= grid.tile_size) return false;
  return grid.columns == tiles_along(width, grid.tile_size) && grid.rows == tiles_along(height, grid.tile_size) &&
         grid.camera.resolution == Vec2(static_cast<float>(width), static_cast<float>(height));
}

}  // namespace

bool is_undamaged(const CameraView& camera) {
  const bool is_known = camera.projection == Projection::perspective || camera.projection == Projection::orthographic ||
                        camera.projection == Projection::panoramic;
  const auto is_unit = [](const Vec3& axis) { return std::fabs(glm::dot(axis, axis) - 1.0f) < 0.01f; };  // not NaN
  return is_known && is_finite(camera.position) && is_unit(camera.axes.t) && is_unit(camera.axes.b) &&
         is_unit(camera.axes.n);
}

LearnedTiles LearnedTiles::copy(Backend& backend) const {
  LearnedTiles result(lights_.memory());
  result.grid_ = grid_;
  relume::copy(backend, "neeat.copy", lights_, result.lights_);
  relume::copy(backend, "neeat.copy", depths_, result.depths_);
  relume::copy(backend, "neeat.copy", proxies_, result.proxies_);
  return result;
}

void LearnedTiles::build_proxies(const PrimitiveLaunch& at, View<const AliasEntry> power, View<const uint32_t> counts,
                                 uint32_t used, float feedback) {
  proxies_.reset(power.empty() ? 0 : size_t{power.size} + 1, kUninitialized);
  exclusive_scan(at, ProxyCounts{power, counts, used, feedback}, proxies_.mutable_view());
}

void LearnedTiles::fill(Backend& backend, const FrameFeedback& feedback, const LearnedTiles& before,
                        const TileOptions& options, uint32_t seed) {
  if (proxies_.empty()) return clear_lists();
  grid_ = make_grid(feedback, options, seed);
  lights_.reset(size_t{grid_.count()} * grid_.list_size, kUninitialized);
  depths_.reset(grid_.count(), kUninitialized);
  FillTilesKernel kernel;
  kernel.feedback = feedback.pixels;
  kernel.width = feedback.width;
  kernel.height = feedback.height;
  kernel.before = before.lists(options.depth_tolerance);
  kernel.all = proxies();
  kernel.grid = grid_;
  kernel.radius = options.radius;
  kernel.seed = seed;
  kernel.lights = lights_.mutable_view();
  kernel.depths = depths_.mutable_view();
  launch(backend, "neeat.tiles", kernel, grid_.columns, grid_.rows);
}

void LearnedTiles::clear_lists() {
  grid_ = {};
  lights_.clear();
  depths_.clear();
}

void LearnedTiles::swap_lists(LearnedTiles& other) noexcept {
  std::swap(grid_, other.grid_);
  lights_.swap(other.lights_);
  depths_.swap(other.depths_);
}

bool LearnedTiles::consistent(uint32_t width, uint32_t height, uint32_t light_count) const {
  const std::span<const uint32_t> first = proxies_.read();
  if (!first.empty()) {
    if (first.size() != size_t{light_count} + 1 || first.front() != 0) return false;
    if (!std::is_sorted(first.begin(), first.end()) || first.back() > kMostProxies) return false;
  }
  if (grid_.count() == 0) return lights_.empty() && depths_.empty();
  if (!is_valid(grid_, width, height) || depths_.size() != grid_.count()) return false;
  if (lights_.size() != size_t{grid_.count()} * grid_.list_size) return false;
  const std::span<const LightId> lights = lights_.read();
  for (size_t tile = 0; tile < grid_.count(); ++tile) {
    const auto list = lights.subspan(tile * grid_.list_size, grid_.list_size);
    if (!std::is_sorted(list.begin(), list.end())) return false;
  }
  return true;
}

void LearnedTiles::save(std::ostream& out) const {
  write_value(out, grid_);
  write_array(out, lights_);
  write_array(out, depths_);
  write_array(out, proxies_);
}

void LearnedTiles::load(std::istream& in) {
  read_value(in, grid_);
  read_array(in, lights_);
  read_array(in, depths_);
  read_array(in, proxies_);
}

}  // namespace relume
