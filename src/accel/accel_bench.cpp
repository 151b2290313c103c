// Time of single-ray queries by structure and kind of ray, and times to build and refit.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "accel/testing/scene_rays.h"
#include "builtin_scenes/builtin.h"
#include "relume/scene_io.h"

namespace relume {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 180;

/// Sponza, if RELUME_SCENES names a folder with it; the city otherwise.
Scene large_scene() {
  const char* folder = std::getenv("RELUME_SCENES");
  const std::filesystem::path file = std::filesystem::path(folder ? folder : "") / "sponza" / "sponza.gltf";
  std::error_code ignored;
  if (folder && std::filesystem::exists(file, ignored)) return load_scene(file);
  return find_builtin_scene("city")->build();
}

const CompiledScene& compiled(AccelChoice accel) {
  static std::map<AccelChoice, std::unique_ptr<CompiledScene>> scenes;
  std::unique_ptr<CompiledScene>& scene = scenes[accel];
  if (!scene) {
    scene = std::make_unique<CompiledScene>(large_scene(),
                                            CompileOptions{.width = kWidth, .height = kHeight, .accel = accel});
  }
  return *scene;
}

const testing::SceneRays& rays() {
  static const testing::SceneRays all = testing::scene_rays(compiled(AccelChoice::embree), kWidth, kHeight, 1);
  return all;
}

enum class Kind { primary, diffuse, shadow };

void bm_rays(benchmark::State& state, AccelChoice choice, Kind kind) {
  const AccelView& accel = compiled(choice).view().accel;
  const std::vector<Ray>& list = kind == Kind::primary   ? rays().primary
                                 : kind == Kind::diffuse ? rays().diffuse
                                                         : rays().shadow;
  const AccelView& embree = compiled(AccelChoice::embree).view().accel;
  size_t different = 0;
  for (const Ray& ray : list) different += occluded(accel, ray, 0) != occluded(embree, ray, 0);
  if (different > list.size() / 10000) state.SkipWithError("the structures disagree");
  size_t i = 0;
  for (auto _ : state) {
    const Ray& ray = list[i];
    if (kind == Kind::shadow) {
      benchmark::DoNotOptimize(occluded(accel, ray, 0));
    } else {
      benchmark::DoNotOptimize(intersect(accel, ray, 0));
    }
    i = i + 1 < list.size() ? i + 1 : 0;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(bm_rays, embree_primary, AccelChoice::embree, Kind::primary);
BENCHMARK_CAPTURE(bm_rays, bvh_primary, AccelChoice::bvh, Kind::primary);
BENCHMARK_CAPTURE(bm_rays, embree_diffuse, AccelChoice::embree, Kind::diffuse);
BENCHMARK_CAPTURE(bm_rays, bvh_diffuse, AccelChoice::bvh, Kind::diffuse);
BENCHMARK_CAPTURE(bm_rays, embree_shadow, AccelChoice::embree, Kind::shadow);
BENCHMARK_CAPTURE(bm_rays, bvh_shadow, AccelChoice::bvh, Kind::shadow);

/// A wavy sheet of 2 · edge² triangles, for building and refitting.
struct Sheet {
  explicit Sheet(uint32_t edge) : edge_(edge) {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < edge * edge; ++i) {
      const uint32_t corner = i / edge * (edge + 1) + i % edge;
      for (const uint32_t offset : {0u, 1u, edge + 2, 0u, edge + 2, edge + 1}) indices.push_back(corner + offset);
    }
    soup.add_mesh(std::vector<Vec3>((edge + 1) * (edge + 1)), std::move(indices));
    soup.add_instance(0);
    shape(0);
  }
  void shape(float phase) {
    std::vector<Vec3>& vertices = soup.vertices(0);
    for (uint32_t i = 0; i < (edge_ + 1) * (edge_ + 1); ++i) {
      const auto x = static_cast<float>(i % (edge_ + 1));
      const auto y = static_cast<float>(i / (edge_ + 1));
      vertices[i] = {x, y, 5 * std::sin(0.1f * x + phase) * std::cos(0.07f * y)};
    }
  }
  testing::Soup soup;
  uint32_t edge_;
};

void bm_build(benchmark::State& state, AccelChoice choice) {
  const Sheet sheet(360);
  for (auto _ : state) benchmark::DoNotOptimize(make_accel(choice, sheet.soup.meshes, sheet.soup.instances, {}));
  state.SetItemsProcessed(state.iterations() * 2 * 360 * 360);
}
BENCHMARK_CAPTURE(bm_build, embree, AccelChoice::embree)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(bm_build, bvh, AccelChoice::bvh)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Refits a mesh of 30,000 vertices.
void bm_refit(benchmark::State& state, AccelChoice choice) {
  Sheet sheet(172);
  sheet.soup.meshes[0].deforms = true;
  const std::unique_ptr<AccelStructure> accel = make_accel(choice, sheet.soup.meshes, sheet.soup.instances, {});
  const uint32_t deformed = 0;
  float phase = 0;
  for (auto _ : state) {
    state.PauseTiming();
    sheet.shape(phase += 0.01f);
    state.ResumeTiming();
    accel->update(sheet.soup.instances, {&deformed, 1});
  }
}
BENCHMARK_CAPTURE(bm_refit, embree, AccelChoice::embree)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(bm_refit, bvh, AccelChoice::bvh)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace relume
