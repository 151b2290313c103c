#include "techniques/directional_quadtree/directional_quadtree_pass.h"

#include "core/stream_io.h"

namespace relume {

SettingList describe(DirectionalQuadtreeSettings& s) {
  return {
      {"bits", choice(s.bits, {"32", "64", "96", "128"}), "Size of a region's quadtree: more bits, finer directions"},
      {"bsdf-fraction",
       &s.bsdf_fraction,
       "Share of directions that follow the material instead of the quadtree",
       {.min = 0.01, .max = 1}},
      {"migrations", &s.migrations, "Leaves that a quadtree may move in a frame", {.min = 1, .max = 32}},
      {"stability",
       &s.stability,
       "A leaf is split if this share of it exceeds what gives way to it",
       {.min = 0.001, .max = 1}},
      {"sampling", choice(s.sampling, {"bottom-up", "stratified"}),
       "How directions are drawn: a leaf first, or from the root down so that well spread numbers stay spread"},
      {"view",
       &s.view,
       "Show in the buffer \"directions\" what guiding knows of one point, beside the light that comes in there",
       {.resets_history = false}},
      {"view-x",
       &s.view_x,
       "That point, as a share of the picture's width",
       {.min = 0, .max = 1, .resets_history = false}},
      {"view-y", &s.view_y, "The same of its height", {.min = 0, .max = 1, .resets_history = false}},
  };
}

bool DirectionalQuadtreePass::run(const FrameContext& frame) {
  const uint32_t bit_count = 32 * (1 + static_cast<uint32_t>(settings_.bits));
  const uint32_t regions = octree_.tree().leaf_slots();
  std::vector<uint32_t> next(size_t{regions} * (bit_count / 32));
  const QuadtreeArray trees{mutable_view_of(words_), bit_count};
  const QuadtreeArray next_trees{mutable_view_of(next), bit_count};
  const bool same_size = octree_.has_samples() && words_.size() == octree_.previous().leaf_slots() * (bit_count / 32);
  moved_ = 0;
  if (same_size) {
    launch(
        frame.backend, "cdq.adapt",
        AdaptQuadtreesKernel{
            octree_.groups(), trees, {settings_.stability, static_cast<uint32_t>(settings_.migrations)}, {&moved_, 1}},
        octree_.previous().leaf_slots(), 1);
    const std::vector<uint32_t>& previous = octree_.tree().links().previous;
    for (uint32_t i = 0; i < regions; ++i) {
      if (previous[i] != kNoRegion) next_trees.store(i, trees.load(previous[i]));
    }
  } else {
    for (uint32_t i = 0; i < regions; ++i) next_trees.store(i, uniform_quadtree(bit_count));
  }
  words_ = std::move(next);
  directions_.quadtrees = {mutable_view_of(words_), bit_count};
  directions_.bsdf_fraction = settings_.bsdf_fraction;
  directions_.stratified = settings_.sampling == QuadtreeSampling::stratified;
  return true;
}

void DirectionalQuadtreePass::save(std::ostream& out) const { write_vector(out, words_); }
void DirectionalQuadtreePass::load(std::istream& in) { read_vector(in, words_); }

}  // namespace relume
