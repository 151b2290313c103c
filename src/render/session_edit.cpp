// Edits of a session's scene.
#include <algorithm>

#include <fmt/format.h>

#include "relume/error.h"
#include "render/session_state.h"
#include "scene/scene.h"

namespace relume {
namespace {

/// Throws Error unless the handle names an existing one of `removed.size()` parts.
template <typename Part, typename State>
Index checked(const Handle<Part>& handle, const std::vector<bool>& removed, const State& state, const char* kind) {
  const auto fail = [&](const std::string& problem) {
    throw Error(ErrorCode::invalid_handle,
                fmt::format("{}: {} {} {}", error_place(state.scene->source()), kind, handle.index, problem));
  };
  if (handle.session != 0 && handle.session != state.number) fail("belongs to another session; add it to this one");
  if (handle.index < 0 || static_cast<size_t>(handle.index) >= removed.size()) {
    fail("does not exist; " + (removed.empty() ? fmt::format("the scene has no {}s", kind)
                                               : fmt::format("give an index from 0 to {}", removed.size() - 1)));
  }
  if (removed[static_cast<size_t>(handle.index)]) fail("was removed; add it again");
  return handle.index;
}

}  // namespace

void Session::set_time(float time_s) {
  state_->check_between_frames();
  state_->changes |= state_->change_scene([&](CompiledScene& scene) { return scene.set_time(time_s); });
  state_->settings.time_s = state_->counters.time_s = time_s;
}

void Session::set_camera(const std::optional<CameraPose>& camera) {
  state_->check_between_frames();
  state_->edit([&](CompiledScene& scene) { return scene.set_camera(camera); });
}

void Session::set_transform(NodeHandle node, const Transform& transform) {
  state_->check_between_frames();
  const Index index = checked(node, state_->removed.nodes, *state_, "node");
  state_->edit([&](CompiledScene& scene) { return scene.set_transform(index, transform); });
}

void Session::set_light(LightHandle light, const PunctualLight& value) {
  state_->check_between_frames();
  const Index index = checked(light, state_->removed.lights, *state_, "light");
  state_->edit([&](CompiledScene& scene) { return scene.set_light(index, value); });
}

void Session::set_environment(const Environment& environment) {
  state_->check_between_frames();
  state_->edit([&](CompiledScene& scene) { return scene.set_environment(environment); });
}

void Session::set_material(MaterialHandle material, const Material& value) {
  state_->check_between_frames();
  const Index index = checked(material, state_->removed.materials, *state_, "material");
  state_->edit([&](CompiledScene& scene) { return scene.set_material(index, value); });
}

MaterialHandle Session::add_material(const Material& material) {
  state_->check_between_frames();
  const Index index = state_->scene->add_material(material);
  state_->removed.materials.push_back(false);
  return {index, state_->number};
}

MeshHandle Session::add_mesh(const Mesh& mesh) {
  state_->check_between_frames();
  Index index = kNone;
  state_->backend->run(kSceneChanges, [&] { index = state_->scene->add_mesh(mesh); });
  state_->removed.meshes.push_back(false);
  return {index, state_->number};
}

LightHandle Session::add_light(const PunctualLight& light) {
  state_->check_between_frames();
  const Index index = state_->scene->add_light(light);
  state_->removed.lights.push_back(false);
  return {index, state_->number};
}

NodeHandle Session::add_node(const Node& node) {
  state_->check_between_frames();
  State& s = *state_;
  if (node.parent != kNone) checked(NodeHandle(node.parent), s.removed.nodes, s, "node");
  if (node.light != kNone) checked(LightHandle(node.light), s.removed.lights, s, "light");
  for (const Index mesh : node.meshes) checked(MeshHandle(mesh), s.removed.meshes, s, "mesh");
  const Index index = s.scene->add_node(node);
  s.removed.nodes.push_back(false);
  return {index, s.number};
}

void Session::remove(NodeHandle node) {
  state_->check_between_frames();
  State& s = *state_;
  const Index index = checked(node, s.removed.nodes, s, "node");
  for (const Index gone : s.scene->remove_node(index)) s.removed.nodes[static_cast<size_t>(gone)] = true;
}

void Session::remove(MeshHandle mesh) {
  state_->check_between_frames();
  State& s = *state_;
  const Index index = checked(mesh, s.removed.meshes, s, "mesh");
  s.scene->remove_mesh(index);
  s.removed.meshes[static_cast<size_t>(index)] = true;
}

void Session::remove(LightHandle light) {
  state_->check_between_frames();
  State& s = *state_;
  const Index index = checked(light, s.removed.lights, s, "light");
  s.scene->remove_light(index);
  s.removed.lights[static_cast<size_t>(index)] = true;
}

NodeHandle Session::find_node(const std::string& name) const {
  const std::vector<Node>& nodes = state_->scene->source().nodes;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].name == name && !state_->removed.nodes[i]) return {static_cast<Index>(i), state_->number};
  }
  throw Error(ErrorCode::not_found,
              fmt::format("there is no node '{}' in the scene; the scene's list of nodes has the names", name));
}

}  // namespace relume
