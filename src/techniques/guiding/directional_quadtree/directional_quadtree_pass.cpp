#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"

#include "core/stream_io.h"
#include "frame/primitives/fill.h"

namespace relume {
namespace {

/// Factor of earlier sums per frame. Together, all earlier frames then have the weight of `frames` frames.
float kept_share(int frames) { return static_cast<float>(frames) / static_cast<float>(frames + 1); }

}  // namespace

bool DirectionalQuadtreePass::run(const FrameContext& frame) {
  const uint32_t regions = octree_.tree().leaf_slots();
  const bool learns_importance = octree_.records_importance();
  const bool fit = radiance_.fit(bit_count(), regions) && importance_.fit(bit_count(), learns_importance ? regions : 0);
  if (generation_ == octree_.generation() && fit) {
    importance_.begin_frame(frame);
    radiance_.begin_frame(frame);
  } else {
    take_in_samples(frame);
  }
  Quadtrees& sampled = radiance_.sampled();
  directions_.quadtrees = sampled.view();
  directions_.fractions = settings_.learn_fraction ? sampled.fractions() : View<const float>{};
  directions_.bsdf_fraction = settings_.bsdf_fraction;
  directions_.candidates = static_cast<uint32_t>(settings_.candidates);
  directions_.stratified = settings_.sampling == QuadtreeSampling::stratified;
  directions_.importance = importance_.sampled().view().words;
  return true;
}

void DirectionalQuadtreePass::take_in_samples(const FrameContext& frame) {
  const uint32_t regions = octree_.tree().leaf_slots();
  const uint32_t last = octree_.has_samples() ? octree_.previous().leaf_slots() : 0;
  const bool keeps_radiance = last > 0 && radiance_.fit(bit_count(), last);
  const bool keeps_importance = last > 0 && importance_.fit(bit_count(), last);
  const bool learns_importance = octree_.records_importance();
  // The frames of an epoch sample the same trees, so they have the same weight.
  const bool remembers = settings_.memory > 0 || !frame.begins_epoch;
  if (settings_.learn_fraction) {
    moments_.reserve(radiance_.trees().size());
    next_moments_.reset(regions, kUninitialized);
  }
  if (learns_importance) {
    importance_.prepare(bit_count(), regions, remembers, false);
  } else {
    importance_.clear(bit_count());
  }
  radiance_.prepare(bit_count(), regions, remembers, settings_.learn_fraction);
  // Copying trees may throw. A repeated frame must then find the snapshot of radiance unchanged, so it is the last.
  const bool frozen = radiance_.frozen();
  importance_.begin_frame(frame);
  radiance_.begin_frame(frame);
  // Nothing allocates from here on.
  if (keeps_radiance) adapt_radiance(frame, frozen, remembers);
  if (keeps_importance && learns_importance) adapt_importance(frame, frozen, remembers);
  const View<const uint32_t> previous = octree_.tree().links().previous.view();
  populate_fractions(frame, keeps_radiance);
  radiance_.populate(frame, previous, keeps_radiance, remembers);
  if (learns_importance) importance_.populate(frame, previous, keeps_importance, remembers);
  generation_ = octree_.generation();
}

QuadtreeAdaption DirectionalQuadtreePass::adaption(bool frozen) const {
  return {settings_.stability, static_cast<uint32_t>(settings_.migrations),
          frozen ? 1.0f : kept_share(settings_.memory), settings_.spread};
}

QuadtreePool DirectionalQuadtreePass::pool() const {
  return {octree_.previous().links().neighbours.view(), static_cast<uint32_t>(settings_.pool),
          1.0f - settings_.bsdf_fraction};
}

void DirectionalQuadtreePass::adapt_radiance(const FrameContext& frame, bool frozen, bool remembers) {
  const bool learns_fractions = settings_.learn_fraction;
  AdaptQuadtreesKernel kernel;
  kernel.samples = octree_.groups();
  kernel.options = adaption(frozen);
  kernel.guided_fraction = frozen ? 1.0f - settings_.bsdf_fraction : 0.0f;
  kernel.fractions = learns_fractions ? radiance_.trees().fractions() : View<const float>{};
  kernel.pool = pool();
  radiance_.adapt(frame, kernel, remembers);
  if (!learns_fractions) return;
  const uint32_t regions = radiance_.trees().size();
  if (moments_.size() != regions) resize(frame.backend, "cdq.fractions", moments_, regions);
  const LearnFractionsKernel learn{octree_.groups(), moments_.mutable_view()};
  frame.launch("cdq.fractions", learn, {regions, MixtureMoments::kFractions});
}

void DirectionalQuadtreePass::adapt_importance(const FrameContext& frame, bool frozen, bool remembers) {
  AdaptQuadtreesKernel kernel;
  kernel.samples = octree_.groups();
  kernel.options = adaption(frozen);
  kernel.options.stability = importance_stability(settings_.stability);
  kernel.pool = pool();
  kernel.importance = true;
  importance_.adapt(frame, kernel, remembers);
}

void DirectionalQuadtreePass::populate_fractions(const FrameContext& frame, bool keep) {
  if (!keep || !settings_.learn_fraction) moments_.clear();
  if (!settings_.learn_fraction) return;
  const InheritFractionsKernel kernel{octree_.tree().links().previous.view(),
                                      moments_.view(),
                                      {.fraction = settings_.bsdf_fraction},
                                      next_moments_.mutable_view(),
                                      radiance_.next_trees().mutable_fractions()};
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
    Quadtrees copy = radiance_.trees();  // write() needs a mutable object
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

std::vector<PassStatistic> DirectionalQuadtreePass::statistics() const {
  std::vector<PassStatistic> list = {{"migrations", static_cast<double>(radiance_.migrations())},
                                     {"quadtree-bytes", static_cast<double>(radiance_.trees().data_bytes())},
                                     {"memory-bytes", static_cast<double>(radiance_.weight_bytes())}};
  if (octree_.records_importance())
    list.push_back({"importance-migrations", static_cast<double>(importance_.migrations())});
  return list;
}

void DirectionalQuadtreePass::save(std::ostream& out) const {
  radiance_.save(out);
  write_array(out, moments_);
  if (octree_.records_importance()) importance_.save(out);
}

void DirectionalQuadtreePass::load(std::istream& in) {
  radiance_.load(in, bit_count());
  read_array(in, moments_);
  if (octree_.records_importance()) {
    importance_.load(in, bit_count());
  } else {
    importance_.clear(bit_count());
  }
  generation_ = octree_.generation();
  if (in && (moments_.empty() || moments_.size() == radiance_.trees().size())) return;
  radiance_.clear(bit_count());
  importance_.clear(bit_count());
  moments_.clear();
  in.setstate(std::ios::failbit);
}

}  // namespace relume
