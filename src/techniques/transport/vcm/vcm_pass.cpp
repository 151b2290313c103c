#include "techniques/transport/vcm/vcm_pass.h"

#include <algorithm>
#include <bit>

#include "core/math.h"
#include "techniques/transport/path/frame_wavelength.h"

namespace relume {
namespace {

/// Upper bounds of the memory for light vertices, bytes: the vertex, its key, its elements of the grid and of the order
/// by bucket, which has two blocks while it grows, and its share of the counts of group_by_key().
constexpr uint64_t kBytesPerVertex = sizeof(PathVertex) + sizeof(SortedVertex) + 3 * sizeof(uint32_t) + 8;
/// For each light subpath: counts of vertices and rays, and the beginnings of at most two buckets.
constexpr uint64_t kBytesPerPath = 32;
/// Upper bound for what does not depend on the number of light subpaths.
constexpr uint64_t kFixedBytes = 64 << 10;

/// Limits of η, which keep its square within the range of floats. Any positive η gives weights that sum to one.
constexpr float kMinEta = 1e-18f;
constexpr float kMaxEta = 1e18f;
/// Number of vertices per light subpath that the weights of random connections assume. Any positive number gives
/// weights that sum to one.
constexpr float kTypicalVertices = 3;
/// Square of the least merging radius, m². Below it, the density of merging could overflow.
constexpr float kMinRadiusSquared = 1e-24f;

/// Sets the size. Frees the old block before it allocates a larger one.
template <typename T>
void reset_without_copy(Array<T>& array, size_t size) {
  if (size > array.capacity()) array = Array<T>(array.memory());
  array.reset(size, kUninitialized);
}

}  // namespace

uint64_t light_paths_of(const VcmSettings& settings, uint64_t pixels, uint32_t kept, bool guided) {
  const uint64_t bytes = (static_cast<uint64_t>(settings.memory_mib) << 20) - kFixedBytes;
  const uint64_t per_vertex = kBytesPerVertex + (guided ? sizeof(GuidedPoint) : 0);
  const uint64_t fitting = bytes / (kept * per_vertex + kBytesPerPath);
  const uint64_t wanted = pixels / static_cast<uint64_t>(settings.pixels_per_path);
  return std::max<uint64_t>(std::min(wanted, fitting), 1);
}

float merging_radius(const VcmSettings& settings, float scene_radius, uint32_t number) {
  const float shrunk = math::pow(static_cast<float>(number) + 1.0f, 0.5f * (settings.alpha - 1.0f));
  return settings.radius * scene_radius * shrunk;
}

uint64_t VcmPass::prepare_subpaths(const FrameContext& frame, uint64_t samples, BdptKernel& kernel) {
  BdptContext& c = kernel.context;
  stride_ = c.max_kept_vertices();
  const uint64_t pixels = frame.pixels();
  const uint64_t most = stride_ > 0 ? light_paths_of(vcm_, pixels, stride_, weighs_guide()) : 0;
  // If fewer pixels receive a sample, the number of light paths falls in proportion.
  paths_ = static_cast<uint32_t>(samples > 0 && most > 0 ? std::max<uint64_t>(most * samples / pixels, 1) : 0);
  reset_without_copy(light_vertices_, size_t{paths_} * stride_);
  reset_without_copy(guides_, weighs_guide() ? light_vertices_.size() : 0);
  counts_.reset(paths_, kUninitialized);
  rays_.reset(paths_, kUninitialized);
  sorted_.clear();
  // Paths of different wavelengths could not merge.
  if (frame.scene.disperses) c.wavelength_nm = frame_wavelength(frame.index);
  radius_ = 0;
  if (most == 0) return samples;
  const float scene_radius = frame.scene.lights.bounds.radius;
  radius_ = merging_radius(vcm_, scene_radius, accumulates_ ? frame.since_change : 0);
  if (sqr(radius_) < kMinRadiusSquared) radius_ = 0;
  // The splats of all frames, and the samples of those frames in which a pixel has one, only add up to the image if the
  // weights are the same in all frames. So do the splats of this frame and cells with samples of earlier ones.
  const float weighted = mixes_frames() ? merging_radius(vcm_, scene_radius, 0) : radius_;
  c.light_paths = static_cast<float>(most) / static_cast<float>(pixels);
  if (vcm_.connections > 0) c.connected = sqr(static_cast<float>(vcm_.connections) / kTypicalVertices);
  if (radius_ > 0.0f) c.merging = sqr(clamp(kPi * sqr(weighted) * static_cast<float>(most), kMinEta, kMaxEta));
  return paths_;
}

template <typename Context>
bool VcmPass::trace_light_subpaths(const FrameContext& frame, const BdptKernel& kernel, const Context& context,
                                   const MergeGrid& grid) {
  reset_without_copy(keys_, sorts() ? light_vertices_.size() : 0);
  LightSubpathKernelOf<Context> light;
  light.context = context;
  light.index = kernel.index;
  light.index.taken = {};
  light.index.tile = {};  // light subpaths would repeat with the tile, and merging needs all of them
  light.vertices = light_vertices_.mutable_view();
  light.guides = guides_.mutable_view();
  light.counts = counts_.mutable_view();
  light.keys = keys_.mutable_view();
  light.rays = rays_.mutable_view();
  light.saturated = kernel.saturated;
  light.nonfinite = kernel.nonfinite;
  light.grid = grid;
  light.stride = stride_;
  light.paths = paths_;
  const uint32_t rows = (paths_ - 1) / frame.width() + 1;
  return frame.launch_or_stop("light-paths", light, {frame.width(), rows});
}

bool VcmPass::sort_vertices(const FrameContext& frame, LightVertexGrid& grid) {
  constexpr uint32_t kVerticesPerTile = 1024;
  grid.vertices = light_vertices_.view();
  grid.guides = guides_.view();
  grid.stride = stride_;
  if (radius_ > 0.0f) {
    grid.near.radius_squared = sqr(radius_);
    grid.density = 1.0f / (kPi * sqr(radius_) * static_cast<float>(paths_));
  }
  const PrimitiveLaunch at{frame.backend, "merging", grid_scratch_};
  const Elements<uint32_t> keys{keys_.view()};
  const size_t slots = keys_.size();
  groups_.order.reset(slots, kUninitialized);  // so that group_by_key() never has to grow it
  if (!group_by_key(at, keys, keys.values.size, grid.near.grid.buckets, groups_, frame.stop)) return false;
  // The number of vertices varies from frame to frame. With room for a quarter more, larger blocks are rare.
  const size_t count = groups_.order.size();
  if (count > sorted_.capacity()) reset_without_copy(sorted_, std::min(count + count / 4, slots));
  sorted_.reset(count, kUninitialized);
  const SortVerticesKernel sort{grid.vertices, groups_.order.view(), sorted_.mutable_view()};
  grid.near.sorted = sorted_.view();
  grid.near.begins = groups_.begins.view();
  grid.connections = static_cast<uint32_t>(vcm_.connections);
  const float tried = static_cast<float>(paths_) * static_cast<float>(vcm_.connections);
  if (tried > 0.0f) grid.scale = static_cast<float>(sorted_.size()) / tried;
  return sorted_.empty() || frame.launch_or_stop("merging", sort, {sort.sorted.size, 1, kVerticesPerTile});
}

bool VcmPass::prepare_camera(const FrameContext& frame, const BdptKernel& kernel, VcmKernel& camera) {
  if (paths_ > 0) {
    MergeGrid& grid = camera.grid.near.grid;
    grid.center = frame.scene.lights.bounds.center;
    grid.inverse_edge = radius_ > 0.0f ? 0.5f / radius_ : 0.0f;
    grid.buckets = std::bit_ceil(std::max(paths_, 2u));
    const bool traced = learns() ? trace_light_subpaths(frame, kernel, learning(kernel.context), grid)
                                 : trace_light_subpaths(frame, kernel, kernel.context, grid);
    if (!traced) return false;
    if (sorts() && !sort_vertices(frame, camera.grid)) return false;
  }
  camera.context = kernel.context;
  camera.index = kernel.index;
  camera.hits = kernel.hits;
  camera.allocation = kernel.allocation;
  camera.output = kernel.output;
  camera.rays = kernel.rays;
  camera.vertices = light_vertices_.view();
  camera.guides = guides_.view();
  camera.counts = counts_.view();
  camera.light_rays = rays_.view();
  camera.stride = stride_;
  camera.pixels = frame.pixels();
  if (merges()) camera.caustics = caustics(frame);
  return true;
}

bool VcmPass::trace(const FrameContext& frame, const BdptKernel& kernel) {
  if (samples_indirect_light()) return trace_into(frame, kernel, samples_output(frame, kernel));
  return trace_into(frame, kernel, kernel.output);
}

std::vector<PassStatistic> VcmPass::statistics() const {
  return {{"light-paths", static_cast<double>(paths_)},
          {"merging-vertices", static_cast<double>(sorted_.size())},
          {"merging-radius", static_cast<double>(radius_)}};
}

}  // namespace relume
