// Frames of all caches in a hash grid without a session, for tests and benchmarks.
#pragma once

#include <string>
#include <vector>

#include "scene/compiled_scene.h"
#include "techniques/radiance_cache/adaptive_psf/settings.h"
#include "techniques/radiance_cache/path_graphs/path_graphs.h"
#include "techniques/radiance_cache/path_graphs/settings.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/path/chain_output.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/indirect_sample.h"
#include "techniques/transport/path/specular_part.h"

namespace relume::testing {

enum class CacheKind { none, psf, apsf, apg, apsf_apg };
inline constexpr CacheKind kCacheKinds[] = {CacheKind::psf, CacheKind::apsf, CacheKind::apg, CacheKind::apsf_apg};

inline std::string name_of(CacheKind kind) {
  const char* names[] = {"none", "psf", "apsf", "apg", "apsf_apg"};
  return names[static_cast<int>(kind)];
}

struct CachedFrameSettings {
  CacheKind kind = CacheKind::psf;
  int width = 64;
  int height = 64;
  int threads = 1;
  uint32_t max_bounces = 8;
  uint32_t seed = 0;
  bool russian_roulette = true;
  bool watched = false;   ///< whether two policies observe the paths that the cache modifies
  bool recorded = false;  ///< whether paths leave records for regions and chains; excludes `watched`
  bool sampled = false;   ///< whether paths leave light to reservoirs; needs `recorded`
  PathSpaceFilterSettings psf;
  AdaptivePsfSettings apsf;
  PathGraphSettings apg;
  uint64_t expected_cells = 1 << 14;
};

class CachedFrames {
 public:
  static constexpr uint32_t kRecordedVertices = 3;

  CachedFrames(Scene scene, const CachedFrameSettings& settings);

  HashGrid& grid() { return grid_; }
  CompiledScene& scene() { return scene_; }
  Backend& backend() { return backend_; }
  const std::vector<FilteredPixel>& pixels() const { return pixels_; }
  /// By pixel; empty without split and finer cells.
  const std::vector<OtherCells>& others() const { return others_; }
  const std::vector<Rgb>& radiance() const { return radiance_; }
  CellLayers& layers() { return layers_; }
  /// Record of vertex v at pixel p: element v · pixels + p. Only with `recorded`.
  const std::vector<VertexSample>& records() const { return records_; }
  /// The same for chains, of which none has a state: each score above 0 starts one.
  const std::vector<MarkovRecord<GuideState>>& directions() const { return directions_; }
  const std::vector<MarkovRecord<LightState>>& lights() const { return lights_; }
  /// Sample of each pixel for reservoirs. Only with `sampled`.
  const std::vector<IndirectSample>& samples() const { return samples_; }
  uint64_t rays() const {
    uint64_t sum = 0;
    for (const uint32_t r : rays_) sum += r;
    return sum;
  }

  /// Renders one sample per pixel; returns the image.
  const std::vector<Rgb>& render();
  /// Traces one path per pixel, whose samples wait for the cells.
  void trace();
  /// Pools the frame's samples with the cells and computes the image.
  void resolve();

 private:
  uint32_t width() const { return static_cast<uint32_t>(settings_.width); }

  PathRecording recording();
  ChainOutput chains();
  template <typename Cache>
  void trace_cells(const PathContext& context, const SampleIndex& index, const Cache& cache);
  template <typename... Outputs>
  void trace(const PathContext& context, const SampleIndex& index, const Outputs&... outputs);
  template <typename Kernel>
  void run(const char* name, const Kernel& kernel);

  CachedFrameSettings settings_;
  CompiledScene scene_;
  Backend backend_;
  HashGrid grid_;
  std::vector<AliasEntry> power_;
  std::vector<Hit> hits_;
  std::vector<FilteredPixel> pixels_;
  std::vector<OtherCells> others_;
  std::vector<uint32_t> rays_;
  std::vector<Rgb> radiance_;
  OctreeTree tree_;  ///< of regions for records
  std::vector<VertexSample> records_;
  std::vector<MarkovRecord<GuideState>> directions_;
  std::vector<MarkovRecord<LightState>> lights_;
  std::vector<IndirectSample> samples_;
  std::vector<FirstVertex> first_vertices_;
  std::vector<Rgb> specular_;
  CellLayers layers_;
  uint32_t frame_ = 0;
};

}  // namespace relume::testing
