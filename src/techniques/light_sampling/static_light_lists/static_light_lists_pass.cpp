#include "techniques/light_sampling/static_light_lists/static_light_lists_pass.h"

#include <algorithm>

#include "core/stream_io.h"
#include "relume/error.h"
#include "techniques/light_sampling/light_selection/compact_lights.h"
#include "techniques/light_sampling/static_light_lists/visible_set_lists.h"

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
  const LightListOptions options{settings_.cell_size, static_cast<uint32_t>(settings_.rays),
                                 settings_.visibility == LightListVisibility::sets};
  const bool listed = (built_ || restored_) && options == options_ && listed_ == lights.first_infinite;
  restored_ = false;
  if (!listed && options.from_sets) {
    take_visible_sets(frame);
    options_ = options;
    listed_ = lights.first_infinite;
  } else if (!listed) {
    // Later frames have other seeds when objects move, but keep the lists.
    frame.backend.run("static-lists.cells",
                      [&] { builder_.emplace(frame.scene, options, frame.index.seed, frame.backend.memory()); });
    options_ = options;
    listed_ = lights.first_infinite;
  }
  if (builder_) build_lists(frame);
  if (built_ && !includes(frame.changes, kRebuildsLights)) return true;
  built_ = true;
  frame.backend.run("static-lists.lights", [&] {
    std::vector<float> weights;
    for (LightId i = 0; i < lights.first_infinite; ++i) weights.push_back(selection_weight(lights, i));
    all_.assign(build_alias_table(weights));
    infinite_.assign(build_infinite_lights(lights, selection_.infinity()));
  });
  write_compact_lights(frame.backend, "static-lists.lights", lights, lights.first_infinite, compact_);
  StaticLightLists& view = selector_.lists;
  view.grid = grid_;
  view.first = first_.view();
  view.ids = ids_.view();
  view.max_lights = static_cast<uint32_t>(settings_.max_lights);
  view.exploration = settings_.exploration;
  view.all = {all_.view()};
  view.infinite = make_infinite_lights(lights, infinite_.view(), !all_.empty());
  view.ltc = ltc_table(ltc_);
  view.compact = compact_.view();
  view.lights = lights;
  return true;
}

void StaticLightListsPass::take_visible_sets(const FrameContext& frame) {
  if (!frame.visible_sets || frame.visible_sets->empty())
    throw Error(
        "static-lists.visibility is 'sets', but the scene has no visible sets; use 'rays', or a scene with visible "
        "sets");
  builder_.reset();
  built_ = false;
  frame.backend.run("static-lists.sets", [&] {
    assign_lists(lists_from_visible_sets(frame.scene.lights, *frame.visible_sets, settings_.cell_size));
  });
}

void StaticLightListsPass::build_lists(const FrameContext& frame) {
  const bool complete = builder_->advance(frame.backend, frame.scene, frame.hurry);
  grid_ = builder_->grid();
  builder_->write_lists(frame.backend, first_, ids_);
  if (complete) builder_.reset();
  built_ = false;
}

void StaticLightListsPass::assign_lists(const LightListData& lists) {
  grid_ = lists.grid;
  first_.assign(lists.first);
  ids_.assign(lists.ids);
}

LightListData StaticLightListsPass::complete_lists() const {
  if (builder_) return {};
  const std::span<const uint32_t> first = first_.read();
  const std::span<const LightId> ids = ids_.read();
  return {grid_, {first.begin(), first.end()}, {ids.begin(), ids.end()}};
}

std::vector<PassRecords> StaticLightListsPass::records() const {
  struct Entry {
    Vec3 corner{0};
    uint32_t light = 0;
  };
  const auto read = [this] {
    std::vector<Entry> entries;
    const std::span<const uint32_t> first = first_.read();
    const std::span<const LightId> ids = ids_.read();
    for (uint32_t cell = 0; cell + 1 < first.size(); ++cell) {
      for (uint32_t i = first[cell]; i < first[cell + 1]; ++i) entries.push_back({grid_.low(cell), ids[i]});
    }
    return entries;
  };
  return {pass_records<Entry>("lights", "a light that is visible from a cell, and the cell's low corner in metres",
                              {record_field("corner", &Entry::corner), record_field("light", &Entry::light)}, read)};
}

void StaticLightListsPass::save(std::ostream& out) const {
  // load() expects complete lists.
  const LightListData lists = complete_lists();
  write_value(out, builder_ ? 0 : listed_);
  write_value(out, options_.cell_size);
  write_value(out, options_.rays);
  write_value(out, uint32_t{options_.from_sets});
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
  uint32_t from_sets = 0;
  read_value(in, from_sets);
  options_.from_sets = from_sets != 0;
  LightListData lists;
  read_value(in, lists.grid.corner);
  read_value(in, lists.grid.cell_size);
  read_value(in, lists.grid.cells);
  read_vector(in, lists.first);
  read_vector(in, lists.ids);
  assign_lists(lists);
  restored_ = is_consistent(lists, listed_);
  built_ = false;
  builder_.reset();
  if (!restored_) in.setstate(std::ios::failbit);
}

size_t StaticLightListsPass::memory_bytes() const {
  return first_.memory_bytes() + ids_.memory_bytes() + all_.memory_bytes() + infinite_.memory_bytes() +
         compact_.memory_bytes() + ltc_.memory_bytes();
}

}  // namespace relume
