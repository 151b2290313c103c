// The acceleration structure of a compiled scene.
#include <algorithm>

#include "core/clock.h"
#include "scene/compiled_scene.h"
#include "scene/surface_point.h"

namespace relume {
namespace {

float accel_opacity(const void* context, uint32_t instance, uint32_t primitive, float u, float v) {
  return opacity(*static_cast<const SceneView*>(context), instance, primitive, u, v);
}

}  // namespace

std::vector<AccelInstance> CompiledScene::accel_instances() const {
  std::vector<AccelInstance> result;
  const std::span<const Instance> instances = instances_.read();
  for (size_t k = 0; k < instances.size(); ++k) {
    const Instance& i = instances[k];
    Mat4 m(i.to_world.linear);
    m[3] = Vec4(i.to_world.translation, 1.0f);
    const bool keyed = i.first_key != kNoKeys;
    result.push_back({.mesh = i.mesh,
                      .to_world = m,
                      .in_world_space = i.in_world_space,
                      .moves = moves_[mesh_instances_[k].node],
                      .visible = i.visible,
                      .mirrored = i.in_world_space && i.orientation < 0,
                      .keys = keyed ? &matrix_keys_[i.first_key] : nullptr,
                      .key_count = keyed ? shutter_.key_count() : 0});
  }
  return result;
}

void CompiledScene::build_accel() {
  const std::span<const Vertex> vertices = vertices_.read();
  const std::span<const UVec3> triangles = triangles_.read();
  const std::span<const MaterialData> materials = materials_.read();
  std::vector<AccelMesh> meshes;
  for (const MeshView& m : meshes_.read()) {
    AccelMesh a;
    a.positions = &vertices.data()->position.x;
    a.position_stride = sizeof(Vertex);
    a.vertex_count = vertices.size();
    a.indices = m.triangle_count ? &triangles[m.first_triangle].x : nullptr;
    a.triangle_count = m.triangle_count;
    a.needs_opacity = materials[m.material].has_alpha();
    a.culls_back_faces = materials[m.material].cull_back_faces;
    a.deforms = m.deforms;
    meshes.push_back(a);
  }
  view_.accel = {};  // vertices may have moved: if this fails, no ray may read them
  const double start_s = now_s();
  accel_ =
      make_accel(accel_choice_, meshes, accel_instances(), OpacityFunction{accel_opacity, &view_}, vertices_.memory());
  keyed_meshes_.clear();
  if (const std::vector<uint32_t> keyed = give_keys_to_accel(); !keyed.empty())
    accel_->update(accel_instances(), keyed);
  accel_build_s_ = now_s() - start_s;
  view_.accel = accel_->view();
}

void CompiledScene::update_accel(std::span<const uint32_t> deformed) {
  view_.accel = {};  // update() may move the arrays; if it throws, rays must not read the old ones
  std::vector<uint32_t> meshes(deformed.begin(), deformed.end());
  for (const uint32_t mesh : give_keys_to_accel()) {
    if (std::find(meshes.begin(), meshes.end(), mesh) == meshes.end()) meshes.push_back(mesh);
  }
  accel_->update(accel_instances(), meshes);
  view_.accel = accel_->view();
}

}  // namespace relume
