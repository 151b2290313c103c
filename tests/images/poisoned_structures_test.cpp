// Tests that images keep their mean with random content in learned structures. Frames use consecutive elements of one
// sequence, as in an epoch.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "scene/world_triangles.h"
#include "support/image_test.h"
#include "techniques/gbuffer/primary_hits/primary_hits.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"
#include "techniques/light_sampling/adaptive_tiles/adaptive_tiles.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"
#include "techniques/radiance_cache/path_graphs/path_graphs.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/reuse/restir_pt/testing/add_candidates.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/transport/bdpt/bdpt.h"
#include "techniques/transport/path/recording_output.h"
#include "testing/random.h"

namespace relume::support {
namespace {

constexpr uint32_t kWidth = 24;
constexpr uint32_t kHeight = 16;
constexpr uint32_t kPixels = kWidth * kHeight;
constexpr uint32_t kBits = 128;

/// Number of images and frames of each. The detectable errors are those of ImageTestOptions.
struct Effort {
  uint32_t images;
  uint32_t frames;
  ImageTestOptions options;
};
const Effort kQuick{16, 8, {.detectable = 0.25, .detectable_mean = 0.2}};     // seconds
const Effort kSharp{64, 128, {.detectable = 0.04, .detectable_mean = 0.03}};  // minutes; 64 times the samples

/// Paths, those with the policy of a cache, subpaths from both ends, or candidates for reservoirs of paths. Cells stay
/// empty: images show the paths' own estimates.
enum class PathKind { plain, psf, apg, bdpt, light, candidates };

/// An octree over the scene with every leaf split `levels` times.
OctreeTree split_tree(Backend& backend, const SceneView& scene, int levels) {
  const Box box = world_box(scene);
  OctreeTree tree(box.center(), 1.001f * max_component(box.extent()));
  for (int i = 0; i < levels; ++i) {
    const std::vector<uint32_t> counts(tree.leaf_slots(), 1000);
    tree = tree.adapted(backend, view_of(counts), {50, 100, 8});
  }
  return tree;
}

/// Quadtrees after migrations between random nodes.
Quadtrees random_quadtrees(uint32_t regions, testing::Random& random) {
  Quadtrees trees(kBits, regions);
  for (uint32_t region = 0; region < regions; ++region) {
    DirectionalQuadtree tree = uniform_quadtree(kBits);
    for (int i = 0; i < 16; ++i) {
      QuadtreeWeights weights{};
      for (uint32_t bit = 0; bit < kBits; ++bit) weights.add(bit, random.next());
      const MigrationChoice choice = choose_migration(tree, weights, {.stability = 1e6f});
      if (choice.found) migrate(tree, weights, choice.inner, choice.leaf, 0.25f);
    }
    trees.view().store(region, tree);
  }
  return trees;
}

/// A scene, and structures independent of it.
class Poisoned {
 public:
  explicit Poisoned(const char* scene)
      : scene_(find_builtin_scene(scene)->build(), CompileOptions{.width = kWidth, .height = kHeight}),
        tree_(split_tree(backend_, scene_.view(), 3)),
        quadtrees_(random_quadtrees(tree_.leaf_slots(), random_)) {
    build_caches();
  }

  PathContext plain() const {
    PathContext context;
    context.scene = scene_.view();
    context.selector.kind = LightSelectorKind::uniform;
    context.selector.uniform = uniform_;
    return context;
  }
  PathContext guided() {
    PathContext context = plain();
    context.directions.kind = DirectionSamplerKind::quadtree;
    context.directions.quadtrees = quadtrees_.view();
    return context;
  }
  /// With a random fraction of directions from the BSDF in each region.
  PathContext guided_by_fractions() {
    for (uint32_t region = 0; region < tree_.leaf_slots(); ++region) fractions_.push_back(0.1f + 0.8f * random_.next());
    PathContext context = guided();
    context.directions.fractions = view_of(fractions_);
    return context;
  }
  /// The same with other quadtrees for light subpaths.
  PathContext guided_from_both_ends() {
    testing::Random random(6);
    importance_ = random_quadtrees(tree_.leaf_slots(), random);
    PathContext context = guided_by_fractions();
    context.directions.importance = importance_.view().words;
    return context;
  }
  PathContext cached() const {
    PathContext context = plain();
    context.selector.kind = LightSelectorKind::cache;
    context.selector.cache = cache_;
    return context;
  }
  /// With random lists, of which some hold lights that do not exist, and random proxies of all lights. Their number
  /// differs by at most a factor of four: rarer samples would hide errors.
  PathContext tiled() {
    const uint32_t lights = scene_.view().lights.lights.size;
    proxies_.assign(1, 0);
    for (uint32_t i = 0; i < lights; ++i)
      proxies_.push_back(proxies_.back() + (uniform_.pmf(i) > 0 ? 4 + below(13) : 0));
    TileGrid grid;
    grid.camera = scene_.view().camera;
    grid.tile_size = 5;
    grid.list_size = 6;
    grid.offset = {2, 3};
    grid.columns = (kWidth + 4) / 5 + 1;
    grid.rows = (kHeight + 4) / 5 + 1;
    for (uint32_t tile = 0; tile < grid.count(); ++tile) {
      for (uint32_t i = 0; i < grid.list_size; ++i) tile_lights_.push_back(below(lights + lights / 8 + 1));
      std::sort(tile_lights_.end() - grid.list_size, tile_lights_.end());
      depths_.push_back({0.1f + 10 * random_.next(), 5 + 20 * random_.next()});
    }
    PathContext context = plain();
    context.selector.kind = LightSelectorKind::adaptive_tiles;
    context.selector.tiles = {{grid, 1.2f, view_of(tile_lights_), view_of(depths_)}, {view_of(proxies_)}, 0.65f};
    return context;
  }

  /// Images of several seeds, each the mean of one epoch's frames.
  Moments images(const PathContext& context, const Effort& effort, uint32_t first_seed,
                 PathKind kind = PathKind::plain) {
    std::vector<Image> images;
    for (uint32_t i = 0; i < effort.images; ++i) {
      Image mean(kWidth, kHeight);
      for (uint32_t frame = 0; frame < effort.frames; ++frame) {
        const std::vector<Rgb> radiance = trace(context, {.seed = first_seed + i, .sample = frame, .age = frame}, kind);
        for (uint32_t p = 0; p < kPixels; ++p) mean.pixels[p] += radiance[p] / static_cast<float>(effort.frames);
      }
      images.push_back(std::move(mean));
    }
    return moments_of(std::move(images));
  }

 private:
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(random_.next() * static_cast<float>(count)); }

  void build_caches() {
    const LightsView& lights = scene_.view().lights;
    const std::vector<LightSummary> summaries = light_summaries(lights);
    // Each region has random light samples.
    SampleStream stream;
    stream.resize(backend_, tree_.leaf_slots(), 1);
    for (uint32_t region = 0; region < tree_.leaf_slots(); ++region) {
      const auto light = static_cast<uint32_t>(random_.next() * 1.5f * static_cast<float>(lights.first_infinite));
      const bool seen = light < lights.first_infinite;
      stream.samples()[region] = {.region = region, .light = seen ? light | kVisibleLight : kNoLight};
    }
    stream.group(backend_, tree_.leaf_slots());
    CacheBuildOptions options;
    options.bucket_size = 1;
    caches_.build(backend_, tree_, stream.groups(), view_of(summaries), options);
    exploration_.update_digest(backend_, view_of(summaries));
    exploration_.build(backend_, view_of(summaries), lights.bounds.radius, scene_.view().camera.position, {}, 4);
    infinite_ = build_infinite_lights(lights, LightsAtInfinity::worth_sampling);
    compact_ = compact_lights(lights);
    cache_.regions = caches_.buckets();
    cache_.entries = caches_.entries();
    cache_.bucket_weights = caches_.bucket_weights();
    cache_.bucket_size = options.bucket_size;
    cache_.exploration = 0.1f;
    cache_.all = exploration_.grid();
    cache_.infinite = make_infinite_lights(lights, view_of(infinite_), !cache_.all.empty());
    cache_.ltc = ltc_table();
    cache_.compact = view_of(compact_);
    cache_.lights = lights;
    uniform_ = make_uniform_lights(lights);
  }

  std::vector<Rgb> trace(const PathContext& context, const SampleIndex& index, PathKind kind) {
    const PrimaryHitsKernel primary{context.scene, index, mutable_view_of(hits_), {}, kWidth};
    launch(backend_, "gbuffer", primary, kWidth, kHeight);
    std::vector<VertexSample> samples(kPixels);
    PathRecording recording{
        .octree = tree_.view(), .lookup = {.tree = tree_.view()}, .samples = mutable_view_of(samples)};
    recording.vertices = 1;
    recording.pixels = kPixels;
    FilterContext filter;
    filter.grid = grid_.view(context.scene.camera);
    filter.width = kWidth;
    switch (kind) {
      case PathKind::plain: {
        std::vector<Rgb> radiance(kPixels);
        run(context, index, RadianceOutput{mutable_view_of(radiance)}, RecordingOutput{recording});
        return radiance;
      }
      case PathKind::psf: return trace_into_cells(context, index, recording, filter);
      case PathKind::apg: break;
      case PathKind::bdpt: return trace_from_both_ends(context, index, recording, false);
      case PathKind::light: return trace_from_both_ends(context, index, recording, true);
      case PathKind::candidates: return trace_candidates(context, index, recording);
    }
    PathGraphContext graph;
    graph.filter = filter;
    graph.primary.enabled = false;
    return trace_into_cells(context, index, recording, graph);
  }

  template <typename Cache>
  std::vector<Rgb> trace_into_cells(const PathContext& context, const SampleIndex& index,
                                    const PathRecording& recording, const Cache& cache) {
    std::vector<FilteredPixel> pixels(kPixels);
    run(context, index, CachedRecordingOutput{recording}, CellsOutput<Cache>{cache, mutable_view_of(pixels)});
    std::vector<Rgb> radiance;
    for (const FilteredPixel& pixel : pixels) radiance.push_back(pixel.unfiltered + pixel.traced);
    return radiance;
  }

  /// Looks up regions with jitter, which light subpaths repeat.
  std::vector<Rgb> trace_from_both_ends(const PathContext& context, const SampleIndex& index,
                                        const PathRecording& recording, bool light_only) {
    const std::vector<AliasEntry> power = build_power_lights(context.scene.lights);
    std::vector<FixedPointRgb> splats(kPixels);
    LearningContext c;
    c.path = context;
    c.emission = c.connection = {{view_of(power)}};
    c.splats = mutable_view_of(splats);
    c.width = kWidth;
    c.connection_roulette = 0.25f;
    c.light_only = light_only;
    c.recording = recording;
    c.recording.lookup.jitter = 1;
    c.recording.lookup.seed = hash(index.seed, index.sample);
    std::vector<Rgb> radiance(kPixels);
    uint64_t faults[2] = {};
    const BdptKernelOf<LearningContext> kernel{
        c,           index,          view_of(hits_), {}, {mutable_view_of(radiance)}, mutable_view_of(rays_),
        {faults, 1}, {faults + 1, 1}};
    launch(backend_, "trace", kernel, kWidth, kHeight);
    const AddSplatsKernel add{c.splats, mutable_view_of(radiance), {}, 1.0f, kWidth};
    launch(backend_, "splats", add, kWidth, kHeight);
    EXPECT_EQ(faults[1], 0u);
    return radiance;
  }

  std::vector<Rgb> trace_candidates(const PathContext& context, const SampleIndex& index,
                                    const PathRecording& recording) {
    std::vector<Rgb> radiance(kPixels);
    PathContext specular = context;
    specular.only_specular = true;
    run(specular, index, RadianceOutput{mutable_view_of(radiance)});
    testing::add_candidates(context, index, view_of(hits_), recording, kWidth, radiance);
    return radiance;
  }

  template <typename... Outputs>
  void run(const PathContext& context, const SampleIndex& index, const Outputs&... outputs) {
    const PathKernel<Outputs...> kernel{.context = context,
                                        .index = index,
                                        .hits = view_of(hits_),
                                        .allocation = {},
                                        .rays = mutable_view_of(rays_),
                                        .width = kWidth,
                                        .outputs = path_outputs(outputs...)};
    launch(backend_, "trace", kernel, kWidth, kHeight);
  }

  Backend backend_{1};
  testing::Random random_{5};
  CompiledScene scene_;
  OctreeTree tree_;
  Quadtrees quadtrees_;
  std::vector<float> fractions_;
  Quadtrees importance_{kBits};
  LightCaches caches_;
  ExplorationTables exploration_{host_memory()};
  std::vector<uint32_t> proxies_;
  std::vector<LightId> tile_lights_;
  std::vector<TileDepths> depths_;
  std::vector<AliasEntry> infinite_;
  std::vector<CompactLight> compact_;
  VisibilityLightCache cache_;
  UniformLights uniform_;
  HashGrid grid_{PathSpaceFilterSettings{}.grid, 1 << 14};
  std::vector<Hit> hits_ = std::vector<Hit>(kPixels);
  std::vector<uint32_t> rays_ = std::vector<uint32_t>(kPixels);
};

void check_quadtrees(const std::string& name, const Effort& effort) {
  Poisoned poisoned("cornell");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  expect_same_image(name, poisoned.images(poisoned.guided(), effort, 1), expected, effort.options);
}

void check_fractions(const std::string& name, const Effort& effort) {
  Poisoned poisoned("cornell");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  expect_same_image(name, poisoned.images(poisoned.guided_by_fractions(), effort, 1), expected, effort.options);
}

void check_caches(const std::string& name, const Effort& effort) {
  Poisoned poisoned("turntable");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  expect_same_image(name, poisoned.images(poisoned.cached(), effort, 1), expected, effort.options);
}

void check_tiles(const std::string& name, const Effort& effort) {
  Poisoned poisoned("turntable");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  expect_same_image(name, poisoned.images(poisoned.tiled(), effort, 1), expected, effort.options);
}

void check_filtered_paths(const std::string& name, const Effort& effort) {
  Poisoned poisoned("cornell");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  expect_same_image(name, poisoned.images(poisoned.guided_by_fractions(), effort, 1, PathKind::psf), expected,
                    effort.options);
}

void check_path_graphs(const std::string& name, const Effort& effort) {
  Poisoned poisoned("turntable");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  expect_same_image(name, poisoned.images(poisoned.cached(), effort, 1, PathKind::apg), expected, effort.options);
}

void check_both_ends(const std::string& name, const Effort& effort) {
  Poisoned boxes("cornell");
  const Moments expected = boxes.images(boxes.plain(), effort, 1001);
  expect_same_image(name + "-quadtrees", boxes.images(boxes.guided_by_fractions(), effort, 1, PathKind::bdpt), expected,
                    effort.options);
  Poisoned table("turntable");
  const Moments expected_table = table.images(table.plain(), effort, 1001);
  expect_same_image(name + "-caches", table.images(table.cached(), effort, 1, PathKind::bdpt), expected_table,
                    effort.options);
}

void check_importance(const std::string& name, const Effort& effort) {
  Poisoned poisoned("cornell");
  const Moments expected = poisoned.images(poisoned.plain(), effort, 1001);
  const PathContext guided = poisoned.guided_from_both_ends();
  expect_same_image(name + "-bdpt", poisoned.images(guided, effort, 1, PathKind::bdpt), expected, effort.options);
  expect_same_image(name + "-light", poisoned.images(guided, effort, 1, PathKind::light), expected, effort.options);
}

void check_candidates(const std::string& name, const Effort& effort) {
  Poisoned boxes("cornell");
  const Moments expected = boxes.images(boxes.plain(), effort, 1001);
  expect_same_image(name + "-fractions", boxes.images(boxes.guided_by_fractions(), effort, 1, PathKind::candidates),
                    expected, effort.options);
  Poisoned table("turntable");
  const Moments expected_table = table.images(table.plain(), effort, 1001);
  expect_same_image(name + "-caches", table.images(table.cached(), effort, 1, PathKind::candidates), expected_table,
                    effort.options);
  expect_same_image(name + "-tiles", table.images(table.tiled(), effort, 1, PathKind::candidates), expected_table,
                    effort.options);
}

TEST(PoisonedStructures, QuadtreesKeepTheMean) { check_quadtrees("poisoned-quadtrees", kQuick); }
TEST(PoisonedStructures, FractionsKeepTheMean) { check_fractions("poisoned-fractions", kQuick); }
TEST(PoisonedStructures, LightCachesKeepTheMean) { check_caches("poisoned-caches", kQuick); }
TEST(PoisonedStructures, TilesKeepTheMean) { check_tiles("poisoned-tiles", kQuick); }
TEST(PoisonedStructures, FilteredPathsKeepTheMean) { check_filtered_paths("poisoned-psf", kQuick); }
TEST(PoisonedStructures, PathGraphsKeepTheMean) { check_path_graphs("poisoned-apg", kQuick); }
TEST(PoisonedStructures, BidirectionalPathsKeepTheMean) { check_both_ends("poisoned-bdpt", kQuick); }
TEST(PoisonedStructures, GuidedLightSubpathsKeepTheMean) { check_importance("poisoned-importance", kQuick); }
TEST(PoisonedStructures, CandidatesOfReservoirsKeepTheMean) { check_candidates("poisoned-candidates", kQuick); }

TEST(SlowPoisonedStructures, QuadtreesKeepTheMean) { check_quadtrees("poisoned-quadtrees-sharp", kSharp); }
TEST(SlowPoisonedStructures, FractionsKeepTheMean) { check_fractions("poisoned-fractions-sharp", kSharp); }
TEST(SlowPoisonedStructures, LightCachesKeepTheMean) { check_caches("poisoned-caches-sharp", kSharp); }
TEST(SlowPoisonedStructures, TilesKeepTheMean) { check_tiles("poisoned-tiles-sharp", kSharp); }
TEST(SlowPoisonedStructures, FilteredPathsKeepTheMean) { check_filtered_paths("poisoned-psf-sharp", kSharp); }
TEST(SlowPoisonedStructures, PathGraphsKeepTheMean) { check_path_graphs("poisoned-apg-sharp", kSharp); }
TEST(SlowPoisonedStructures, BidirectionalPathsKeepTheMean) { check_both_ends("poisoned-bdpt-sharp", kSharp); }
TEST(SlowPoisonedStructures, CandidatesOfReservoirsKeepTheMean) {
  check_candidates("poisoned-candidates-sharp", kSharp);
}
TEST(SlowPoisonedStructures, GuidedLightSubpathsKeepTheMean) { check_importance("poisoned-importance-sharp", kSharp); }

}  // namespace
}  // namespace relume::support
