#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"

#include <utility>

#include "frame/primitives/fill.h"

namespace relume {

bool is_quadtree(const DirectionalQuadtree& tree) {
  const uint32_t groups = tree.bit_count / 4;
  if (tree.bits.rank(tree.bit_count) != groups - 1) return false;
  uint32_t depths[BitField::kWords * 8] = {1};
  uint32_t next = 1;  // group of the next inner node's children
  for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
    if (!tree.bits.get(bit)) continue;
    // Parents must precede their children, or walking up would not end.
    if (bit / 4 >= next || depths[bit / 4] >= kMaxQuadtreeDepth) return false;
    depths[next++] = depths[bit / 4] + 1;
  }
  return true;
}

Quadtrees Quadtrees::copy(Backend& backend) const {
  Quadtrees result(bit_count_, 0, memory());
  relume::copy(backend, "cdq.copy", words_, result.words_);
  relume::copy(backend, "cdq.copy", fractions_, result.fractions_);
  return result;
}

void Quadtrees::load(std::istream& in) {
  read_array(in, words_);
  read_array(in, fractions_);
  const QuadtreeArray trees = write();
  bool valid = words_.size() % trees.words_per_tree() == 0 && (fractions_.empty() || fractions_.size() == size());
  for (const float fraction : fractions_.read()) valid = valid && fraction > 0.0f && fraction <= 1.0f;
  for (uint32_t i = 0; valid && i < trees.tree_count(); ++i) valid = is_quadtree(trees.load(i));
  if (valid) return;
  words_.clear();
  fractions_.clear();
  in.setstate(std::ios::failbit);
}

namespace {

/// Factor of earlier sums per frame. Together, all earlier frames then have the weight of `frames` frames.
float kept_share(int frames) { return static_cast<float>(frames) / static_cast<float>(frames + 1); }

}  // namespace

bool DirectionalQuadtreePass::run(const FrameContext& frame) {
  const bool fits = trees_.bit_count() == bit_count() && trees_.size() == octree_.tree().leaf_slots();
  if (generation_ == octree_.generation() && fits) {
    snapshot_.begin_frame(frame.backend, frame.begins_epoch, trees_);
  } else {
    take_in_samples(frame);
  }
  Quadtrees& sampled = snapshot_.of(trees_);
  directions_.quadtrees = sampled.view();
  directions_.fractions = settings_.learn_fraction ? sampled.fractions() : View<const float>{};
  directions_.bsdf_fraction = settings_.bsdf_fraction;
  directions_.candidates = static_cast<uint32_t>(settings_.candidates);
  directions_.stratified = settings_.sampling == QuadtreeSampling::stratified;
  return true;
}

void DirectionalQuadtreePass::take_in_samples(const FrameContext& frame) {
  const bool same_size =
      octree_.has_samples() && trees_.bit_count() == bit_count() && trees_.size() == octree_.previous().leaf_slots();
  // The frames of an epoch sample the same trees, so they have the same weight.
  const bool remembers = settings_.memory > 0 || !frame.begins_epoch;
  next_trees_.reset(bit_count(), octree_.tree().leaf_slots(), settings_.learn_fraction);
  if (settings_.learn_fraction) {
    moments_.reserve(trees_.size());
    next_moments_.reset(octree_.tree().leaf_slots(), kUninitialized);
  }
  if (remembers) {
    weights_.reserve(trees_.size());
    successors_.reset(trees_.size(), kUninitialized);
    next_weights_.reset(octree_.tree().leaf_slots(), kUninitialized);
  }
  // Whether the samples were drawn from other trees than those that they adapt.
  const bool sampled_others = snapshot_.frozen();
  moved_.write() = 0;  // may throw, so that a repeated frame must find the snapshot unchanged
  snapshot_.begin_frame(frame.backend, frame.begins_epoch, trees_);
  // Nothing allocates from here on.
  if (same_size) {
    const float kept = sampled_others ? 1.0f : kept_share(settings_.memory);
    const QuadtreeAdaption options{settings_.stability, static_cast<uint32_t>(settings_.migrations), kept,
                                   settings_.spread};
    if (remembers && weights_.size() != trees_.size()) resize(frame.backend, "cdq.adapt", weights_, trees_.size());
    const AdaptQuadtreesKernel adapt{octree_.groups(),
                                     trees_.view(),
                                     options,
                                     sampled_others ? 1.0f - settings_.bsdf_fraction : 0.0f,
                                     weights_.mutable_view(),
                                     moved_.mutable_view(),
                                     settings_.learn_fraction ? trees_.fractions() : View<const float>{},
                                     {octree_.previous().links().neighbours.view(),
                                      static_cast<uint32_t>(settings_.pool), 1.0f - settings_.bsdf_fraction}};
    frame.launch("cdq.adapt", adapt, {octree_.previous().leaf_slots(), 1, 1});
    if (settings_.learn_fraction) {
      if (moments_.size() != trees_.size()) resize(frame.backend, "cdq.fractions", moments_, trees_.size());
      const LearnFractionsKernel learn{octree_.groups(), moments_.mutable_view()};
      frame.launch("cdq.fractions", learn, {octree_.previous().leaf_slots(), MixtureMoments::kFractions});
    }
  }
  populate(frame, same_size, remembers);
  generation_ = octree_.generation();
}

void DirectionalQuadtreePass::populate(const FrameContext& frame, bool keep, bool remembers) {
  const Grid regions{octree_.tree().leaf_slots(), 1};
  const View<const uint32_t> previous = octree_.tree().links().previous.view();
  const PopulateQuadtreesKernel kernel{previous, keep ? trees_.view() : QuadtreeArray{}, next_trees_.view()};
  frame.launch("cdq.populate", kernel, regions);
  populate_fractions(frame, keep);
  if (!remembers || !keep) weights_.clear();
  if (!remembers) return std::swap(trees_, next_trees_);
  successors_.reset(weights_.size(), kUninitialized);
  if (!weights_.empty()) {
    fill(frame.backend, "cdq.populate", successors_.mutable_view(), 0u);
    frame.launch("cdq.populate", CountSuccessorsKernel{previous, successors_.mutable_view()}, regions);
  }
  const InheritWeightsKernel inherit{previous, successors_.view(), weights_.view(), next_weights_.mutable_view()};
  frame.launch("cdq.populate", inherit, regions);
  std::swap(trees_, next_trees_);
  weights_.swap(next_weights_);
}

void DirectionalQuadtreePass::populate_fractions(const FrameContext& frame, bool keep) {
  if (!keep || !settings_.learn_fraction) moments_.clear();
  if (!settings_.learn_fraction) return;
  const InheritFractionsKernel kernel{octree_.tree().links().previous.view(),
                                      moments_.view(),
                                      {.fraction = settings_.bsdf_fraction},
                                      next_moments_.mutable_view(),
                                      next_trees_.mutable_fractions()};
  frame.launch("cdq.populate", kernel, {octree_.tree().leaf_slots(), 1});
  moments_.swap(next_moments_);
}

std::vector<PassRecords> DirectionalQuadtreePass::records() const {
  struct Leaf {
    uint32_t region = 0;
    Vec2 corner{0};
    float edge = 0;
  };
  const auto read = [this] {
    std::vector<Leaf> leaves;
    Quadtrees copy = trees_;  // write() needs a mutable object
    const QuadtreeArray trees = copy.write();
    for (uint32_t region = 0; region < copy.size(); ++region) {
      if (!octree_.tree().is_leaf(region)) continue;
      const DirectionalQuadtree tree = trees.load(region);
      for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
        if (tree.bits.get(bit)) continue;
        const QuadtreeCell cell = tree.cell_of(bit);
        leaves.push_back({region, cell.corner, cell.edge()});
      }
    }
    return leaves;
  };
  return {pass_records<Leaf>(
      "leaves",
      "a leaf of a region's quadtree: low corner and edge in the unit square of the octahedral map; all leaves of a "
      "tree have the same probability",
      {record_field("region", &Leaf::region), record_field("corner", &Leaf::corner), record_field("edge", &Leaf::edge)},
      read)};
}

void DirectionalQuadtreePass::save(std::ostream& out) const {
  trees_.save(out);
  snapshot_.save(out);
  write_array(out, weights_);
  write_array(out, moments_);
}

void DirectionalQuadtreePass::load(std::istream& in) {
  Memory& memory = trees_.memory();
  trees_ = Quadtrees(bit_count(), 0, memory);
  trees_.load(in);
  snapshot_.load(in, Quadtrees(bit_count(), 0, memory));
  read_array(in, weights_);
  read_array(in, moments_);
  generation_ = octree_.generation();
  const bool fits =
      (weights_.empty() || weights_.size() == trees_.size()) && (moments_.empty() || moments_.size() == trees_.size());
  if (in && fits) return;
  trees_ = Quadtrees(bit_count(), 0, memory);
  snapshot_.reset();
  weights_.clear();
  moments_.clear();
  in.setstate(std::ios::failbit);
}

}  // namespace relume
