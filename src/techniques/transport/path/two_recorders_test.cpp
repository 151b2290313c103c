// Tests paths that record both samples of the octree and states of Markov chains.
#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "techniques/transport/path/chain_output.h"
#include "techniques/transport/path/first_scatter.h"
#include "techniques/transport/path/indirect_sample.h"
#include "techniques/transport/path/optional_output.h"
#include "techniques/transport/path/recording_output.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 32;
constexpr uint32_t kPixels = kSize * kSize;
constexpr uint32_t kVertices = 3;
constexpr uint32_t kNodes[1] = {0xffu};  // eight leaves

/// The bits of all elements, whose members are numbers of four bytes or pairs of smaller ones.
template <typename T>
std::vector<uint32_t> words_of(const std::vector<T>& elements) {
  using Words = std::array<uint32_t, sizeof(T) / sizeof(uint32_t)>;
  std::vector<uint32_t> words;
  for (const T& element : elements) {
    const auto of_element = std::bit_cast<Words>(element);
    words.insert(words.end(), of_element.begin(), of_element.end());
  }
  return words;
}

template <typename ChainState>
int64_t count_states(const std::vector<MarkovRecord<ChainState>>& records) {
  return std::count_if(records.begin(), records.end(),
                       [](const MarkovRecord<ChainState>& record) { return record.cells[0].slot != kNoSlot; });
}

/// Everything that paths may record.
struct Records {
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels);
  std::vector<VertexSample> samples = std::vector<VertexSample>(size_t{kVertices} * kPixels);
  std::vector<MarkovRecord<GuideState>> directions = std::vector<MarkovRecord<GuideState>>(size_t{kVertices} * kPixels);
  std::vector<MarkovRecord<LightState>> lights = std::vector<MarkovRecord<LightState>>(size_t{kVertices} * kPixels);
  std::vector<FirstScatter> scatters = std::vector<FirstScatter>(kPixels);
  std::vector<FirstVertex> vertices = std::vector<FirstVertex>(kPixels);
  std::vector<Rgb> specular = std::vector<Rgb>(kPixels);
  std::vector<IndirectSample> indirect = std::vector<IndirectSample>(kPixels);

  RadianceOutput radiance_output() { return {mutable_view_of(radiance)}; }
  PathRecording recording() {
    const OctreeView octree{{kNodes, 1}, Vec3(-1, 0, -1), static_cast<float>(1u << kMaxOctreeDepth) / 2};
    return {.octree = octree,
            .lookup = {.tree = octree},
            .samples = mutable_view_of(samples),
            .vertices = kVertices,
            .pixels = kPixels};
  }
  /// `grid`: of empty tables, in which every chain is new.
  ChainOutput chain_output(const MarkovGrid& grid) {
    ChainOutput output;
    output.guide.guide.grid = output.lights.chains.grid = grid;
    output.guide.out = {mutable_view_of(directions), kVertices, kPixels};
    output.lights.out = {mutable_view_of(lights), kVertices, kPixels};
    return output;
  }
  FirstScatterOutput scatter_output() { return {mutable_view_of(scatters)}; }
  FirstVertexOutput vertex_output() { return {mutable_view_of(vertices)}; }
  SpecularOutput specular_output() { return {mutable_view_of(specular)}; }
  IndirectSampleOutput indirect_output() { return {mutable_view_of(indirect)}; }
};

template <typename Output>
OptionalOutput<Output> active(const Output& output) {
  return {output, true};
}

class TwoRecorders : public ::testing::TestWithParam<uint32_t> {
 protected:
  template <typename... Outputs>
  void trace(const Outputs&... outputs) const {
    testing::trace_pixels(scene_, {.width = kSize, .height = kSize, .tile_size = GetParam(), .max_bounces = 4},
                          outputs...);
  }
  /// Of paths that record both, with the other outputs of reservoirs, histories and denoisers.
  Records both_with_other_outputs() const {
    Records r;
    trace(r.radiance_output(), RecordingOutput{r.recording()}, r.chain_output(grid_), active(r.scatter_output()),
          active(r.vertex_output()), active(r.specular_output()));
    return r;
  }

  const CompiledScene scene_{find_builtin_scene("cornell-spheres")->build(),
                             CompileOptions{.camera = {}, .width = kSize, .height = kSize}};
  const MarkovGrid grid_ = testing::FilledTable<LightState>().grid;
};

TEST_P(TwoRecorders, RecordWhatEachRecordsAlone) {
  const Records both = both_with_other_outputs();
  Records samples;
  trace(samples.radiance_output(), RecordingOutput{samples.recording()}, samples.scatter_output(),
        samples.vertex_output(), samples.specular_output());
  Records chains;
  trace(chains.radiance_output(), chains.chain_output(grid_));
  EXPECT_EQ(both.radiance, samples.radiance);
  EXPECT_EQ(both.radiance, chains.radiance);
  EXPECT_EQ(words_of(both.samples), words_of(samples.samples));
  EXPECT_EQ(words_of(both.scatters), words_of(samples.scatters));
  EXPECT_EQ(words_of(both.vertices), words_of(samples.vertices));
  EXPECT_EQ(both.specular, samples.specular);
  EXPECT_EQ(words_of(both.directions), words_of(chains.directions));
  EXPECT_EQ(words_of(both.lights), words_of(chains.lights));
  EXPECT_GT(std::count_if(both.samples.begin(), both.samples.end(), [](const auto& s) { return s.value > 0.0f; }),
            int64_t{kPixels} / 4);
  EXPECT_GT(count_states(both.directions), int64_t{kPixels} / 4);
  EXPECT_GT(count_states(both.lights), int64_t{kPixels} / 4);
}

TEST_P(TwoRecorders, LackInactiveOutputs) {
  const Records expected = both_with_other_outputs();
  Records both;
  trace(both.radiance_output(), RecordingOutput{both.recording()}, both.chain_output(grid_),
        OptionalOutput<FirstScatterOutput>{}, OptionalOutput<FirstVertexOutput>{}, OptionalOutput<SpecularOutput>{});
  EXPECT_EQ(both.radiance, expected.radiance);
  EXPECT_EQ(words_of(both.samples), words_of(expected.samples));
  EXPECT_EQ(words_of(both.directions), words_of(expected.directions));
  EXPECT_EQ(words_of(both.lights), words_of(expected.lights));
}

/// Reservoirs of indirect light change the units of paths, of which both recorders must learn.
TEST_P(TwoRecorders, RecordWhatEachRecordsAloneBesideIndirectSamples) {
  Records both;
  trace(both.radiance_output(), CachedRecordingOutput{both.recording()}, both.chain_output(grid_),
        OptionalOutput<FirstScatterOutput>{}, both.indirect_output(), active(both.vertex_output()),
        active(both.specular_output()));
  Records samples;
  trace(samples.radiance_output(), CachedRecordingOutput{samples.recording()}, samples.indirect_output(),
        samples.specular_output());
  Records chains;
  trace(chains.radiance_output(), chains.chain_output(grid_), chains.indirect_output());
  Records vertices;
  trace(vertices.radiance_output(), OptionalOutput<FirstScatterOutput>{}, vertices.indirect_output(),
        vertices.vertex_output(), OptionalOutput<SpecularOutput>{});
  EXPECT_EQ(both.radiance, samples.radiance);
  EXPECT_EQ(both.radiance, chains.radiance);
  EXPECT_EQ(both.specular, samples.specular);
  EXPECT_EQ(both.radiance, vertices.radiance);
  EXPECT_EQ(words_of(both.indirect), words_of(samples.indirect));
  EXPECT_EQ(words_of(both.indirect), words_of(vertices.indirect));
  EXPECT_EQ(words_of(both.vertices), words_of(vertices.vertices));
  EXPECT_EQ(words_of(both.samples), words_of(samples.samples));
  EXPECT_EQ(words_of(both.directions), words_of(chains.directions));
  EXPECT_EQ(words_of(both.lights), words_of(chains.lights));
  EXPECT_GT(count_states(both.directions), int64_t{kPixels} / 4);
}

INSTANTIATE_TEST_SUITE_P(Forms, TwoRecorders, ::testing::Values(0u, kTileSize));

}  // namespace
}  // namespace relume
