// The displayed scene with the user's edits. Used only by the interface thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/box.h"
#include "scene/deforming_meshes.h"
#include "viewer/render/request.h"

namespace relume::viewer {

/// The node whose motion moves the meshes of another one.
struct Mover {
  Index node = kNone;
  std::string problem;  ///< reason, for the user, why there is none; empty otherwise
};

class Document {
 public:
  explicit Document(std::shared_ptr<const LoadedScene> loaded);

  const std::shared_ptr<const LoadedScene>& loaded() const { return loaded_; }
  const std::string& name() const { return loaded_->name; }
  const SceneEdits& edits() const { return edits_; }
  /// The edited scene without vertices, texels and environment map.
  const Scene& outline() const { return outline_; }

  void set_camera(const std::optional<CameraPose>& camera);
  void set_time(float time_s);
  /// Plays these clips, in the syntax of select_animation(). Throws Error, before any change, if one does not exist.
  void play(const std::string& animation);
  /// Applies a material variant to the meshes; empty: the defaults. Throws Error, before any change, for an unknown
  /// name.
  void choose_variant(const std::string& name);
  /// Places a node relative to its parent, which ends its own animation.
  void set_transform(Index node, const Transform& transform);
  void set_light(Index light, const PunctualLight& value);
  void set_material(Index material, const Material& value);
  /// Keeps the scene's map if the kind is a map.
  void set_environment(const Environment& environment);
  /// Replaces the environment, map included.
  void replace_environment(Environment environment);
  /// Restores the environment of the loaded scene.
  void restore_environment();
  /// Whether the environment differs from that of the loaded scene.
  bool environment_is_edited() const { return environment_.get() != &loaded_->scene.environment; }

  /// Repeats the edits of another load of the same scene, matching parts by kind and unique name. The environment map
  /// stays. Returns the edits that cannot be repeated: "material 'paint'".
  std::vector<std::string> repeat_edits(const Document& other);

  /// Marks the node as movable, which recompiles the scene. Returns false if it already was or carries no geometry.
  bool make_movable(Index node);

  /// The node itself, except for a skinned mesh, which follows its joints. Then the joints' nearest common ancestor, or
  /// the first node above it without animation; the figure stays animated while it is moved. No node if that one would
  /// also move meshes, lights or cameras that do not belong to the figure.
  Mover mover(Index node) const;

  /// The node's name, or "node 3" if it has none.
  std::string node_name(Index node) const;

  /// The node's current transform, relative to its parent.
  Transform transform(Index node) const;
  /// Moves a node by a vector in world space.
  void move(Index node, const Vec3& by);

  float time_s() const { return edits_.time_s.value; }
  float duration_s() const { return duration_s_; }  ///< of the playing clips
  const std::vector<Mat4>& world() const;           ///< current matrix of each node
  /// Boxes of up to `most` meshes that the node carries, each with its matrix to world space. A node carries its own
  /// meshes, those of the nodes below it, and skinned meshes with a joint among these.
  std::vector<std::pair<Box, Mat4>> boxes(Index node, size_t most) const;
  /// World bounds of the meshes that the node carries; may be empty.
  Box bounds(Index node) const;
  Box bounds() const;
  /// The first node with the light; kNone if there is none.
  Index node_of_light(Index light) const;
  bool has_environment_map() const { return !environment_->map.empty(); }

 private:
  /// By node: whether it is an ancestor or the descendant of one.
  std::vector<bool> below(const std::vector<Index>& ancestors) const;
  std::vector<bool> carried(Index ancestor) const;  ///< by node: whether the ancestor carries its meshes
  /// By skin: the joints' common ancestor, or the highest such node of a skin above it. Skins of equal values deform
  /// the same figure. kNone if the joints have no common ancestor.
  std::vector<Index> skeletons() const;
  /// First node with a mesh, light or camera that `mover` moves, but the joints of the skin's figure do not; else
  /// kNone.
  Index passenger_of(Index mover, Index skin) const;
  bool has_skinned_mesh(Index node) const;
  bool has_animated_transform(Index node) const;  ///< in any clip, unless edited
  void use(std::shared_ptr<const Environment> environment);
  void add_bounds(Index node, Box& sum) const;  ///< adds bounds of the node's own meshes
  /// Current bounds of a deformed mesh of the node: in world space if it is skinned, else in the mesh's coordinates.
  const Box& deformed_bounds(Index node, Index mesh) const;
  /// Calls f(box, matrix to world space) for each instance of the node's meshes.
  template <typename F>
  void for_each_box(Index node, const F& f) const;
  void invalidate_transforms();
  uint64_t next_version() { return ++edits_.version; }

  std::shared_ptr<const LoadedScene> loaded_;
  Scene outline_;
  std::shared_ptr<const Environment> environment_;  ///< including its map
  bool environment_is_set_ = false;                 ///< by set_environment() since the last replacement or restoration
  std::vector<Box> mesh_boxes_;                     ///< in the meshes' own coordinates
  std::vector<Index> skeletons_;                    ///< skeletons()
  SceneEdits edits_;
  float duration_s_ = 0;
  std::vector<AnimationChannel> playing_;                           ///< as loaded, of the playing clips
  mutable std::map<std::pair<Index, Index>, Box> deformed_bounds_;  ///< by node and mesh, at the current time
  mutable std::optional<JointMatrices> joints_;                     ///< at the current time, computed on demand
  mutable std::vector<Mat4> world_;
  mutable bool world_valid_ = false;
};

}  // namespace relume::viewer
