// Poses of a compiled scene within an open shutter.
#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/compiled_scene.h"
#include "scene/placement.h"

namespace relume {
namespace {

/// Whether the mesh keeps its volume between two keys. Linear interpolation collapses it at a turn by 180°, or where
/// one key mirrors it.
bool keeps_volume(const Mat4& a, const Mat4& b) {
  constexpr int kSteps = 8;
  constexpr double kLeast = 1e-3;  // of the smaller volume at the keys
  const glm::dmat3 first{glm::dmat4(a)};
  const glm::dmat3 second{glm::dmat4(b)};
  const double at_first = glm::determinant(first);
  const double least = kLeast * std::min(std::fabs(at_first), std::fabs(glm::determinant(second)));
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const double volume = glm::determinant(first * (1.0 - share) + second * share);
    if (!(std::copysign(1.0, at_first) * volume > least)) return false;
  }
  return true;
}

/// Whether rays can follow an instance between these keys. Others rest at the middle.
bool can_move(std::span<const Mat4> keys) {
  for (size_t k = 0; k < keys.size(); ++k) {
    if (!within_reach(keys[k]) || (k > 0 && !keeps_volume(keys[k - 1], keys[k]))) return false;
  }
  return std::any_of(keys.begin(), keys.end(), [&](const Mat4& m) { return m != keys.front(); });
}

bool all_within_reach(const JointMatrices& joints) {
  return std::all_of(joints.begin(), joints.end(),
                     [](const std::vector<Mat4>& skin) { return std::all_of(skin.begin(), skin.end(), within_reach); });
}

}  // namespace

Change CompiledScene::set_shutter(const Shutter& shutter) {
  if (shutter == shutter_) return Change::none;
  open_for_host();
  return updated([&] {
    const Shutter before = std::exchange(shutter_, shutter);
    try {
      return place_everything() | Change::any;
    } catch (...) {
      shutter_ = before;
      throw;
    }
  });
}

void CompiledScene::share_time(float time) { frame_time_ = view_.camera.frame_time = time; }

std::vector<float> CompiledScene::key_times() const {
  std::vector<float> times;
  const uint32_t count = shutter_.key_count();
  for (uint32_t k = 0; k < count; ++k) {
    const float share = static_cast<float>(k) / static_cast<float>(count - 1) - 0.5f;  // exactly 0 in the middle
    times.push_back(time_s_ + shutter_.seconds * share);
  }
  return times;
}

std::vector<std::vector<Mat4>> CompiledScene::key_worlds() const {
  std::vector<std::vector<Mat4>> worlds;
  for (const float time_s : key_times()) worlds.push_back(world_matrices(source_, time_s));
  return worlds;
}

bool CompiledScene::pose_shutter() {
  const bool had_keys = !matrix_keys_.empty() || !vertex_keys_.empty() || !camera_keys_.empty();
  if (!shutter_.is_open() && !had_keys) return false;
  const std::vector<std::vector<Mat4>> worlds = key_worlds();
  const bool moves = pose_instances(worlds);
  pose_camera(worlds);
  const bool deforms = pose_deforming(worlds);
  return moves || deforms;
}

bool CompiledScene::pose_instances(const std::vector<std::vector<Mat4>>& worlds) {
  std::vector<Mat4> all;
  bool changed = false;
  const std::span<Instance> instances = instances_.write();
  for (size_t i = 0; i < mesh_instances_.size(); ++i) {
    const MeshInstance& placed = mesh_instances_[i];
    const uint32_t before = std::exchange(instances[i].first_key, kNoKeys);
    if (!world_space_[i] && moves_[placed.node] && !worlds.empty()) {
      std::vector<Mat4> own;
      for (const std::vector<Mat4>& world : worlds) own.push_back(world[placed.node] * placed.local);
      if (can_move(own)) {
        instances[i].first_key = static_cast<uint32_t>(all.size());
        all.insert(all.end(), own.begin(), own.end());
      }
    }
    changed = changed || instances[i].first_key != before;
  }
  changed = changed || all != matrix_keys_;
  if (!changed) return false;  // the acceleration structure keeps pointers to the matrices
  matrix_keys_.swap(all);
  std::vector<Affine> affine;
  for (const Mat4& m : matrix_keys_) affine.push_back({Mat3(m), Vec3(m[3])});
  instance_keys_.assign(affine);
  return true;
}

void CompiledScene::pose_camera(const std::vector<std::vector<Mat4>>& worlds) {
  std::vector<CameraShutterKey> keys;
  for (size_t k = 0; k < worlds.size() && camera_node_ != kNone && !camera_pose_; ++k) {
    const Mat4& m = worlds[k][static_cast<size_t>(camera_node_)];
    const std::optional<Mat3> axes = orientation(m);
    if (!axes || !within_reach(m)) return camera_keys_.clear();
    keys.push_back({Vec3(m[3]), {(*axes)[0], (*axes)[1], (*axes)[2]}});
  }
  const bool moves = std::any_of(keys.begin(), keys.end(), [&](const CameraShutterKey& key) {
    const CameraShutterKey& first = keys.front();
    return key.position != first.position || key.axes.t != first.axes.t || key.axes.n != first.axes.n;
  });
  if (!moves) keys.clear();
  camera_keys_.assign(keys);
}

bool CompiledScene::pose_deforming(const std::vector<std::vector<Mat4>>& worlds) {
  const bool had_keys = !vertex_keys_.empty();
  vertex_keys_.clear();
  std::vector<ShutterPose> poses;
  const std::vector<float> times = key_times();
  for (size_t k = 0; k < worlds.size(); ++k) poses.push_back({joint_matrices(source_, worlds[k]), times[k]});
  const bool valid =
      std::all_of(poses.begin(), poses.end(), [](const ShutterPose& pose) { return all_within_reach(pose.joints); });
  size_t room = 0;
  for (uint32_t n = 0; n < deforming_.size(); ++n) {
    const DeformingMeshes::Source& source = deforming_.source(n);
    meshes_.write()[source.compiled_mesh].first_key = kNoKeys;
    room += source.vertex_count * poses.size() + 1;
  }
  if (poses.empty() || !valid || deforming_.size() == 0) return had_keys;
  vertex_keys_.resize(room);
  bool deforms = false;
  uint32_t next = 0;
  for (uint32_t n = 0; n < deforming_.size(); ++n) {
    const DeformingMeshes::Source& source = deforming_.source(n);
    if (next - source.first_vertex == kNoKeys) ++next;
    const auto size = static_cast<uint32_t>(source.vertex_count * poses.size());
    const View<Vertex> target{vertex_keys_.mutable_view().data + next, size};
    if (deforming_.pose_keys(n, source_, poses, target, launcher_)) {
      MeshView& mesh = meshes_.write()[source.compiled_mesh];
      mesh.first_key = next - source.first_vertex;
      mesh.key_stride = source.vertex_count;
      deforms = true;
    }
    next += size;
  }
  if (!deforms) vertex_keys_.clear();
  open_for_host();  // launches have ended the host's access
  return deforms || had_keys;
}

std::vector<uint32_t> CompiledScene::give_keys_to_accel() {
  std::vector<uint32_t> changed = keyed_meshes_;
  keyed_meshes_.clear();
  std::vector<AccelMeshKeys> keys;
  for (uint32_t n = 0; n < deforming_.size() && !vertex_keys_.empty(); ++n) {
    const DeformingMeshes::Source& source = deforming_.source(n);
    const MeshView& mesh = meshes_.read()[source.compiled_mesh];
    if (mesh.first_key == kNoKeys) continue;
    // Indices count from the start of all vertices, so the first key begins before this mesh's.
    const auto* const first = reinterpret_cast<const std::byte*>(&vertex_keys_.read().data()->position.x);
    const ptrdiff_t offset = ptrdiff_t{static_cast<int32_t>(mesh.first_key)} * ptrdiff_t{sizeof(Vertex)};
    keys.push_back({.mesh = source.compiled_mesh,
                    .positions = reinterpret_cast<const float*>(first + offset),
                    .stride = sizeof(Vertex) * mesh.key_stride,
                    .vertex_count = size_t{source.first_vertex} + source.vertex_count,
                    .count = shutter_.key_count()});
    keyed_meshes_.push_back(source.compiled_mesh);
  }
  changed.insert(changed.end(), keyed_meshes_.begin(), keyed_meshes_.end());
  if (!changed.empty()) accel_->set_keys(keys);
  return changed;
}

}  // namespace relume
