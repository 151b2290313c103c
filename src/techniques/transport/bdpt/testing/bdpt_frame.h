// Runs the kernels of bidirectional path tracing without a session, to give tests access to every buffer.
#pragma once

#include <vector>

#include "frame/launch.h"
#include "scene/compiled_scene.h"
#include "techniques/transport/bdpt/bdpt.h"

namespace relume::testing {

struct BdptOptions {
  int width = 16;
  int height = 16;
  uint32_t max_bounces = 8;
  bool russian_roulette = true;
  bool light_only = false;
  uint32_t max_light_vertices = 16;
  float connection_roulette = 0;
  LightSelectorKind lights = LightSelectorKind::power;
  int threads = 1;
  uint32_t first_nee_bounce = 0;    ///< as in PathContext
  std::vector<Index> movable = {};  ///< CompileOptions::movable
};

/// A compiled scene and the buffers of one frame.
class BdptFrame {
 public:
  BdptFrame(Scene scene, const BdptOptions& o);

  BdptContext context();

  /// Traces sample `sample` of every pixel. `rows`: of the bands in which threads with little memory trace them; 0: the
  /// host traces tiles.
  void run(uint32_t seed, uint32_t sample, uint32_t rows = 0);
  void trace_in_bands(BdptKernel kernel, uint32_t rows);
  /// Traces sample `sample` of every pixel without splats.
  template <typename Context>
  void run_in(const Context& c, uint32_t seed, uint32_t sample) {
    const SampleIndex index = find_hits(seed, sample);
    const BdptKernelOf<Context> kernel{c,
                                       index,
                                       view_of(hits),
                                       view_of(allocation),
                                       {mutable_view_of(radiance)},
                                       mutable_view_of(rays),
                                       {&saturated, 1},
                                       {&nonfinite, 1}};
    launch(backend, "trace", kernel, width(), height());
    splats.assign(splats.size(), {});
  }
  /// Finds the primary hits of a sample.
  SampleIndex find_hits(uint32_t seed, uint32_t sample);

  uint32_t width() const { return static_cast<uint32_t>(options.width); }
  uint32_t height() const { return static_cast<uint32_t>(options.height); }

  BdptOptions options;
  CompiledScene compiled;
  Backend backend;
  std::vector<AliasEntry> power;
  std::vector<AliasEntry> emission;
  std::vector<Rgb> light_medium;
  std::vector<Hit> hits;
  std::vector<uint32_t> allocation;  ///< empty: one path per pixel
  std::vector<Rgb> radiance;
  std::vector<uint32_t> rays;
  std::vector<FixedPointRgb> splats;
  uint64_t saturated = 0;
  uint64_t nonfinite = 0;
};

/// Mean of `spp` samples per pixel.
std::vector<Rgb> render_bdpt(Scene scene, const BdptOptions& options, int spp, uint32_t seed = 0);

}  // namespace relume::testing
