#include "accel/embree_accel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "accel/embree/device.h"
#include "accel/embree/hit_filter.h"
#include "accel/host_accel.h"
#include "accel/refit_cost.h"
#include "core/activity.h"
#include "core/parallel.h"

namespace relume {
namespace {

/// Whether Embree can transform rays into the space of an instance. The result must be finite, or Embree terminates the
/// process.
bool has_inverse(const Mat4& to_world) {
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(glm::dmat4(to_world)));
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!(std::fabs(inverse[column][row]) <= kMostInverse)) return false;
    }
  }
  return true;
}

/// Moves a node by one matrix, or by those at `count` keys of the shutter, which Embree interpolates linearly. The
/// scene must be committed afterwards.
void place(RTCGeometry node, const Mat4* to_world, uint32_t count, bool visible) {
  if (visible && std::all_of(to_world, to_world + count, has_inverse)) {
    rtcSetGeometryTimeStepCount(node, count);
    for (uint32_t k = 0; k < count; ++k)
      rtcSetGeometryTransform(node, k, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &to_world[k]);
    rtcEnableGeometry(node);
  } else {
    rtcDisableGeometry(node);
  }
  rtcCommitGeometry(node);
}
void place(RTCGeometry node, const AccelInstance& instance) {
  const bool moves = instance.key_count > 0;
  place(node, moves ? instance.keys : &instance.to_world, moves ? instance.key_count : 1, instance.visible);
}

/// Sets the vertices of a geometry, at all keys of the shutter if there are any. It must be committed afterwards.
void set_vertices(RTCGeometry geometry, const AccelMesh& mesh) {
  const auto set = [&](uint32_t slot, const void* positions, size_t count) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, slot, RTC_FORMAT_FLOAT3, positions, 0,
                               mesh.position_stride, count);
  };
  rtcSetGeometryTimeStepCount(geometry, std::max(mesh.key_count, 1u));
  if (mesh.key_count == 0) set(0, mesh.positions, mesh.vertex_count);
  for (uint32_t k = 0; k < mesh.key_count; ++k)
    set(k, reinterpret_cast<const std::byte*>(mesh.key_positions) + k * mesh.key_stride, mesh.key_vertex_count);
}

}  // namespace

struct EmbreeAccel::State {
  embree::Device device;
  RTCScene scene = nullptr;  ///< top-level scene
  /// Static geometry in world space: the top-level scene itself or, if anything moves, a scene below it that is built
  /// once.
  RTCScene still = nullptr;
  std::vector<RTCScene> mesh_scenes;                             ///< by mesh; null unless some instance needs it
  std::vector<std::pair<uint32_t, RTCGeometry>> instance_nodes;  ///< instance index, geometry (held by the scene)
  std::vector<GeometryContext> contexts;                         ///< one per instance
  std::vector<AccelMesh> meshes;
  std::vector<RefitCost> refit_costs;  ///< by mesh
  std::vector<uint8_t> keyed;          ///< by mesh: whether its geometry has the vertices of keys
  std::vector<AccelInstance> instances;
  OpacityFunction opacity;
  HostAccelData host;
  bool culls = false;  ///< whether any mesh culls its back faces
  bool robust = false;

  ~State() {
    if (still && still != scene) rtcReleaseScene(still);
    if (scene) rtcReleaseScene(scene);
    for (RTCScene s : mesh_scenes) {
      if (s) rtcReleaseScene(s);
    }
  }

  RTCSceneFlags flags_of(bool dynamic) const {
    return (dynamic ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE) |
           (culls ? embree::kQueryFilterFlag : RTC_SCENE_FLAG_NONE) |
           (robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  }

  RTCScene new_scene(bool dynamic = false) const {
    RTCScene result = rtcNewScene(device.get());
    rtcSetSceneFlags(result, flags_of(dynamic));
    return result;
  }

  /// Enables culling when the first mesh culls its back faces.
  void start_culling() {
    culls = true;
    for (size_t mesh = 0; mesh < mesh_scenes.size(); ++mesh) {
      if (!mesh_scenes[mesh]) continue;
      rtcSetSceneFlags(mesh_scenes[mesh], flags_of(meshes[mesh].deforms));
      rtcCommitScene(mesh_scenes[mesh]);
    }
    rtcSetSceneFlags(still, flags_of(false));
    if (still != scene) rtcCommitScene(still);
    rtcSetSceneFlags(scene, flags_of(false));
  }

  RTCGeometry new_triangles(const AccelMesh& mesh, GeometryContext* context) const {
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions, 0,
                               mesh.position_stride, mesh.vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices, 0,
                               3 * sizeof(uint32_t), mesh.triangle_count);
    set_filter(geometry, context);
    rtcCommitGeometry(geometry);
    return geometry;
  }

  RTCScene new_mesh_scene(const AccelMesh& mesh, GeometryContext* context) const {
    // Embree refits only in dynamic scenes of low quality. It then builds the geometry's BVH with medium quality.
    RTCScene result = new_scene(mesh.deforms);
    RTCGeometry geometry = new_triangles(mesh, context);
    if (mesh.deforms) {
      rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
      rtcCommitGeometry(geometry);
    }
    rtcAttachGeometry(result, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(result, mesh.deforms ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(result);
    return result;
  }

  /// Refits the BVH of a deforming mesh to its vertices, or rebuilds it.
  void refit(uint32_t mesh) {
    const RTCScene owner = mesh_scenes[mesh];
    if (!owner) return;  // no triangles
    const RTCGeometry geometry = rtcGetGeometry(owner, 0);
    if (meshes[mesh].key_count > 0 || keyed[mesh] != 0) return rebuild_with_keys(mesh, owner, geometry);
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    if (refit_costs[mesh].has_grown(meshes[mesh])) {
      rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0);  // changed indices make Embree rebuild
      refit_costs[mesh].reset(meshes[mesh]);
    }
    rtcCommitGeometry(geometry);
    rtcCommitScene(owner);
  }

  /// Rebuilds the BVH for the keys of the shutter, or after their end: Embree does not refit it over time.
  void rebuild_with_keys(uint32_t mesh, RTCScene owner, RTCGeometry geometry) {
    keyed[mesh] = meshes[mesh].key_count > 0 ? 1 : 0;
    set_vertices(geometry, meshes[mesh]);
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0);
    rtcCommitGeometry(geometry);
    rtcCommitScene(owner);
    refit_costs[mesh].reset(meshes[mesh]);
  }

  /// Takes new transforms and visibility.
  void assign(std::span<const AccelInstance> placed) {
    instances.assign(placed.begin(), placed.end());
    follow_mirrors();
    host = {scene, meshes.data(), instances.data(), opacity};
  }

  /// Copies the mirroring of skins: a skinned mesh has a single instance.
  void follow_mirrors() {
    for (const AccelInstance& instance : instances) {
      if (meshes[instance.mesh].deforms) meshes[instance.mesh].mirrored = instance.mirrored;
    }
  }

  void add_still() {
    rtcSetSceneBuildQuality(still, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(still);
    RTCGeometry node = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(node, still);
    place(node, AccelInstance{});
    rtcAttachGeometryByID(scene, node, kStillNode);
    rtcReleaseGeometry(node);
  }

  void add_instance(uint32_t index, const AccelInstance& instance) {
    RTCGeometry node = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(node, mesh_scenes[instance.mesh]);
    place(node, instance);
    rtcAttachGeometryByID(scene, node, id_of(index));
    rtcReleaseGeometry(node);
    instance_nodes.emplace_back(index, node);
  }
};

EmbreeAccel::EmbreeAccel(std::span<const AccelMesh> meshes, std::span<const AccelInstance> instances,
                         OpacityFunction opacity, bool robust)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.opacity = opacity;
  s.robust = robust;
  s.meshes.assign(meshes.begin(), meshes.end());
  s.keyed.assign(meshes.size(), 0);
  for (const AccelMesh& mesh : s.meshes) s.refit_costs.emplace_back(mesh);
  const Activity activity("building the acceleration structure");
  s.culls = std::any_of(meshes.begin(), meshes.end(), [](const AccelMesh& mesh) { return mesh.culls_back_faces; });
  s.scene = s.new_scene();
  s.assign(instances);
  const bool anything_moves =
      std::any_of(instances.begin(), instances.end(), [&](const auto& i) { return i.moves || meshes[i.mesh].deforms; });
  s.still = anything_moves ? s.new_scene() : s.scene;
  // Instances of one mesh share its scene; the context of instance i is contexts[i].
  s.contexts.resize(instances.size());
  s.mesh_scenes.resize(meshes.size(), nullptr);
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const AccelInstance& instance = instances[i];
    const AccelMesh& mesh = meshes[instance.mesh];
    if (mesh.triangle_count == 0 || (stands_still(instance, mesh) && !instance.visible)) continue;
    s.contexts[i] = {&s.opacity, &s.meshes[instance.mesh], id_of(i)};
    if (stands_still(instance, mesh)) {
      RTCGeometry geometry = s.new_triangles(mesh, &s.contexts[i]);
      rtcAttachGeometryByID(s.still, geometry, id_of(i));
      rtcReleaseGeometry(geometry);
      continue;
    }
    if (!s.mesh_scenes[instance.mesh]) s.mesh_scenes[instance.mesh] = s.new_mesh_scene(mesh, &s.contexts[i]);
    s.add_instance(i, instance);
  }
  if (anything_moves) s.add_still();
  rtcSetSceneBuildQuality(s.scene, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(s.scene);
  s.device.check();
}

EmbreeAccel::~EmbreeAccel() = default;

void EmbreeAccel::set_keys(std::span<const AccelMeshKeys> keys) { assign_keys(state_->meshes, keys); }

void EmbreeAccel::update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed) {
  state_->assign(instances);
  parallel_tasks(deformed.size(), [&](size_t i) { state_->refit(deformed[i]); });
  for (const auto& [index, node] : state_->instance_nodes) place(node, instances[index]);
  rtcCommitScene(state_->scene);
  state_->device.check();
}

void EmbreeAccel::set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity,
                              bool culls_back_faces) {
  State& s = *state_;
  s.meshes[mesh].needs_opacity = needs_opacity;
  s.meshes[mesh].culls_back_faces = culls_back_faces;
  if (culls_back_faces && !s.culls) s.start_culling();
  for (uint32_t i = 0; i < instances.size(); ++i) {
    if (instances[i].mesh != mesh || !s.contexts[i].opacity) continue;  // no geometry without triangles
    const bool still = stands_still(instances[i], s.meshes[mesh]);
    const RTCScene owner = still ? s.still : s.mesh_scenes[mesh];
    const RTCGeometry geometry = rtcGetGeometry(owner, still ? id_of(i) : 0);
    set_filter(geometry, &s.contexts[i]);
    rtcCommitGeometry(geometry);
    if (owner != s.scene) rtcCommitScene(owner);
    if (!still) break;  // the other instances share the geometry
  }
  update(instances, {});
}

AccelView EmbreeAccel::view() const { return {{}, {&state_->host}, AccelChoice::embree}; }

size_t EmbreeAccel::memory_bytes() const { return state_->device.memory_bytes(); }

std::string EmbreeAccel::embree_version() { return embree::Device().version(); }

}  // namespace relume
