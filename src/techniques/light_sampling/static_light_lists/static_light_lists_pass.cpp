#include "techniques/light_sampling/static_light_lists/static_light_lists_pass.h"

#include <algorithm>

#include "core/stream_io.h"

namespace relume {
namespace {

/// Number of cells, or any number above `most`: the product may exceed 32 bits.
uint64_t cell_count(const LightGrid& grid, uint64_t most) {
  uint64_t count = 1;
  for (int axis = 0; axis < 3 && count <= most; ++axis) count *= grid.cells[axis];
  return count;
}

/// Whether the grid is valid, and lists lie within `ids` and hold ids below `lights`.
bool is_consistent(const LightListData& data, uint32_t lights) {
  if (data.first.empty()) return data.ids.empty();
  if (!is_finite(data.grid.corner) || !is_finite(data.grid.cell_size) || !(data.grid.cell_size > 0)) return false;
  if (cell_count(data.grid, data.first.size()) + 1 != data.first.size()) return false;
  const bool sorted = std::is_sorted(data.first.begin(), data.first.end());
  const bool known = std::all_of(data.ids.begin(), data.ids.end(), [&](LightId id) { return id < lights; });
  return sorted && known && data.first.back() == data.ids.size();
}

}  // namespace

bool StaticLightListsPass::run(const FrameContext& frame) {
  const LightsView& lights = frame.scene.lights;
  const LightListOptions options{settings_.cell_size, static_cast<uint32_t>(settings_.rays)};
  const bool listed = (built_ || restored_) && options == options_ && listed_ == lights.first_infinite;
  restored_ = false;
  if (!listed) {
    // Later frames have other seeds when objects move, but keep the lists.
    builder_.emplace(frame.scene, options, frame.index.seed);
    options_ = options;
    listed_ = lights.first_infinite;
  }
  if (builder_) {
    const bool complete = builder_->advance(frame.backend, frame.scene, frame.hurry);
    lists_ = builder_->lists();
    if (complete) builder_.reset();
    built_ = false;
  }
  if (built_ && !includes(frame.changes, kRebuildsLights)) return true;
  built_ = true;
  std::vector<float> weights;
  for (LightId i = 0; i < lights.first_infinite; ++i) weights.push_back(selection_weight(lights, i));
  all_ = build_alias_table(weights);
  infinite_ = build_infinite_lights(lights, selection_.infinity());
  compact_ = compact_lights(lights);
  StaticLightLists& view = selector_.lists;
  view.grid = lists_.grid;
  view.first = view_of(lists_.first);
  view.ids = view_of(lists_.ids);
  view.max_lights = static_cast<uint32_t>(settings_.max_lights);
  view.exploration = settings_.exploration;
  view.all = {view_of(all_)};
  view.infinite = make_infinite_lights(lights, infinite_, !all_.empty());
  view.ltc = ltc_table();
  view.compact = view_of(compact_);
  view.lights = lights;
  return true;
}

std::vector<PassRecords> StaticLightListsPass::records() const {
  struct Entry {
    Vec3 corner{0};
    uint32_t light = 0;
  };
  const auto read = [this] {
    std::vector<Entry> entries;
    for (uint32_t cell = 0; cell + 1 < lists_.first.size(); ++cell) {
      for (uint32_t i = lists_.first[cell]; i < lists_.first[cell + 1]; ++i)
        entries.push_back({lists_.grid.low(cell), lists_.ids[i]});
    }
    return entries;
  };
  return {pass_records<Entry>("lights", "a light that is visible from a cell, and the cell's low corner in metres",
                              {record_field("corner", &Entry::corner), record_field("light", &Entry::light)}, read)};
}

void StaticLightListsPass::save(std::ostream& out) const {
  // load() expects complete lists.
  const LightListData& lists = builder_ ? LightListData() : lists_;
  write_value(out, builder_ ? 0 : listed_);
  write_value(out, options_.cell_size);
  write_value(out, options_.rays);
  write_value(out, lists.grid.corner);
  write_value(out, lists.grid.cell_size);
  write_value(out, lists.grid.cells);
  write_vector(out, lists.first);
  write_vector(out, lists.ids);
}

void StaticLightListsPass::load(std::istream& in) {
  read_value(in, listed_);
  read_value(in, options_.cell_size);
  read_value(in, options_.rays);
  read_value(in, lists_.grid.corner);
  read_value(in, lists_.grid.cell_size);
  read_value(in, lists_.grid.cells);
  read_vector(in, lists_.first);
  read_vector(in, lists_.ids);
  restored_ = is_consistent(lists_, listed_);
  built_ = false;
  builder_.reset();
  if (!restored_) in.setstate(std::ios::failbit);
}

size_t StaticLightListsPass::memory_bytes() const {
  return sizeof(uint32_t) * (lists_.first.size() + lists_.ids.size()) +
         sizeof(AliasEntry) * (all_.size() + infinite_.size()) + sizeof(CompactLight) * compact_.size();
}

}  // namespace relume
