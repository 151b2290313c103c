// Updates of a compiled scene between frames.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene/animation.h"
#include "scene/compiled_scene.h"
#include "scene/light_parameters.h"
#include "scene/medium.h"
#include "scene/mixtures.h"
#include "scene/placement.h"

namespace relume {
void CompiledScene::end_frame() {
  if (!was_moved_) return;
  keep_previous_positions();  // launches may throw; below, only a device that cannot move memory
  // Writing moves large arrays from a device and back.
  if (has_placed_instances_) {
    for (Instance& i : instances_.write()) i.previous_to_world = i.to_world;
    has_placed_instances_ = false;
  }
  previous_camera_view_ = camera_view_;
  lights_.mark_unchanged();
  point_view();
  was_moved_ = false;
}

Change CompiledScene::set_time(float time_s) {
  open_for_host();
  std::vector<Mat4> world = checked_world(time_s);
  return updated([&] {
    const float before_s = std::exchange(time_s_, time_s);
    bool is_placed = false;
    try {
      const Change change = animate_parameters();
      world_.swap(world);
      is_placed = true;
      return change | place_everything();
    } catch (...) {
      // The next update, which may be another one, must rebuild the scene at one time.
      time_s_ = before_s;
      if (is_placed) world_.swap(world);
      apply_parameter_animation();
      throw;
    }
  });
}

Change CompiledScene::set_camera(const std::optional<CameraPose>& camera) {
  if (camera) {
    validate(camera->camera, error_place(source_));
    if (!(max_component(abs(Vec3(camera->to_world[3]))) <= kMaxCoordinate))
      throw Error(fmt::format("{}: the camera is beyond {:g} m; move it closer to the origin", error_place(source_),
                              kMaxCoordinate));
  }
  open_for_host();
  const CameraView now = view_through(camera ? *camera : scene_camera(world_));
  return updated([&] {
    camera_pose_ = camera;
    if (is_stale_) return place_everything();
    const CameraView before = std::exchange(camera_view_, now);
    const bool moved_in_shutter = !camera_keys_.empty();
    if (shutter_.is_open()) pose_camera(camera ? std::vector<std::vector<Mat4>>() : key_worlds());
    point_view();
    find_camera_medium();
    const bool same_motion = moved_in_shutter == !camera_keys_.empty();
    if (same_view(before, camera_view_) && same_motion) return Change::none;
    was_moved_ = true;
    return Change::camera;
  });
}

Change CompiledScene::set_resolution(int width, int height) {
  open_for_host();
  const auto before = std::tuple(resolution_, camera_view_, previous_camera_view_);
  return updated([&] {
    try {
      resolution_ = {width, height};
      camera_view_ = view_through(camera());
      previous_camera_view_ = camera_view_;
      if (is_stale_) return place_everything();
      point_view();
      find_camera_medium();
    } catch (...) {
      // Buffers keep their size, so paths must not reach pixels beyond it.
      std::tie(resolution_, camera_view_, previous_camera_view_) = before;
      throw;
    }
    return Change::settings;
  });
}

Change CompiledScene::set_transform(Index node, const Transform& transform) {
  check_index(node, source_.nodes.size(), "node", error_place(source_));
  open_for_host();
  Node& target = source_.nodes[static_cast<size_t>(node)];
  Node before = target;
  std::vector<AnimationChannel> animation_before = source_.animation;
  target.transform = transform;
  target.matrix.reset();
  std::erase_if(source_.animation, [&](const AnimationChannel& channel) {
    return channel.node == node && is_transform(channel.property);
  });
  std::vector<Mat4> world;
  try {
    world = checked_world(time_s_);
  } catch (...) {
    target = std::move(before);
    source_.animation = std::move(animation_before);
    throw;
  }
  return updated([&] {
    world_ = std::move(world);
    extent_.add(placed_box(world_));
    set_bounds();
    return place_everything();
  });
}

Change CompiledScene::set_light(Index light, const PunctualLight& value) {
  check_index(light, source_.lights.size(), "light", error_place(source_));
  validate(value, error_place(source_));
  open_for_host();
  return updated([&] {
    PunctualLight& target = source_.lights[static_cast<size_t>(light)];
    const bool renumbers = type_of(target).at_infinity != type_of(value).at_infinity;  // those at infinity come last
    target = value;
    end_parameter_animation(AnimatedPart::light, light);
    if (is_stale_) return place_everything();
    collect_lights();
    was_moved_ = true;
    return renumbers ? Change::lights | Change::light_list : Change::lights;
  });
}

Change CompiledScene::set_environment(const Environment& environment) {
  validate(environment, error_place(source_));
  open_for_host();
  return updated([&] {
    Environment before = std::exchange(source_.environment, environment);
    try {
      if (is_stale_) return place_everything();
      use_environment();
    } catch (...) {
      source_.environment = std::move(before);  // it may be smaller, so that the next update succeeds
      throw;
    }
    was_moved_ = true;
    return Change::lights | Change::light_list;
  });
}

Change CompiledScene::set_material(Index material, const Material& value) {
  check_index(material, source_.materials.size(), "material", error_place(source_));
  validate(value, error_place(source_));
  for (const TextureRef* ref : texture_refs(value)) {
    if (ref->texture != kNone && static_cast<size_t>(ref->texture) >= source_.textures.size())
      throw Error(fmt::format("{}: material '{}' refers to texture {}, but the scene has {}; use an existing one",
                              error_place(source_), value.name, ref->texture, source_.textures.size()));
  }
  check_mixture(material, value);
  open_for_host();
  return updated([&] {
    end_parameter_animation(AnimatedPart::material, material);
    return replace_material(material, value);
  });
}

void CompiledScene::end_parameter_animation(AnimatedPart part, Index index) {
  std::erase_if(source_.parameter_animation,
                [&](const ParameterChannel& c) { return c.part == part && c.index == index; });
}

void CompiledScene::check_mixture(Index material, const Material& value) const {
  const auto parts_of = [&](size_t i) {
    const Material& m = i == static_cast<size_t>(material) ? value : source_.materials[i];
    return std::pair(m.mix_first, m.mix_second);
  };
  check_mixtures(std::max(source_.materials.size(), static_cast<size_t>(material) + 1), parts_of, error_place(source_));
}

Change CompiledScene::replace_material(Index material, const Material& value) {
  Material& target = source_.materials[static_cast<size_t>(material)];
  const bool emits = !is_black(target.emission) || !is_black(value.emission);
  const auto index = static_cast<uint32_t>(material);
  const MaterialData before = materials_.read()[index];
  const bool was_stale = std::exchange(is_stale_, true);
  target = value;
  if (was_stale) return place_everything();
  build_materials();
  refresh_view();
  const MaterialData& now = materials_.read()[index];
  const bool other_filters = before.has_alpha() != now.has_alpha() || before.cull_back_faces != now.cull_back_faces;
  const std::span<const MeshView> meshes = meshes_.read();
  view_.accel = {};  // as in update_accel()
  for (uint32_t m = 0; m < meshes.size() && other_filters; ++m) {
    if (meshes[m].material == index) accel_->set_filters(m, accel_instances(), now.has_alpha(), now.cull_back_faces);
  }
  view_.accel = accel_->view();
  if (emits) {
    lights_.discard_texture_tables();
    collect_lights();  // finds the camera's medium, too
    was_moved_ = true;
  } else {
    find_camera_medium();
  }
  is_stale_ = false;
  return emits ? Change::materials | Change::lights : Change::materials;
}

std::vector<Mat4> CompiledScene::checked_world(float time_s) const {
  std::vector<Mat4> world = world_matrices(source_, time_s);
  check_placement(source_, world, error_place(source_));
  check_joints(source_, joint_matrices(source_, world));
  check_extent(placed_box(world));
  view_through(scene_camera(world));
  return world;
}

Change CompiledScene::place_everything() {
  const bool was_stale = std::exchange(is_stale_, true);
  visible_ = visible_nodes(source_, time_s_);
  Change change = was_stale ? Change::any : Change::none;
  if (was_stale) build_materials();
  const CameraView camera_before = std::exchange(camera_view_, view_through(camera()));
  if (!same_view(camera_before, camera_view_)) change |= Change::camera;
  const std::vector<uint32_t> deformed = deform_meshes();
  bool moved = place_instances() || !deformed.empty();
  moved = pose_shutter() || moved;
  if (moved) change |= Change::geometry;
  if (was_stale) {
    build_accel();
    lights_.discard_texture_tables();
    use_environment();  // which collects the lights, too
  } else {
    if (moved) update_accel(deformed);
    collect_lights();
  }
  for (const Light& light : view_.lights.lights) {
    if (light.changed) change |= Change::lights;
  }
  if (change != Change::none) was_moved_ = true;
  is_stale_ = false;
  return change;
}

void CompiledScene::collect_lights() {
  refresh_view();
  lights_.collect(view_, instances_.write(), source_, {world_, visible_}, bounds_);
  refresh_view();
}

CameraPose CompiledScene::scene_camera(const std::vector<Mat4>& world) const {
  return {camera_node_ == kNone ? default_camera_ : world[static_cast<size_t>(camera_node_)], camera_};
}

CameraPose CompiledScene::camera() const { return camera_pose_ ? *camera_pose_ : scene_camera(world_); }

bool CompiledScene::place_instances() {
  has_placed_instances_ = true;
  const bool first = instances_.empty();
  instances_.resize(mesh_instances_.size());
  const std::span<Instance> instances = instances_.write();
  bool moved = false;
  const JointMatrices joints = joint_matrices(source_, world_);
  for (size_t i = 0; i < mesh_instances_.size(); ++i) {
    Instance& instance = instances[i];
    instance.mesh = mesh_of_instance_[i];
    instance.in_world_space = world_space_[i];
    const bool visible = visible_[mesh_instances_[i].node];
    moved = moved || visible != instance.visible;
    instance.visible = visible;
    if (mesh_instances_[i].skinned && mesh_instances_[i].deforms) {
      const Index skin = source_.nodes[mesh_instances_[i].node].skin;
      instance.orientation = mirrors(joints[static_cast<size_t>(skin)]) ? -1.0f : 1.0f;
    }
    if (instance.in_world_space) continue;
    const Mat4 m = world_[mesh_instances_[i].node] * mesh_instances_[i].local;
    const Affine now{Mat3(m), Vec3(m[3])};
    moved = moved || now.linear != instance.to_world.linear || now.translation != instance.to_world.translation;
    if (first) instance.previous_to_world = now;
    instance.to_world = now;
    instance.normal_to_world = normal_matrix(now.linear);
    instance.orientation = glm::dot(now.linear[0], instance.normal_to_world[0]) < 0.0f ? -1.0f : 1.0f;
  }
  return moved;
}

CameraView CompiledScene::view_through(const CameraPose& placed) const {
  const auto& [m, camera] = placed;
  const std::optional<Mat3> axes = orientation(m);
  if (!axes)
    throw Error(
        fmt::format("{}: camera '{}' has no direction, because a scale of 0 collapses its axes; change the scale of "
                    "its node or its ancestors",
                    error_place(source_), camera.name));
  const float aspect = static_cast<float>(resolution_.x) / static_cast<float>(resolution_.y);
  CameraView c;
  c.projection = camera.projection;
  c.position = Vec3(m[3]);
  c.axes = {(*axes)[0], (*axes)[1], (*axes)[2]};
  const float half =
      camera.projection == Projection::orthographic ? camera.half_height : std::tan(0.5f * camera.fov_y_rad);
  c.half_extent = {half * aspect, half};
  c.lens_radius = camera.lens_radius;
  c.focus_distance = camera.focus_distance;
  c.resolution = Vec2(resolution_);
  return c;
}

void CompiledScene::empty_view() noexcept {
  is_stale_ = true;
  was_moved_ = true;
  lights_.clear();
  point_view();
  view_.accel = {};
}

void CompiledScene::point_view() {
  view_.vertices = vertices_.view();
  view_.triangles = triangles_.view();
  view_.uv1 = uv1_.view();
  view_.colors = colors_.view();
  view_.previous_positions = previous_positions_.view();
  view_.meshes = meshes_.view();
  view_.instances = instances_.view();
  view_.materials = materials_.view();
  view_.layers = layers_.view();
  view_.textures = textures_.view();
  view_.energy_tables = energy_tables_.view();
  view_.lights = lights_.view();
  const bool moves_in_shutter = !instance_keys_.empty() || !vertex_keys_.empty();
  view_.motion = {instance_keys_.view(), vertex_keys_.view(), moves_in_shutter ? shutter_.key_count() : 0};
  view_.camera = camera_view_;
  view_.camera.shutter_open = shutter_.is_open();
  view_.camera.frame_time = frame_time_;
  view_.camera.keys = camera_keys_.view();
  view_.previous_camera = previous_camera_view_;
}

void CompiledScene::refresh_view() {
  point_view();
  const std::span<const MaterialData> materials = materials_.read();
  const std::span<const Instance> instances = instances_.read();
  const std::span<const MeshView> meshes = meshes_.read();
  const std::span<const LayerData> layers = layers_.read();
  view_.absorbs =
      std::any_of(materials.begin(), materials.end(), [](const MaterialData& m) { return !is_black(m.absorption); });
  view_.culls_back_faces =
      std::any_of(materials.begin(), materials.end(), [](const MaterialData& m) { return m.cull_back_faces; });
  const bool any_disperses =
      std::any_of(materials.begin(), materials.end(), [](const MaterialData& m) { return m.dispersion > 0.0f; });
  view_.disperses = any_disperses && std::any_of(instances.begin(), instances.end(), [&](const Instance& i) {
                      const MaterialData& material = materials[meshes[i.mesh].material];
                      return material.dispersion > 0.0f || material.is_mixture();
                    });
  energy_tables_.update(
      {.anisotropic = std::any_of(layers.begin(), layers.end(), [](const LayerData& l) { return l.anisotropy > 0; }),
       .sheen =
           std::any_of(layers.begin(), layers.end(), [](const LayerData& l) { return !is_black(l.sheen_color); })});
  view_.energy_tables = energy_tables_.view();
  find_camera_medium();
}

void CompiledScene::find_camera_medium() {
  if (!accel_ || edited_) return;  // lacks the added parts; commit_edits() calls this again
  // Rays in every direction leave a closed mesh. A sheet of glass, or a gap in a mesh, affects one direction only.
  const auto around = [&](const Vec3& w) { return absorption_around(view_, {camera_view_.position, w, kInfinity}); };
  view_.camera_medium = glm::min(around(-camera_view_.axes.n), around(camera_view_.axes.n));
}

}  // namespace relume
