#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "core/stream_io.h"

namespace relume {
namespace {

TEST(DirectionalQuadtreePass, RejectsCheckpointsWithInvalidTrees) {
  const OctreeSettings octree_settings;
  const OctreePass octree(octree_settings, true, host_memory());
  const DirectionalQuadtreeSettings settings;  // 128 bits
  const auto loads = [&](const std::vector<uint32_t>& words, size_t weights = 0,
                         const std::vector<float>& fractions = {}, size_t moments = 0) {
    std::stringstream file;
    write_vector(file, words);
    write_vector(file, fractions);
    write_value(file, uint8_t{0});  // no snapshot
    write_vector(file, std::vector<QuadtreeWeights>(weights));
    write_vector(file, std::vector<MixtureMoments>(moments));
    DirectionalQuadtreePass pass(settings, octree, host_memory());
    pass.load(file);
    return static_cast<bool>(file);
  };
  std::vector<uint32_t> words(8);
  const QuadtreeArray trees{mutable_view_of(words), 128};
  trees.store(0, uniform_quadtree(128));
  trees.store(1, uniform_quadtree(128));
  EXPECT_TRUE(loads(words));
  EXPECT_FALSE(loads({words.begin(), words.end() - 1}));
  EXPECT_TRUE(loads(words, 2));  // with the weights of both
  EXPECT_FALSE(loads(words, 1));
  EXPECT_TRUE(loads(words, 0, {0.5f, 1}, 2));
  EXPECT_FALSE(loads(words, 0, {0.5f, 1}, 1));
  EXPECT_FALSE(loads(words, 0, {0.5f}));
  EXPECT_FALSE(loads(words, 0, {0.5f, 0}));
  EXPECT_FALSE(loads(std::vector<uint32_t>(8, 0xffffffffu)));
  words[5] = 0xffffffffu;  // in the second tree
  EXPECT_FALSE(loads(words));
}

}  // namespace
}  // namespace relume
