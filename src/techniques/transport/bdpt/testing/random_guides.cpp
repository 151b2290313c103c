#include "techniques/transport/bdpt/testing/random_guides.h"

#include "core/hash.h"
#include "scene/world_triangles.h"
#include "techniques/guiding/directional_quadtree/testing/random_tree.h"

namespace relume::testing {
namespace {

constexpr uint32_t kBits = 128;

/// An octree of 64 regions over the scene.
OctreeTree make_tree(Backend& backend, const SceneView& scene) {
  const Box box = world_box(scene);
  const OctreeTree root(box.center(), 1.001f * max_component(box.extent()));
  const std::vector<uint32_t> counts(root.leaf_slots(), 1000);
  return root.adapted(backend, view_of(counts), {.collapse = 50, .split = 100, .max_depth = 8});
}

}  // namespace

RandomGuides::RandomGuides(Backend& backend, const SceneView& scene)
    : tree_(make_tree(backend, scene)), words_(tree_.leaf_slots() * (kBits / 32)), importance_(words_.size()) {
  constexpr uint32_t kOtherShapes = 1000;
  const QuadtreeArray trees{mutable_view_of(words_), kBits};
  const QuadtreeArray of_importance{mutable_view_of(importance_), kBits};
  for (uint32_t region = 0; region < tree_.leaf_slots(); ++region) {
    trees.store(region, random_tree(kBits, region));
    // A third of the regions has learned nothing.
    of_importance.store(region, region % 3 == 0 ? uniform_quadtree(kBits) : random_tree(kBits, kOtherShapes + region));
    fractions_.push_back(0.2f + 0.6f * to_unit_float(hash(region)));
  }
}

void RandomGuides::guide(LearningContext& c, float jitter) {
  DirectionSampler& directions = c.path.directions;
  directions.kind = DirectionSamplerKind::quadtree;
  directions.quadtrees = {mutable_view_of(words_), kBits};
  directions.fractions = view_of(fractions_);
  c.recording.octree = c.recording.lookup.tree = tree_.view();
  c.recording.lookup.jitter = jitter;
}

void RandomGuides::guide_light_subpaths(LearningContext& c) {
  c.path.directions.importance = mutable_view_of(importance_);
  c.path.directions.bsdf_fraction = 0.35f;
}

}  // namespace relume::testing
