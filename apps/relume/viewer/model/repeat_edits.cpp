// Repeats edits after a scene is reloaded.
#include <algorithm>

#include <fmt/format.h>

#include "scene/material_parameters.h"
#include "viewer/model/document.h"

namespace relume::viewer {
namespace {

/// Index of the only item of that name; kNone if there is none or several.
template <typename Items>
Index only_one_named(const Items& items, const std::string& name) {
  const auto has_name = [&](const auto& item) { return item.name == name; };
  if (name.empty() || std::count_if(items.begin(), items.end(), has_name) != 1) return kNone;
  return static_cast<Index>(std::find_if(items.begin(), items.end(), has_name) - items.begin());
}

/// Index in `items` of the item with index `i` in `others`. If the name is not unique, kNone, and the name is added to
/// `lost`.
template <typename Items>
Index matching(const Items& items, const Items& others, Index i, const char* kind, std::vector<std::string>& lost) {
  const std::string& name = others[static_cast<size_t>(i)].name;
  if (only_one_named(others, name) != kNone) {
    if (const Index match = only_one_named(items, name); match != kNone) return match;
  }
  lost.push_back(name.empty() ? fmt::format("{} {}", kind, i) : fmt::format("{} '{}'", kind, name));
  return kNone;
}

/// `edited`, with the textures and parts of `current`: the new file may number them differently.
Material with_references_of(const Material& current, Material edited) {
  for (const MaterialParameter& parameter : material_parameters()) {
    if (const auto* texture = std::get_if<TextureRef Material::*>(&parameter.member))
      edited.** texture = current.**texture;
  }
  edited.mix_first = current.mix_first;
  edited.mix_second = current.mix_second;
  return edited;
}

}  // namespace

std::vector<std::string> Document::repeat_edits(const Document& other) {
  std::vector<std::string> lost;
  const Scene& theirs = other.outline_;
  for (const Index node : other.edits_.movable) {
    if (const Index match = only_one_named(outline_.nodes, theirs.nodes[static_cast<size_t>(node)].name);
        match != kNone)
      make_movable(match);
  }
  for (const auto& [node, edit] : other.edits_.nodes) {
    const Index match = matching(outline_.nodes, theirs.nodes, node, "object", lost);
    if (match == kNone) continue;
    make_movable(match);
    set_transform(match, edit.value);
  }
  for (const auto& [light, edit] : other.edits_.lights) {
    const Index match = matching(outline_.lights, theirs.lights, light, "light", lost);
    if (match != kNone) set_light(match, edit.value);
  }
  for (const auto& [material, edit] : other.edits_.materials) {
    const Index match = matching(outline_.materials, theirs.materials, material, "material", lost);
    if (match == kNone) continue;
    set_material(match, with_references_of(outline_.materials[static_cast<size_t>(match)], edit.value));
  }
  if (!other.environment_is_set_) return lost;
  if (theirs.environment.kind == EnvironmentKind::map && !has_environment_map()) {
    lost.emplace_back("the environment");
  } else {
    set_environment(theirs.environment);
  }
  return lost;
}

}  // namespace relume::viewer
