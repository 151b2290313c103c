#include "viewer/model/document.h"

#include <algorithm>
#include <limits>

#include <glm/matrix.hpp>

#include "scene/animation.h"
#include "scene_io/decompose.h"

namespace relume::viewer {
namespace {

/// The part of the scene that panels show and edit, without arrays.
Scene outline_of(const Scene& scene) {
  Scene outline;
  outline.name = scene.name;
  outline.materials = scene.materials;
  outline.lights = scene.lights;
  outline.cameras = scene.cameras;
  outline.nodes = scene.nodes;
  outline.skins = scene.skins;
  outline.clips = scene.clips;
  outline.variants = scene.variants;
  outline.environment = scene.environment;
  outline.environment.map.clear();
  for (const Mesh& mesh : scene.meshes) {
    Mesh& copy = outline.meshes.emplace_back();
    copy.name = mesh.name;
    copy.material = mesh.material;
    copy.variants = mesh.variants;
    copy.default_material = mesh.default_material;
  }
  return outline;
}

}  // namespace

Document::Document(std::shared_ptr<const LoadedScene> loaded)
    : loaded_(std::move(loaded)),
      outline_(outline_of(loaded_->scene)),
      environment_(loaded_, &loaded_->scene.environment),
      mesh_boxes_(mesh_boxes(loaded_->scene)),
      skeletons_(skeletons()) {
  play("");
}

void Document::set_camera(const std::optional<CameraPose>& camera) { edits_.camera = {camera, next_version()}; }

void Document::set_time(float time_s) {
  edits_.time_s = {time_s, next_version()};
  invalidate_transforms();
}

void Document::play(const std::string& animation) {
  Scene playing;
  playing.name = loaded_->name;
  playing.clips = loaded_->scene.clips;
  playing.animation = loaded_->scene.animation;
  select_animation(playing, animation);
  playing_ = playing.animation;
  outline_.animation = std::move(playing.animation);
  std::erase_if(outline_.animation, [&](const AnimationChannel& channel) {
    return is_transform(channel.property) && edits_.nodes.contains(channel.node);
  });
  duration_s_ = animation_end(outline_);
  invalidate_transforms();
}

void Document::choose_variant(const std::string& name) { relume::choose_variant(outline_, name); }

void Document::invalidate_transforms() {
  world_valid_ = false;
  deformed_bounds_.clear();
  joints_.reset();
}

void Document::set_transform(Index node, const Transform& transform) {
  Node& target = outline_.nodes[static_cast<size_t>(node)];
  target.transform = transform;
  target.matrix.reset();
  std::erase_if(outline_.animation, [&](const AnimationChannel& channel) {
    return channel.node == node && is_transform(channel.property);
  });
  edits_.nodes[node] = {transform, next_version()};
  invalidate_transforms();
}

void Document::set_light(Index light, const PunctualLight& value) {
  outline_.lights[static_cast<size_t>(light)] = value;
  edits_.lights[light] = {value, next_version()};
}

void Document::set_material(Index material, const Material& value) {
  outline_.materials[static_cast<size_t>(material)] = value;
  edits_.materials[material] = {value, next_version()};
}

void Document::set_environment(const Environment& environment) {
  Environment complete = environment;
  complete.width = environment_->width;
  complete.height = environment_->height;
  complete.map = environment_->map;
  replace_environment(std::move(complete));
  environment_is_set_ = true;
}

void Document::replace_environment(Environment environment) {
  use(std::make_shared<const Environment>(std::move(environment)));
}

void Document::restore_environment() { use({loaded_, &loaded_->scene.environment}); }

void Document::use(std::shared_ptr<const Environment> environment) {
  environment_ = std::move(environment);
  environment_is_set_ = false;
  Environment& outline = outline_.environment;
  outline.kind = environment_->kind;
  outline.color = environment_->color;
  outline.rotation_rad = environment_->rotation_rad;
  outline.width = environment_->width;
  outline.height = environment_->height;
  outline.sun_sky = environment_->sun_sky;
  edits_.environment = {environment_, next_version()};
}

std::vector<bool> Document::below(const std::vector<Index>& ancestors) const {
  enum : uint8_t { unknown, no, yes };
  std::vector<uint8_t> verdicts(outline_.nodes.size(), unknown);
  for (const Index ancestor : ancestors) verdicts[static_cast<size_t>(ancestor)] = yes;
  std::vector<size_t> way;
  for (size_t i = 0; i < verdicts.size(); ++i) {
    way.clear();
    Index n = static_cast<Index>(i);
    for (; n != kNone && verdicts[static_cast<size_t>(n)] == unknown; n = outline_.nodes[static_cast<size_t>(n)].parent)
      way.push_back(static_cast<size_t>(n));
    const uint8_t verdict = n == kNone ? uint8_t{no} : verdicts[static_cast<size_t>(n)];
    for (const size_t passed : way) verdicts[passed] = verdict;
  }
  std::vector<bool> result(verdicts.size());
  for (size_t i = 0; i < verdicts.size(); ++i) result[i] = verdicts[i] == yes;
  return result;
}

bool Document::make_movable(Index node) {
  if (std::find(edits_.movable.begin(), edits_.movable.end(), node) != edits_.movable.end()) return false;
  Scene playing;
  playing.nodes = outline_.nodes;
  playing.animation = playing_;
  if (moving_nodes(playing, edits_.movable)[static_cast<size_t>(node)]) return false;
  if (bounds(node).empty()) return false;  // no geometry in the acceleration structure
  edits_.movable.push_back(node);
  next_version();
  return true;
}

const std::vector<Mat4>& Document::world() const {
  if (!world_valid_) world_ = world_matrices(outline_, edits_.time_s.value);
  world_valid_ = true;
  return world_;
}

Transform Document::transform(Index node) const {
  const Node& n = outline_.nodes[static_cast<size_t>(node)];
  const Mat4& own = world()[static_cast<size_t>(node)];
  const Mat4 local = n.parent == kNone ? own : glm::inverse(world()[static_cast<size_t>(n.parent)]) * own;
  return decompose(local);
}

void Document::move(Index node, const Vec3& by) {
  const Index parent = outline_.nodes[static_cast<size_t>(node)].parent;
  const Mat4 to_parent = parent == kNone ? Mat4(1) : glm::inverse(world()[static_cast<size_t>(parent)]);
  Transform t = transform(node);
  t.translation += transform_vector(to_parent, by);
  set_transform(node, t);
}

const Box& Document::deformed_bounds(Index node, Index mesh) const {
  const auto [entry, is_new] = deformed_bounds_.try_emplace({node, mesh});
  if (is_new) {
    // Posed with the edits; the meshes' arrays are those of the loaded scene.
    if (!joints_) joints_ = joint_matrices(outline_, world());
    entry->second =
        deformed_box(outline_, node, loaded_->scene.meshes[static_cast<size_t>(mesh)], *joints_, edits_.time_s.value);
  }
  return entry->second;
}

template <typename F>
void Document::for_each_box(Index node, const F& f) const {
  const Node& n = outline_.nodes[static_cast<size_t>(node)];
  for_each_place(n, [&](Index index, const Mat4& to_node) {
    const Mesh& mesh = loaded_->scene.meshes[static_cast<size_t>(index)];
    const Box& box = is_deformable(n, mesh) ? deformed_bounds(node, index) : mesh_boxes_[static_cast<size_t>(index)];
    f(box, is_skinned(n, mesh) ? Mat4(1) : world()[static_cast<size_t>(node)] * to_node);
  });
}

std::vector<std::pair<Box, Mat4>> Document::boxes(Index node, size_t most) const {
  std::vector<std::pair<Box, Mat4>> result;
  const std::vector<bool> wanted = carried(node);
  for (size_t i = 0; i < wanted.size() && result.size() < most; ++i) {
    if (!wanted[i]) continue;
    for_each_box(static_cast<Index>(i), [&](const Box& box, const Mat4& to_world) {
      if (result.size() < most) result.emplace_back(box, to_world);
    });
  }
  return result;
}

void Document::add_bounds(Index node, Box& sum) const {
  for_each_box(node, [&](const Box& box, const Mat4& to_world) { sum.add(transformed(box, to_world)); });
}

Box Document::bounds(Index node) const {
  Box sum;
  const std::vector<bool> wanted = carried(node);
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i]) add_bounds(static_cast<Index>(i), sum);
  }
  return sum;
}

Box Document::bounds() const {
  Box sum;
  for (size_t i = 0; i < outline_.nodes.size(); ++i) add_bounds(static_cast<Index>(i), sum);
  return sum;
}

Index Document::node_of_light(Index light) const {
  for (size_t i = 0; i < outline_.nodes.size(); ++i) {
    if (outline_.nodes[i].light == light) return static_cast<Index>(i);
  }
  return kNone;
}

}  // namespace relume::viewer
