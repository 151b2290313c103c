// The scene that is shown, with everything that the user has changed in it. Belongs to the interface's thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/box.h"
#include "scene/deforming_meshes.h"
#include "viewer/request.h"

namespace relume::viewer {

/// The node whose motion moves the meshes of another one.
struct Mover {
  Index node = kNone;
  std::string problem;  ///< why there is none, for the user; empty if there is one
};

class Document {
 public:
  explicit Document(std::shared_ptr<const LoadedScene> loaded);

  const std::shared_ptr<const LoadedScene>& loaded() const { return loaded_; }
  const std::string& name() const { return loaded_->name; }
  const SceneEdits& edits() const { return edits_; }
  /// The scene as edited, without the bulk: no vertices, texels or environment map.
  const Scene& outline() const { return outline_; }

  void set_camera(const std::optional<CameraPose>& camera);
  void set_time(float time_s);
  /// Plays these clips, as select_animation() takes them. Throws Error, before anything changes, if there is none such.
  void play(const std::string& animation);
  /// Gives meshes their materials in that variant; empty: the defaults. Throws Error, before anything changes, if there
  /// is none of that name.
  void choose_variant(const std::string& name);
  /// Places a node below its parent; its own animation ends with that.
  void set_transform(Index node, const Transform& transform);
  void set_light(Index light, const PunctualLight& value);
  void set_material(Index material, const Material& value);
  /// The map, if the kind is one, stays that of the scene.
  void set_environment(const Environment& environment);
  /// Replaces the environment, map included.
  void replace_environment(Environment environment);
  /// Goes back to the environment that the scene was loaded with.
  void restore_environment();
  /// Whether it is another than the scene was loaded with.
  bool environment_is_edited() const { return environment_.get() != &loaded_->scene.environment; }

  /// Repeats the edits of another reading of the same scene, for parts that have the same name and no other of their
  /// kind has. The map of the environment stays. Returns what cannot be repeated: "material 'paint'".
  std::vector<std::string> repeat_edits(const Document& other);

  /// Has the scene compiled so that the node can move. Returns whether that is news.
  bool make_movable(Index node);

  /// The node itself, except for a skinned mesh, which follows its joints alone: then the nearest common ancestor of
  /// the joints, or the first node above it that no animation moves. A figure keeps its animation while it is moved.
  Mover mover(Index node) const;

  /// The node's name, or "node 3" without one.
  std::string node_name(Index node) const;

  /// Where the node is now, below its parent.
  Transform transform(Index node) const;
  /// Moves a node by a vector in world space.
  void move(Index node, const Vec3& by);

  float time_s() const { return edits_.time_s.value; }
  float duration_s() const { return duration_s_; }  ///< of the clips that play
  const std::vector<Mat4>& world() const;           ///< one a node, now
  /// Boxes of the meshes that the node carries, each in its own coordinates, with the matrix from there to the world;
  /// at most `most`. A node carries its own meshes, those of the nodes below it, and skinned ones with a joint among
  /// these.
  std::vector<std::pair<Box, Mat4>> boxes(Index node, size_t most) const;
  /// Of the meshes that the node carries; empty without any.
  Box bounds(Index node) const;
  Box bounds() const;
  /// The first node that carries the light; kNone if there is none.
  Index node_of_light(Index light) const;
  bool has_environment_map() const { return !environment_->map.empty(); }

 private:
  std::vector<bool> below(Index ancestor) const;    ///< by node: whether it is the ancestor or stems from it
  std::vector<bool> carried(Index ancestor) const;  ///< by node: whether the ancestor carries its meshes
  bool has_skinned_mesh(Index node) const;
  bool has_animated_transform(Index node) const;  ///< in any clip, unless an edit has ended that
  void use(std::shared_ptr<const Environment> environment);
  void add_bounds(Index node, Box& sum) const;  ///< of its own meshes
  /// A mesh of the node as it is deformed now; in the world if it is skinned, else in the mesh's own coordinates.
  const Box& deformed_bounds(Index node, Index mesh) const;
  /// Calls f(box, matrix to the world) for each place of the node's meshes.
  template <typename F>
  void for_each_box(Index node, const F& f) const;
  void forget_places();
  uint64_t next_version() { return ++edits_.version; }

  std::shared_ptr<const LoadedScene> loaded_;
  Scene outline_;
  std::shared_ptr<const Environment> environment_;  ///< with its map
  bool environment_is_set_ = false;                 ///< by set_environment(), since it was last replaced or restored
  std::vector<Box> mesh_boxes_;                     ///< in the mesh's own coordinates
  SceneEdits edits_;
  float duration_s_ = 0;
  std::vector<AnimationChannel> playing_;                           ///< as loaded: those of the clips that play
  mutable std::map<std::pair<Index, Index>, Box> deformed_bounds_;  ///< by node and mesh, now
  mutable std::optional<JointMatrices> joints_;                     ///< now, once they are asked for
  mutable std::vector<Mat4> world_;
  mutable bool world_known_ = false;
};

}  // namespace relume::viewer
