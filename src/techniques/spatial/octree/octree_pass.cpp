#include "techniques/spatial/octree/octree_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/stream_io.h"
#include "scene/world_triangles.h"
#include "techniques/spatial/octree/region_view.h"

namespace relume {
namespace {

constexpr uint32_t kJitterSeed = 0x6a09e667u;

// First byte of a checkpoint.
constexpr uint8_t kNoTree = 0;
constexpr uint8_t kTree = 1;
constexpr uint8_t kPreparedTree = 2;  ///< the next frame was abandoned

/// The tree around the current surfaces. Surfaces that move out of it later belong to cells at its border.
OctreeTree first_tree(const SceneView& scene, Memory& memory) {
  Box box = world_box(scene);
  if (box.empty()) box.add(Vec3(0));
  const float edge = std::max(1.001f * max_component(box.extent()), 1e-3f);
  return OctreeTree(box.center(), edge, memory);
}

}  // namespace

OctreeThresholds thresholds_of(const OctreeSettings& s, uint32_t pixels) {
  const bool scales = s.scale && s.count == OctreeCount::all;
  const double scale = scales ? pixels * static_cast<double>(s.vertices) / (2.0 * 1920 * 1080) : 1.0;
  constexpr double kFewest = 1024;
  const double split = std::max(s.split * scale, std::min<double>(s.split, kFewest));
  OctreeThresholds t;
  t.split = static_cast<uint32_t>(std::lround(split));
  t.collapse = static_cast<uint32_t>(std::lround(std::min(s.collapse * split / s.split, split)));
  t.max_depth = static_cast<uint32_t>(s.max_depth);
  return t;
}

bool OctreePass::run(const FrameContext& frame) {
  const uint32_t vertices = static_cast<uint32_t>(settings_.vertices);
  has_taken_samples_ = std::exchange(prepared_, false);
  // Resized before they are grouped, because other passes read the groups until the next frame.
  stream_.resize(frame.backend, frame.pixels(), vertices, users_.importance);
  if (!tree_) {
    frame.backend.run("octree.first", [&] { tree_ = first_tree(frame.scene, memory_); });
    ++generation_;
  } else {
    snapshot_.begin_frame(frame.backend, frame.begins_epoch, *tree_);
    // The samples of an abandoned frame are incomplete and are overwritten.
    if (!has_taken_samples_) adapt(frame);
  }
  has_taken_samples_ = true;
  tree_->write_leaf_depths(frame.backend, depths_);
  recording_ = {.octree = tree_->view(),
                .lookup = {.tree = sampled().view(),
                           .jitter = settings_.jitter,
                           .seed = hash(frame.index.seed, frame.number, kJitterSeed)},
                .samples = stream_.samples(),
                .vertices = vertices,
                .pixels = frame.pixels(),
                .frozen = snapshot_.frozen(),
                .importance = stream_.importance()};
  return true;
}

void OctreePass::adapt(const FrameContext& frame) {
  stream_.group(frame.backend, tree_->leaf_slots());
  OctreeTree next = tree_->adapted(frame.backend, counts(frame), thresholds_of(settings_, frame.pixels()), scratch_);
  previous_ = std::move(tree_);
  tree_ = std::move(next);
  ++generation_;
}

View<const uint32_t> OctreePass::counts(const FrameContext& frame) {
  if (settings_.count == OctreeCount::all) return stream_.groups().counts;
  useful_.reset(tree_->leaf_slots(), kUninitialized);
  const CountUsefulSamplesKernel count{stream_.groups(), users_, frame.scene.lights.first_infinite,
                                       useful_.mutable_view()};
  frame.launch("octree.count", count, {tree_->leaf_slots(), 1});
  return useful_.view();
}

PassDeclaration RegionViewPass::declaration() const {
  return {
      .name = "octree-view",
      .stage = Stage::present,
      .owns = {{.id = kRegion, .help = "index of the octree leaf at the first hit", .display = BufferDisplay::value},
               {.id = kRegionDepth,
                .help = "level of the octree leaf; each level has an eighth of the volume of the one above",
                .display = BufferDisplay::value}}};
}

bool RegionViewPass::run(const FrameContext& frame) {
  const RegionViewKernel kernel{octree_.samples(), octree_.depths(), frame.write(kRegion), frame.write(kRegionDepth),
                                frame.width()};
  frame.launch("octree-view", kernel);
  return true;
}

size_t OctreePass::memory_bytes() const {
  return stream_.memory_bytes() + depths_.memory_bytes() + scratch_.memory_bytes() + useful_.memory_bytes() +
         (tree_ ? tree_->memory_bytes() : 0) + (previous_ ? previous_->memory_bytes() : 0) + snapshot_.memory_bytes();
}

std::vector<PassStatistic> OctreePass::statistics() const {
  if (!tree_) return {};
  return {{"leaves", static_cast<double>(tree_->leaf_count())},
          {"leaf-slots", static_cast<double>(tree_->leaf_slots())},
          {"depth", static_cast<double>(tree_->depth())},
          {"samples", static_cast<double>(stream_.groups().order.size)},
          {"tree-bytes", static_cast<double>(tree_->memory_bytes() + depths_.memory_bytes())},
          {"place-bytes", static_cast<double>(stream_.place_bytes())}};
}

std::vector<PassRecords> OctreePass::records() const {
  struct Leaf {
    uint32_t region = 0;
    Vec3 corner{0};
    float edge = 0;
  };
  const auto read = [this] {
    std::vector<Leaf> leaves;
    for (uint32_t slot = 0; tree_ && slot < tree_->leaf_slots(); ++slot) {
      if (!tree_->is_leaf(slot)) continue;
      const OctreeCube cube = tree_->cube_of(slot);
      leaves.push_back({slot, cube.corner, cube.edge});
    }
    return leaves;
  };
  return {pass_records<Leaf>(
      "leaves", "a leaf: its region number, low corner and edge in metres",
      {record_field("region", &Leaf::region), record_field("corner", &Leaf::corner), record_field("edge", &Leaf::edge)},
      read)};
}

// After an error of a later pass, the data of that pass may lack the last complete frame's samples. A session that
// continues from a checkpoint of this state does not add them.
void OctreePass::save(std::ostream& out) const {
  write_value(out, !tree_ ? kNoTree : prepared_ ? kPreparedTree : kTree);
  if (!tree_) return;
  tree_->save(out);
  stream_.save(out, users_.importance);
  snapshot_.save(out);
}

void OctreePass::load(std::istream& in) {
  tree_.reset();
  previous_.reset();
  snapshot_.reset();
  prepared_ = false;
  uint8_t saved = kNoTree;
  read_value(in, saved);
  if (!in || saved == kNoTree) return;
  prepared_ = saved == kPreparedTree;
  tree_.emplace(Vec3(0), 1.0f, memory_);
  tree_->load(in);
  stream_.load(in, users_.importance);
  snapshot_.load(in, OctreeTree(Vec3(0), 1.0f, memory_));
}

}  // namespace relume
