// Skinned meshes: glTF places them by their joints, independent of the mesh's node.
#include <algorithm>

#include <fmt/format.h>

#include "scene/animation.h"
#include "viewer/document.h"

namespace relume::viewer {
namespace {

/// The deepest node that is an ancestor of, or equal to, each of `nodes`; kNone if there is none.
Index common_ancestor(const std::vector<Node>& all, const std::vector<Index>& nodes) {
  std::vector<Index> way;  // from the first node up to its root
  for (Index n = nodes.empty() ? kNone : nodes.front(); n != kNone; n = all[static_cast<size_t>(n)].parent)
    way.push_back(n);
  auto common = way.begin();
  for (const Index node : nodes) {
    auto met = way.end();
    for (Index n = node; n != kNone && met == way.end(); n = all[static_cast<size_t>(n)].parent)
      met = std::find(way.begin(), way.end(), n);
    common = std::max(common, met);
  }
  return common == way.end() ? kNone : *common;
}

}  // namespace

std::string Document::node_name(Index node) const {
  const std::string& name = outline_.nodes[static_cast<size_t>(node)].name;
  return name.empty() ? fmt::format("node {}", node) : name;
}

bool Document::has_skinned_mesh(Index node) const {
  const Node& n = outline_.nodes[static_cast<size_t>(node)];
  return std::any_of(n.meshes.begin(), n.meshes.end(),
                     [&](Index mesh) { return is_skinned(n, loaded_->scene.meshes[static_cast<size_t>(mesh)]); });
}

bool Document::has_animated_transform(Index node) const {
  const std::vector<AnimationChannel>& channels = loaded_->scene.animation;
  return !edits_.nodes.contains(node) && std::any_of(channels.begin(), channels.end(), [&](const AnimationChannel& c) {
    return c.node == node && is_transform(c.property);
  });
}

Mover Document::mover(Index node) const {
  if (!has_skinned_mesh(node)) return {node, {}};
  const Index skin = outline_.nodes[static_cast<size_t>(node)].skin;
  const Index root = common_ancestor(outline_.nodes, outline_.skins[static_cast<size_t>(skin)].joints);
  if (root == kNone)
    return {kNone, "A skin follows its joints. These have no common ancestor, so no single node moves them all."};
  Index mover = root;
  while (mover != kNone && has_animated_transform(mover)) mover = outline_.nodes[static_cast<size_t>(mover)].parent;
  if (mover != kNone) return {mover, {}};
  return {kNone, fmt::format("A skin follows its joints. Their root '{}' is animated and has no parent without "
                             "animation; add one in the file.",
                             node_name(root))};
}

std::vector<bool> Document::carried(Index ancestor) const {
  const std::vector<bool> stems = below(ancestor);
  std::vector<bool> result = stems;
  for (size_t i = 0; i < result.size(); ++i) {
    const auto node = static_cast<Index>(i);
    if (node == ancestor || !has_skinned_mesh(node)) continue;
    const Skin& skin = outline_.skins[static_cast<size_t>(outline_.nodes[i].skin)];
    result[i] = std::any_of(skin.joints.begin(), skin.joints.end(),
                            [&](Index joint) { return stems[static_cast<size_t>(joint)]; });
  }
  return result;
}

}  // namespace relume::viewer
