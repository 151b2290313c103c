// Skinned meshes: glTF places them by their joints, independent of the mesh's node.
#include <algorithm>

#include <fmt/format.h>

#include "scene/animation.h"
#include "viewer/model/document.h"

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
  if (mover == kNone)
    return {kNone, fmt::format("A skin follows its joints. Their root '{}' is animated and has no parent without "
                               "animation; add one in the file.",
                               node_name(root))};
  const Index passenger = passenger_of(mover, skin);
  if (passenger == kNone) return {mover, {}};
  return {kNone, fmt::format("A skin follows its joints. The node that moves them, '{}', would also move '{}'; give "
                             "the joints a parent without other content in the file.",
                             node_name(mover), node_name(passenger))};
}

std::vector<Index> Document::skeletons() const {
  std::vector<Index> roots;
  for (const Skin& skin : outline_.skins) roots.push_back(common_ancestor(outline_.nodes, skin.joints));
  std::vector<bool> is_root(outline_.nodes.size());
  for (const Index root : roots) {
    if (root != kNone) is_root[static_cast<size_t>(root)] = true;
  }
  for (Index& top : roots) {
    for (Index n = top; n != kNone; n = outline_.nodes[static_cast<size_t>(n)].parent) {
      if (is_root[static_cast<size_t>(n)]) top = n;
    }
  }
  return roots;
}

Index Document::passenger_of(Index mover, Index skin) const {
  const Index skeleton = skeletons_[static_cast<size_t>(skin)];
  std::vector<Index> joints;
  for (size_t s = 0; s < skeletons_.size(); ++s) {
    const std::vector<Index>& of_skin = outline_.skins[s].joints;
    if (skeletons_[s] == skeleton) joints.insert(joints.end(), of_skin.begin(), of_skin.end());
  }
  const std::vector<bool> moved_by_joints = below(joints);
  const std::vector<bool> stems = below({mover});
  const std::vector<bool> meshes_move = carried(mover);
  for (size_t i = 0; i < stems.size(); ++i) {
    const auto node = static_cast<Index>(i);
    const Node& n = outline_.nodes[i];
    const bool skinned = has_skinned_mesh(node);
    const bool has_part =
        (stems[i] && (n.light != kNone || n.camera != kNone)) || (meshes_move[i] && !n.meshes.empty() && !skinned);
    if (has_part && !moved_by_joints[i]) return node;
    if (meshes_move[i] && skinned && skeletons_[static_cast<size_t>(n.skin)] != skeleton) return node;
  }
  return kNone;
}

std::vector<bool> Document::carried(Index ancestor) const {
  const std::vector<bool> stems = below({ancestor});
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
