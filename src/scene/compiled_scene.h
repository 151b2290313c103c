// Compiles a scene into flat arrays, lights and an acceleration structure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "accel/accel_structure.h"
#include "core/array.h"
#include "core/box.h"
#include "core/change.h"
#include "materials/energy_table_arrays.h"
#include "scene/deforming_meshes.h"
#include "scene/light_builder.h"
#include "scene/scene_view.h"
#include "scene/shutter.h"
#include "scene/texture_store.h"

namespace relume {

/// Options of scene compilation.
struct CompileOptions {
  std::string camera = {};     ///< name or index of a camera node; empty: the first
  std::string animation = {};  ///< as for select_animation()
  float time_s = 0;
  int width = 1;  ///< image size, pixels
  int height = 1;
  TextureFilter texture_filter = TextureFilter::linear;
  std::vector<Index> movable = {};  ///< nodes for set_transform(), in addition to animated ones
  AccelChoice accel = AccelChoice::embree;
  Shutter shutter = {};
};

/// Finds the node of the camera with that name or number. With an empty name: the first camera, or kNone without
/// cameras. Throws Error with the existing names.
Index find_camera(const Scene& scene, const std::string& name);

/// Owns all data of a SceneView. Not movable: kernels and acceleration structures store its addresses.
class CompiledScene {
 public:
  /// Moves the arrays of the scene into their kernel layout and frees them. Throws Error if the camera does not exist,
  /// and as validate(). `memory`: for the arrays of the view. `launcher`: runs kernels on them. Both must outlive the
  /// scene.
  CompiledScene(Scene scene, const CompileOptions& options, Memory& memory, SceneLauncher& launcher);
  /// The same with host_scene_launcher().
  CompiledScene(Scene scene, const CompileOptions& options, Memory& memory = host_memory())
      : CompiledScene(std::move(scene), options, memory, host_scene_launcher(denormals_with(options.accel))) {}
  CompiledScene(const CompiledScene&) = delete;
  CompiledScene& operator=(const CompiledScene&) = delete;

  /// Ends a frame: current positions become those of the previous frame, and no light counts as changed. Changes
  /// nothing if memory is missing.
  void end_frame();

  /// Moves animated nodes. This and the following functions return the changes. They throw Error for values that
  /// kernels cannot handle (a camera collapsed by a scale of 0, a node beyond kMaxCoordinate). The scene then stays
  /// unchanged. If memory is missing or a device fails, kernels may get a scene without geometry and lights until the
  /// next of them succeeds. The time, the environment and the image size then keep their values; other changes take
  /// effect with the next.
  Change set_time(float time_s);
  /// Opens or closes the shutter.
  Change set_shutter(const Shutter& shutter);
  const Shutter& shutter() const { return shutter_; }
  /// Sets the time of all paths of the next frame within the shutter; negative: each path has a time of its own.
  void share_time(float time);
  /// Uses another camera, which rests while the shutter is open; std::nullopt restores that of the scene.
  Change set_camera(const std::optional<CameraPose>& camera);
  /// Sets the transform of a node and ends its animation. The node or an ancestor must be movable.
  Change set_transform(Index node, const Transform& transform);
  Change set_light(Index light, const PunctualLight& value);
  Change set_environment(const Environment& environment);
  /// Replaces the parameters of a material. Its textures must belong to the scene.
  Change set_material(Index material, const Material& value);
  /// Sets the image size.
  Change set_resolution(int width, int height);
  /// Whether one of them failed, so that kernels get an empty scene until the next.
  bool is_stale() const { return is_stale_; }

  /// Add parts and return their indices. Nodes refer to existing meshes, lights and parents; an added node is movable.
  /// Throw Error for invalid values and references, std::bad_alloc if memory is missing; then nothing is added.
  Index add_material(const Material& material);
  Index add_mesh(const Mesh& mesh);
  Index add_light(const PunctualLight& light);
  Index add_node(const Node& node);
  /// Removes a node and its descendants, and returns them. Other indices stay valid.
  std::vector<Index> remove_node(Index node);
  /// Remove a mesh or a light without nodes. Throw Error if a node uses it.
  void remove_mesh(Index mesh);
  void remove_light(Index light);
  /// Rebuilds the structures affected by added or removed parts, also where adding failed. Must precede any other use
  /// of the scene.
  Change commit_edits();

  bool movable(Index node) const { return moves_[static_cast<size_t>(node)]; }
  CameraPose camera() const;
  /// Node of an instance.
  Index node_of(uint32_t instance) const { return static_cast<Index>(mesh_instances_[instance].node); }

  /// The scene for kernels.
  const SceneView& view() const { return view_; }
  const Scene& source() const { return source_; }
  bool in_studio() const { return in_studio_; }
  /// Notes on defaults for data missing from the file, one sentence each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Bytes of geometry, lights, textures, environment and acceleration structure.
  size_t memory_bytes() const;
  /// Time that the last build of the acceleration structure took, seconds. Updates do not count.
  double accel_build_s() const { return accel_build_s_; }
  SceneBounds bounds() const { return view_.lights.bounds; }

 private:
  /// Makes all arrays of the view readable by host code until the next launch.
  void open_for_host() const;

  struct MeshInstance {
    uint32_t node;
    uint32_t mesh;
    Mat4 local;                   ///< relative to the node
    bool skinned = false;         ///< in world space, from its joints
    bool deforms = false;         ///< whether its shape changes over time
    uint32_t deforming = kNoHit;  ///< index in deforming_, if it deforms
  };

  /// Adds a note on the playing clip if the scene has several and `choice` names none.
  void note_clips(const std::string& choice);
  void list_mesh_instances();
  void decide_instancing();
  void build_materials();
  void build_meshes();
  void append_mesh(uint32_t mesh, const Mat4* transform);
  /// Whether the shape of a node's mesh changes over time.
  bool is_animated(const Node& node, Index node_index, const Mesh& mesh) const;
  /// Replaces deformable meshes of constant shape by that shape.
  void bake_static_deformations();
  /// Appends a copy for one node to deforming_.
  void append_deforming_mesh(MeshInstance& placed);
  /// Applies key frames to the materials, lights and cameras of the source, and to the camera in use.
  void apply_parameter_animation();
  /// The same, including the consequences for the compiled scene.
  Change animate_parameters();
  /// Ends the key frames of a part that a caller sets.
  void end_parameter_animation(AnimatedPart part, Index index);
  /// Throws Error if the material with that index, which may be a new one, would mix missing materials or itself.
  void check_mixture(Index material, const Material& value) const;
  Change replace_material(Index material, const Material& value);
  /// Updates vertices from the current joints and weights. Returns the changed meshes of the view. Launches
  /// kernels, which invalidates spans from read() and write().
  std::vector<uint32_t> deform_meshes();
  // Poses within an open shutter (compiled_scene_shutter.cpp).

  /// Times of the keys, seconds of the animation; empty if the shutter is closed.
  std::vector<float> key_times() const;
  /// Transforms of the nodes at these times.
  std::vector<std::vector<Mat4>> key_worlds() const;
  /// Poses everything that the animation moves at the keys of the shutter, around the present time. Returns whether
  /// keys may have changed. Launches kernels, which invalidates spans from read() and write().
  bool pose_shutter();
  /// Steps of pose_shutter(). `worlds`: transforms of the nodes, by key.
  bool pose_instances(const std::vector<std::vector<Mat4>>& worlds);
  void pose_camera(const std::vector<std::vector<Mat4>>& worlds);
  bool pose_deforming(const std::vector<std::vector<Mat4>>& worlds);
  /// Sets the keys of deforming meshes in the acceleration structure. Returns the meshes that gained or lost keys.
  std::vector<uint32_t> give_keys_to_accel();
  /// Copies the vertices of deforming meshes to the previous positions, or changes nothing if it throws. Launches a
  /// kernel, which invalidates spans from read() and write().
  void keep_previous_positions();
  /// Numbers of elements in the arrays of meshes.
  struct GeometrySize {
    uint32_t meshes;
    uint32_t vertices;
    uint32_t triangles;
    uint32_t uv1;
    uint32_t colors;
  };
  GeometrySize geometry_size() const;
  /// Removes the elements of meshes beyond these numbers. Allocates nothing.
  void drop_geometry_beyond(const GeometrySize& size);
  /// Throws Error if a joint of the node is to be removed.
  void check_joints_stay(const Node& node, const std::vector<bool>& gone) const;
  /// Stops updating meshes of removed nodes.
  void drop_removed_deformations();
  Box box_of(const MeshView& mesh) const;
  bool place_instances();
  void build_accel();
  /// Adapts the acceleration structure to the instances, the keys of the shutter, and the `deformed` meshes.
  void update_accel(std::span<const uint32_t> deformed);
  void note_collapsed_lights();
  /// Whether a light of the scene itself emits, now or at another time. `emissive_surfaces`: include them.
  bool shines(bool emissive_surfaces) const;
  void note_lighting();
  bool all_unlit() const;
  /// Applies the environment of the source. Resolves an automatic one, once.
  void use_environment();
  /// Applies the studio, rotated towards the initial camera of the scene.
  void use_studio();
  /// Whether too little light reaches the visible surfaces, compared with the studio.
  bool needs_studio();
  void choose_camera(const std::string& name);
  CameraView view_through(const CameraPose& camera) const;
  CameraPose scene_camera(const std::vector<Mat4>& world) const;
  std::vector<Mat4> checked_world(float time_s) const;
  void check_extent(const Box& box) const;
  Box placed_box(const std::vector<Mat4>& world, bool moving_only = false) const;  ///< bounds of placed meshes
  /// Rebuilds what depends on `world_` and the time.
  Change place_everything();
  void collect_lights();
  void compute_bounds();
  void set_bounds();
  /// Calls `change`. If it throws, empties the view: arrays may have moved, or be incomplete.
  template <typename F>
  Change updated(const F& change) {
    try {
      return change();
    } catch (...) {
      empty_view();
      throw;
    }
  }
  /// Removes geometry and lights from the view until the next update, which rebuilds them.
  void empty_view() noexcept;
  /// Sets the addresses and the cameras in the view.
  void point_view();
  /// Sets everything in the view.
  void refresh_view();
  /// Sets the medium around the camera in the view. Arrays must be readable by host code.
  void find_camera_medium();
  std::vector<AccelInstance> accel_instances() const;

  SceneLauncher& launcher_;
  Scene source_;
  std::vector<std::string> notes_;
  float time_s_ = 0;
  std::vector<Mat4> world_;                   ///< per node
  std::vector<bool> moves_;                   ///< per node
  bool was_moved_ = false;                    ///< whether a previous position differs from the current one
  bool has_placed_instances_ = false;         ///< whether instances may differ from their previous state
  std::vector<MeshInstance> mesh_instances_;  ///< per instance
  DeformingMeshes deforming_;
  bool has_deformed_ = false;            ///< whether any mesh has since the end of the last frame
  Array<uint32_t> deforming_vertices_;   ///< vertices of deforming meshes
  Array<Vec3> previous_positions_;       ///< of each of them
  std::vector<bool> visible_;            ///< per node
  std::vector<bool> world_space_;        ///< per mesh instance
  std::vector<uint32_t> shared_meshes_;  ///< per mesh of the source: its mesh-space copy; kNoHit: none
  Shutter shutter_;
  float frame_time_ = -1;          ///< CameraView::frame_time
  std::vector<Mat4> matrix_keys_;  ///< of all moving instances, for the acceleration structure
  Array<Affine> instance_keys_;    ///< the same for kernels
  Array<Vertex> vertex_keys_;      ///< of deforming meshes
  Array<CameraShutterKey> camera_keys_;
  std::vector<uint32_t> keyed_meshes_;  ///< those with keys in the acceleration structure
  AccelChoice accel_choice_;
  bool in_studio_ = false;
  float studio_rotation_rad_ = 0;
  std::optional<bool> automatic_is_studio_;  ///< set at the first decision
  bool edited_ = false;                      ///< since commit_edits()
  bool is_stale_ = false;                    ///< an update ended with an exception, so that the next one rebuilds all
  Array<Vertex> vertices_;
  Array<UVec3> triangles_;
  Array<Vec2> uv1_;
  Array<Vec4> colors_;
  Array<MeshView> meshes_;
  std::vector<Box> boxes_;  ///< per mesh
  Box extent_;              ///< bounds of everything at all times
  std::vector<uint32_t> mesh_of_instance_;
  Array<Instance> instances_;
  Array<MaterialData> materials_;
  Array<LayerData> layers_;  ///< of layered materials
  EnergyTableArrays energy_tables_;
  TextureStore textures_;
  LightBuilder lights_;
  Index camera_node_ = kNone;
  Camera camera_;
  Mat4 default_camera_{1};
  std::optional<CameraPose> camera_pose_;
  CameraView camera_view_;
  CameraView previous_camera_view_;
  IVec2 resolution_;
  SceneBounds bounds_;
  SceneView view_;
  std::unique_ptr<AccelStructure> accel_;
  double accel_build_s_ = 0;
};

}  // namespace relume
