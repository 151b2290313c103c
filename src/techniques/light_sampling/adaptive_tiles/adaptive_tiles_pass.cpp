#include "techniques/light_sampling/adaptive_tiles/adaptive_tiles_pass.h"

#include <algorithm>
#include <utility>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"

namespace relume {
namespace {

constexpr uint32_t kTileSeed = 0x3c6ef372u;
constexpr uint32_t kFeedbackSeed = 0xa54ff53au;
constexpr uint32_t kKeptSeed = 0x510e527fu;
constexpr float kDecay = 0.8f;  // of contributions, per frame

TileOptions options_of(const AdaptiveTilesSettings& s) {
  return {static_cast<uint32_t>(s.tile_size), static_cast<uint32_t>(s.list_size), static_cast<uint32_t>(s.radius),
          s.jitter, s.depth_tolerance};
}

/// A camera for raster positions in pixels of the frame.
CameraView in_pixels(CameraView camera, const FrameContext& frame) {
  camera.resolution = {static_cast<float>(frame.width()), static_cast<float>(frame.height())};
  return camera;
}

}  // namespace

bool AdaptiveTilesPass::run(const FrameContext& frame) {
  const bool lights_changed = update_lights(frame);
  if (loaded_) drop_inconsistent(frame);
  has_taken_feedback_ = std::exchange(prepared_, false);
  snapshot_.begin_frame(frame.backend, frame.begins_epoch, tiles_);
  // The feedback of an abandoned frame is incomplete and is overwritten.
  if (!has_taken_feedback_) {
    keep_lights(frame);
    count_lights(frame);
  }
  if (!has_taken_feedback_ || lights_changed) {
    tiles_.build_proxies({frame.backend, "neeat.lights", scratch_}, power_.view(), counts_.view(), used_,
                         settings_.feedback);
  }
  if (!has_taken_feedback_) {
    fill_lists(frame);
    kept_.swap(feedback_);
    kept_camera_ = feedback_camera_;
    merged_ = false;
  }
  has_taken_feedback_ = true;
  receive_feedback(frame);
  set_selector();
  return true;
}

bool AdaptiveTilesPass::update_lights(const FrameContext& frame) {
  if (built_ && !includes(frame.changes, kRebuildsLights)) return false;
  built_ = false;
  frame.backend.run("neeat.lights",
                    [&] { power_.assign(build_power_lights(frame.scene.lights, selection_.infinity())); });
  built_ = true;
  return true;
}

void AdaptiveTilesPass::drop_inconsistent(const FrameContext& frame) {
  loaded_ = false;
  bool consistent = false;
  frame.backend.run("neeat.lights", [&] {
    const auto light_count = static_cast<uint32_t>(power_.size());
    const auto is_consistent = [&](const LearnedTiles& tiles) {
      return tiles.consistent(frame.width(), frame.height(), light_count);
    };
    consistent = is_consistent(tiles_) && is_consistent(snapshot_.of(tiles_)) && is_undamaged(feedback_camera_) &&
                 (kept_.empty() || is_undamaged(kept_camera_)) && has_exact_counts(frame);
  });
  if (consistent) return;
  tiles_ = LearnedTiles(feedback_.memory());
  snapshot_.reset();
  feedback_.clear();
  kept_.clear();
  counts_.clear();
  used_ = 0;
  prepared_ = false;
}

bool AdaptiveTilesPass::has_exact_counts(const FrameContext& frame) const {
  uint64_t total = 0;
  for (const uint32_t count : counts_.read()) total += count;
  return total == used_ && used_ <= frame.pixels();
}

void AdaptiveTilesPass::keep_lights(const FrameContext& frame) {
  if (!has_feedback(frame) || kept_.size() != feedback_.size()) return kept_.clear();
  if (merged_) return;
  KeepLightsKernel kernel;
  kernel.feedback = feedback_.mutable_view();
  kernel.before = kept_.view();
  kernel.camera = in_pixels(feedback_camera_, frame);
  kernel.camera_before = in_pixels(kept_camera_, frame);
  kernel.power = power_.view();
  kernel.depth_tolerance = settings_.depth_tolerance;
  kernel.decay = kDecay;
  kernel.seed = hash(frame.index.seed, frame.number, kKeptSeed);
  frame.launch("neeat.feedback", kernel);
  merged_ = true;
}

void AdaptiveTilesPass::count_lights(const FrameContext& frame) {
  used_ = 0;
  relume::reset(frame.backend, "neeat.lights", counts_, power_.size(), 0u);
  if (!has_feedback(frame) || counts_.empty()) return;
  frame.launch("neeat.lights",
               CountUsedLightsKernel{feedback_.view(), power_.view(), frame.width(), counts_.mutable_view()});
  used_ = static_cast<uint32_t>(sum({frame.backend, "neeat.lights", scratch_}, counts_.view()));
}

void AdaptiveTilesPass::fill_lists(const FrameContext& frame) {
  if (!has_feedback(frame)) return tiles_.clear_lists();
  const FrameFeedback feedback{feedback_.view(), frame.width(), frame.height(), feedback_camera_};
  // The lists of the last frame are read while the next are filled.
  next_.clear_lists();
  next_.swap_lists(tiles_);
  try {
    tiles_.fill(frame.backend, feedback, next_, options_of(settings_), hash(frame.index.seed, frame.number, kTileSeed));
  } catch (...) {
    next_.swap_lists(tiles_);
    throw;
  }
}

void AdaptiveTilesPass::receive_feedback(const FrameContext& frame) {
  relume::reset(frame.backend, "neeat.feedback", feedback_, frame.pixels(), LightFeedback{});
  feedback_camera_ = frame.scene.camera;
  recording_ = octree_ ? octree_->recording() : PathRecording{};
  recording_.feedback = feedback_.mutable_view();
  recording_.feedback_seed = hash(frame.index.seed, frame.number, kFeedbackSeed);
}

void AdaptiveTilesPass::set_selector() {
  const LearnedTiles& sampled = snapshot_.of(tiles_);
  selector_.tiles.tiles = sampled.lists(settings_.depth_tolerance);
  selector_.tiles.all = sampled.proxies();
  selector_.tiles.local = settings_.local;
}

std::vector<PassStatistic> AdaptiveTilesPass::statistics() const {
  const TileGrid& grid = tiles_.grid();
  uint64_t distinct = 0;
  const std::span<const LightId> lights = tiles_.read_lights();
  for (size_t i = 0; i < lights.size(); ++i) {
    if (i % grid.list_size == 0 || lights[i] != lights[i - 1]) ++distinct;
  }
  return {{"tiles", static_cast<double>(grid.count())},
          {"lights-a-tile", static_cast<double>(distinct) / std::max(grid.count(), 1u)},
          {"pixels-with-a-light", static_cast<double>(used_)},
          {"list-bytes", static_cast<double>(tiles_.memory_bytes())},
          {"feedback-bytes", static_cast<double>(feedback_.memory_bytes() + kept_.memory_bytes())}};
}

std::vector<PassRecords> AdaptiveTilesPass::records() const {
  struct Entry {
    UVec2 tile{0};
    uint32_t light = 0;
    uint32_t entries = 0;
  };
  const auto read = [this] {
    std::vector<Entry> entries;
    const TileGrid& grid = tiles_.grid();
    const std::span<const LightId> lights = tiles_.read_lights();
    for (uint32_t i = 0; i < lights.size(); ++i) {
      const uint32_t tile = i / grid.list_size;
      const bool is_new = i % grid.list_size == 0 || lights[i] != lights[i - 1];
      if (is_new) entries.push_back({{tile % grid.columns, tile / grid.columns}, lights[i], 0});
      ++entries.back().entries;
    }
    return entries;
  };
  return {pass_records<Entry>("lights",
                              "a light on the list of a tile: column and row of the tile, light number, and "
                              "the number of its entries",
                              {record_field("tile", &Entry::tile), record_field("light", &Entry::light),
                               record_field("entries", &Entry::entries)},
                              read)};
}

void AdaptiveTilesPass::save(std::ostream& out) const {
  write_value(out, static_cast<uint8_t>(prepared_));
  write_value(out, feedback_camera_);
  write_value(out, used_);
  write_value(out, kept_camera_);
  write_value(out, static_cast<uint8_t>(merged_));
  write_array(out, feedback_);
  write_array(out, kept_);
  write_array(out, counts_);
  tiles_.save(out);
  snapshot_.save(out);
}

void AdaptiveTilesPass::load(std::istream& in) {
  uint8_t prepared = 0;
  read_value(in, prepared);
  prepared_ = prepared != 0;
  read_value(in, feedback_camera_);
  read_value(in, used_);
  read_value(in, kept_camera_);
  uint8_t merged = 0;
  read_value(in, merged);
  merged_ = merged != 0;
  read_array(in, feedback_);
  read_array(in, kept_);
  read_array(in, counts_);
  tiles_.load(in);
  snapshot_.load(in, LearnedTiles(feedback_.memory()));
  loaded_ = true;
  built_ = false;
}

size_t AdaptiveTilesPass::memory_bytes() const {
  return tiles_.memory_bytes() + next_.memory_bytes() + snapshot_.memory_bytes() + feedback_.memory_bytes() +
         kept_.memory_bytes() + counts_.memory_bytes() + power_.memory_bytes() + scratch_.memory_bytes();
}

}  // namespace relume
