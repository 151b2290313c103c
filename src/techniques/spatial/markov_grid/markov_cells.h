// Owns the states of Markov chains and the records of a frame, for passes of the stage prepare.
#pragma once

#include <algorithm>
#include <cmath>
#include <iosfwd>
#include <string_view>
#include <utility>

#include "core/stream_io.h"
#include "frame/pass.h"
#include "frame/primitives/fill.h"
#include "scene/world_triangles.h"
#include "techniques/spatial/markov_grid/markov_records.h"
#include "techniques/spatial/markov_grid/settings.h"

namespace relume {

/// Level of static cells: `count` along the longest edge of the scene, rounded to a power of two.
inline int static_level_of(const SceneView& scene, int count) {
  Box box = world_box(scene);
  if (box.empty()) box.add(Vec3(0));
  const float edge = std::max(max_component(box.extent()), 1e-3f) / static_cast<float>(count);
  return std::clamp(static_cast<int>(std::lround(std::log2(edge))), kMinCellLevel, kMaxCellLevel);
}

template <typename ChainState>
class MarkovCells {
 public:
  /// `name`: of launches; it must outlive the object.
  MarkovCells(std::string_view name, Memory& memory)
      : name_(name), slots_(memory), winners_(memory), records_(memory) {}

  /// Gives the last frame's records to their cells, and prepares records for this frame. A frame that repeats an
  /// abandoned one keeps the states, which already include the records of the last complete frame.
  void begin_frame(const FrameContext& frame, const MarkovGridSettings& settings) {
    has_taken_ = std::exchange(prepared_, false);
    resize(frame, settings);
    if (!has_taken_) take_in(frame);
    has_taken_ = true;
    set_grid(frame, settings);
  }
  /// As Pass::abandon().
  void abandon() { prepared_ = has_taken_; }

  const MarkovGrid& grid() const { return grid_; }
  MarkovTable<ChainState> table() const { return {slots_.view()}; }
  MarkovRecords<ChainState> records() { return {records_.mutable_view(), vertices_, pixels_}; }

  size_t memory_bytes() const { return slots_.memory_bytes() + winners_.memory_bytes() + records_.memory_bytes(); }
  std::vector<PassStatistic> statistics() const {
    return {{"slots", static_cast<double>(slots_.size())},
            {"records", static_cast<double>(records_.size())},
            {"table-bytes", static_cast<double>(slots_.size() * sizeof(MarkovSlot<ChainState>))}};
  }

  /// Winners are not saved: those of earlier frames lose against all later ones.
  void save(std::ostream& out) const {
    write_value(out,
                Header{grid_.adaptive_slots, vertices_, pixels_, static_cells_, grid_.static_level, taken_, prepared_});
    write_array(out, slots_);
    write_array(out, records_);
  }
  /// Sets the stream's failbit and clears everything if the sizes disagree. Any bits are valid states.
  void load(std::istream& in) {
    Header header;
    read_value(in, header);
    read_array(in, slots_);
    read_array(in, records_);
    const bool fits = in && header.adaptive_slots <= slots_.size() && header.vertices <= kMostChainVertices &&
                      uint64_t{header.vertices} * header.pixels == records_.size() &&
                      header.static_level >= kMinCellLevel && header.static_level <= kMaxCellLevel;
    if (!fits) {
      in.setstate(std::ios::failbit);
      header = {};
      slots_.clear();
      records_.clear();
    }
    winners_.assign(slots_.size(), MarkovPriority::kNone);
    stamp_ = 0;
    grid_.adaptive_slots = header.adaptive_slots;
    vertices_ = header.vertices;
    pixels_ = header.pixels;
    static_cells_ = header.static_cells;
    grid_.static_level = header.static_level;
    taken_ = header.taken;
    prepared_ = header.prepared != 0;
  }

 private:
  static constexpr uint32_t kTile = 2048;  ///< records per task
  static constexpr uint32_t kFewestSlots = 1024;
  static constexpr uint32_t kMostSlots = 1u << 31;
  static constexpr uint32_t kDrawSeed = 0x9b05688cu;
  static constexpr uint32_t kOrderSeed = 0x1f83d9abu;

  /// Start of a checkpoint.
  struct Header {
    uint32_t adaptive_slots = 0;
    uint32_t vertices = 0;
    uint32_t pixels = 0;
    int static_cells = 0;
    int static_level = 0;
    uint32_t taken = 0;
    uint32_t prepared = 0;
  };

  /// Allocates for the size of the image and the settings. Changed numbers of slots or records empty them.
  void resize(const FrameContext& frame, const MarkovGridSettings& s) {
    const auto vertices = static_cast<uint32_t>(s.vertices);
    const size_t records = size_t{frame.pixels()} * vertices;
    if (vertices_ != vertices || pixels_ != frame.pixels() || records_.size() != records) {
      reset(frame.backend, name_, records_, records);
      vertices_ = vertices;
      pixels_ = frame.pixels();
    }
    const uint64_t wanted = uint64_t{frame.pixels()} * vertices * static_cast<uint64_t>(s.slots);
    const auto adaptive = static_cast<uint32_t>(std::clamp<uint64_t>(wanted, kFewestSlots, kMostSlots));
    const size_t slots = size_t{adaptive} + static_cast<size_t>(s.static_slots);
    if (grid_.adaptive_slots == adaptive && slots_.size() == slots) return;
    grid_.adaptive_slots = 0;  // allocates again if memory is missing now
    reset(frame.backend, name_, winners_, slots, MarkovPriority::kNone);
    reset(frame.backend, name_, slots_, slots);
    stamp_ = 0;
    grid_.adaptive_slots = adaptive;
  }

  void take_in(const FrameContext& frame) {
    if (stamp_ == MarkovPriority::kMostStamp) {
      fill(frame.backend, name_, winners_.mutable_view(), MarkovPriority::kNone);
      stamp_ = 0;
    }
    // Not the frame's number and seed, which change with the scene after an abandoned frame.
    const MarkovPriority priority{++stamp_, hash(++taken_, kOrderSeed)};
    const Grid all{static_cast<uint32_t>(records_.size()), 1, kTile};
    frame.launch(name_, ElectWritersKernel<ChainState>{records_.view(), winners_.mutable_view(), priority}, all);
    frame.launch(name_,
                 WriteStatesKernel<ChainState>{records_.view(), winners_.view(), slots_.mutable_view(), priority}, all);
  }

  void set_grid(const FrameContext& frame, const MarkovGridSettings& s) {
    if (static_cells_ != s.static_cells) {
      frame.backend.run(name_, [&] { grid_.static_level = static_level_of(frame.scene, s.static_cells); });
      static_cells_ = s.static_cells;
    }
    const auto& camera = frame.scene.camera;
    grid_.keys.camera = camera.position;
    grid_.keys.cone_width = camera.cone_width();
    grid_.keys.cone_spread = camera.cone_spread();
    grid_.keys.cell_size = s.cell_size;
    grid_.static_slots = static_cast<uint32_t>(s.static_slots);
    grid_.adaptive_share = s.adaptive_share;
    grid_.drawn_cells = static_cast<uint32_t>(s.cells);
    grid_.seed = hash(frame.index.seed, frame.number, kDrawSeed);
  }

  std::string_view name_;
  Array<MarkovSlot<ChainState>> slots_;      ///< of the adaptive grid, then of the static one
  Array<uint64_t> winners_;                  ///< MarkovPriority::key() by slot
  Array<MarkovRecord<ChainState>> records_;  ///< of the current frame; of the last one before begin_frame()
  MarkovGrid grid_;
  uint32_t vertices_ = 0;
  uint32_t pixels_ = 0;
  int static_cells_ = 0;    ///< setting that `grid_.static_level` follows
  uint32_t stamp_ = 0;      ///< as MarkovPriority::stamp, of the last frame
  uint32_t taken_ = 0;      ///< number of frames whose records the states include
  bool prepared_ = false;   ///< whether the states already include the records of the last complete frame
  bool has_taken_ = false;  ///< the same, during a frame
};

}  // namespace relume
