#include <benchmark/benchmark.h>

#include <vector>

#include "builtin_scenes/builtin.h"
#include "frame/launch.h"
#include "scene/compiled_scene.h"
#include "techniques/temporal/reprojection/reprojection.h"

namespace relume {
namespace {

/// Votes of one stored sample per pixel of the Cornell box, with an unchanged camera.
void bm_depth_vote(benchmark::State& state) {
  constexpr uint32_t kSize = 256;
  const CompiledScene scene(find_builtin_scene("cornell")->build(), {.width = kSize, .height = kSize});
  std::vector<Hit> hits(kSize * kSize);
  const PrimaryHitsKernel primary{scene.view(), SampleIndex{}, mutable_view_of(hits), {}, kSize};
  Backend backend(1);
  launch(backend, "gbuffer", primary, kSize, kSize);
  std::vector<StoredSample> stored(hits.size());
  for (size_t i = 0; i < hits.size(); ++i) {
    stored[i].hit = hits[i];
    stored[i].scatter = stored[i].to_light = pack_direction(Vec3(0, 1, 0));
  }
  const std::vector<StoredPixel> pixels(hits.size());
  std::vector<uint64_t> votes(hits.size(), kNoVote);
  std::vector<uint32_t> reject_reasons(hits.size());
  const std::vector<Rgb> mean(hits.size(), Rgb(0.5f));
  std::vector<uint32_t> limits(hits.size());
  DepthVoteKernel kernel;
  kernel.mean = view_of(mean);
  kernel.limits = mutable_view_of(limits);
  kernel.scene = scene.view();
  kernel.stored = view_of(stored);
  kernel.pixels = view_of(pixels);
  kernel.votes = mutable_view_of(votes);
  kernel.reject_reasons = mutable_view_of(reject_reasons);
  kernel.max_error = 1.0f;
  kernel.width = kSize;
  for (auto _ : state) launch(backend, "vote", kernel, kSize, kSize);
  state.SetItemsProcessed(state.iterations() * kSize * kSize);
}
BENCHMARK(bm_depth_vote);

}  // namespace
}  // namespace relume
