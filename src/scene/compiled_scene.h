// Turns the author's scene into flat arrays, lights and an acceleration structure.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "accel/embree_accel.h"
#include "core/box.h"
#include "core/change.h"
#include "scene/deforming_meshes.h"
#include "scene/light_builder.h"
#include "scene/scene_view.h"
#include "scene/texture_store.h"

namespace relume {

/// How a scene is compiled.
struct CompileOptions {
  std::string camera = {};     ///< name or index of a camera node; empty: the first
  std::string animation = {};  ///< as select_animation() takes it
  float time_s = 0;
  int width = 1;  ///< of the image, pixels
  int height = 1;
  TextureFilter texture_filter = TextureFilter::linear;
  std::vector<Index> movable = {};  ///< nodes that set_transform() will move, beside those with animation
};

/// The node of the camera of that name or number, or of the first camera; kNone if there is none and none is named.
/// Throws Error with the names that there are.
Index find_camera(const Scene& scene, const std::string& name);

/// Owns everything that a SceneView points to. Not movable: kernels and Embree hold its addresses.
class CompiledScene {
 public:
  /// Arrays of the scene are moved into their kernel layout and freed. Throws Error if there is no such camera, and as
  /// validate() does.
  CompiledScene(Scene scene, const CompileOptions& options);
  CompiledScene(const CompiledScene&) = delete;
  CompiledScene& operator=(const CompiledScene&) = delete;

  /// Ends a frame: where things are becomes where they were one frame ago, and no light counts as changed.
  void end_frame();

  /// Moves animated nodes. This and what follows say what differs afterwards, and throw Error for what no kernel could
  /// bear (a camera that a scale of 0 collapses, a node beyond kMaxCoordinate); then everything stays as it was.
  Change set_time(float time_s);
  /// Looks through another camera; std::nullopt returns to that of the scene.
  Change set_camera(const std::optional<CameraPose>& camera);
  /// Places a node, whose own animation ends with that. It, or a node above it, must be movable.
  Change set_transform(Index node, const Transform& transform);
  Change set_light(Index light, const PunctualLight& value);
  Change set_environment(const Environment& environment);
  /// Replaces what the material is made of; its textures are among those of the scene.
  Change set_material(Index material, const Material& value);
  /// Another size of the image.
  Change set_resolution(int width, int height);

  /// Add parts, whose indices are returned. Nodes refer to meshes, lights and parents that are there already; a node
  /// that is added may be moved. Throw Error for values and references that are not valid; then nothing is added.
  Index add_material(const Material& material);
  Index add_mesh(const Mesh& mesh);
  Index add_light(const PunctualLight& light);
  Index add_node(const Node& node);
  /// Removes a node and the nodes below it, which are returned. Other indices stay.
  std::vector<Index> remove_node(Index node);
  /// Removes a mesh or a light that no node has any more. Throws Error if one has.
  void remove_mesh(Index mesh);
  void remove_light(Index light);
  /// Builds what parts that were added or removed need. Before anything else is asked of the scene.
  Change commit_edits();

  bool movable(Index node) const { return moves_[static_cast<size_t>(node)]; }
  CameraPose camera() const;
  /// The node that an instance belongs to.
  Index node_of(uint32_t instance) const { return static_cast<Index>(mesh_instances_[instance].node); }

  const SceneView& view() const { return view_; }
  const Scene& source() const { return source_; }
  bool in_studio() const { return in_studio_; }
  /// Replacements for things that the file lacks, one sentence each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Bytes of geometry, lights, textures, environment and acceleration structure.
  size_t memory_bytes() const;
  SceneBounds bounds() const { return view_.lights.bounds; }

 private:
  struct MeshInstance {
    uint32_t node;
    uint32_t mesh;
    Mat4 local;                   ///< below the node
    bool skinned = false;         ///< stands in the world, as its joints have it
    bool deforms = false;         ///< its shape changes while the scene is shown
    uint32_t deforming = kNoHit;  ///< number in deforming_ if it does
  };

  /// Says which clip plays if the scene has several and `choice` names none.
  void note_clips(const std::string& choice);
  void list_mesh_instances();
  void decide_instancing();
  void build_materials();
  void build_meshes();
  void append_mesh(uint32_t mesh, const Mat4* transform);
  /// Whether the shape of a node's mesh changes while the scene is shown.
  bool is_animated(const Node& node, Index node_index, const Mesh& mesh) const;
  /// Replaces deformable meshes whose shape does not change by the shape that they have.
  void bake_static_deformations();
  /// A copy for one node, which joins deforming_.
  void append_deforming_mesh(MeshInstance& placed);
  /// Sets what key frames drive in the source's materials, lights and cameras, before anything is built.
  void apply_parameter_animation();
  /// The same for a scene that is built, with what follows.
  Change animate_parameters();
  /// What a caller sets is no longer driven by key frames.
  void end_parameter_animation(AnimatedPart part, Index index);
  Change replace_material(Index material, const Material& value);
  /// Updates vertices to the joints and weights of now; returns the meshes of the view that have changed.
  std::vector<uint32_t> deform_meshes();
  void keep_previous_positions();
  /// Throws Error if a joint of the node is among those that are removed.
  void check_joints_stay(const Node& node, const std::vector<bool>& gone) const;
  /// Stops updating meshes whose nodes were removed.
  void forget_removed_deformations();
  Box box_of(const MeshView& mesh) const;
  bool place_instances();
  void build_accel();
  void note_collapsed_lights();
  /// Whether a light of the scene itself shines, now or at another time. Emissive surfaces count if asked for.
  bool shines(bool emissive_surfaces) const;
  void note_lighting();
  bool all_unlit() const;
  /// Uses the environment of the source; decides what an automatic one is, once.
  void use_environment();
  /// The studio, turned towards the camera that the scene had at first.
  void use_studio();
  /// Whether too little light reaches what the camera sees. Uses the studio to compare.
  bool needs_studio();
  void choose_camera(const std::string& name);
  CameraView view_through(const CameraPose& camera) const;
  CameraPose scene_camera(const std::vector<Mat4>& world) const;
  std::vector<Mat4> checked_world(float time_s) const;
  void check_extent(const Box& box) const;
  Box placed_box(const std::vector<Mat4>& world, bool moving_only = false) const;  ///< of what instance nodes place
  Change place_everything(std::vector<Mat4> world);
  void collect_lights();
  void compute_bounds();
  void set_bounds();
  void refresh_view();
  std::vector<AccelInstance> accel_instances() const;

  Scene source_;
  std::vector<std::string> notes_;
  float time_s_ = 0;
  std::vector<Mat4> world_;                   ///< one a node
  std::vector<bool> moves_;                   ///< one a node
  bool was_moved_ = false;                    ///< some previous position differs from the present one
  std::vector<MeshInstance> mesh_instances_;  ///< one an instance
  DeformingMeshes deforming_;
  std::set<uint32_t> deformed_;           ///< numbers in deforming_: since the last frame ended
  std::vector<Vec3> previous_positions_;  ///< of the meshes that deform
  std::vector<bool> visible_;             ///< one a node
  std::vector<bool> world_space_;         ///< one for each mesh instance
  std::vector<uint32_t> shared_meshes_;   ///< by mesh of the source: its copy in its own space; kNoHit: none
  bool in_studio_ = false;
  float studio_rotation_rad_ = 0;
  std::optional<bool> automatic_is_studio_;  ///< once it is decided
  bool edited_ = false;                      ///< since commit_edits()
  std::vector<Vertex> vertices_;
  std::vector<UVec3> triangles_;
  std::vector<Vec2> uv1_;
  std::vector<Vec4> colors_;
  std::vector<MeshView> meshes_;
  std::vector<Box> boxes_;  ///< one a mesh
  Box extent_;              ///< of everything, wherever animation takes it
  std::vector<uint32_t> mesh_of_instance_;
  std::vector<Instance> instances_;
  std::vector<MaterialData> materials_;
  std::vector<LayerData> layers_;  ///< of the materials that have some
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
  std::unique_ptr<EmbreeAccel> accel_;
};

}  // namespace relume
