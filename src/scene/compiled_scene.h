// Turns the author's scene into flat arrays, lights and an acceleration structure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "accel/embree_accel.h"
#include "scene/light_builder.h"
#include "scene/scene_view.h"
#include "scene/texture_store.h"

namespace relume {

/// Owns everything that a SceneView points to. Not movable: kernels and Embree hold its addresses.
/// How a scene is compiled.
struct CompileOptions {
  std::string camera;  ///< name or index of a camera node; empty: the first
  float time_s = 0;
  int width = 1;  ///< of the image, pixels
  int height = 1;
  TextureFilter texture_filter = TextureFilter::linear;
};

class CompiledScene {
 public:
  /// Arrays of the scene are moved into their kernel layout and freed. Throws Error if there is no such camera.
  CompiledScene(Scene scene, const CompileOptions& options);
  CompiledScene(const CompiledScene&) = delete;
  CompiledScene& operator=(const CompiledScene&) = delete;

  /// Moves animated nodes to `time_s`; what they were becomes the previous position.
  void set_time(float time_s);

  const SceneView& view() const { return view_; }
  const Scene& source() const { return source_; }
  /// What stands in for things the file lacks, one sentence each.
  const std::vector<std::string>& notes() const { return notes_; }
  size_t triangle_count() const;  ///< counting every instance
  size_t memory_bytes() const;
  SceneBounds bounds() const { return view_.lights.bounds; }

 private:
  struct Appearance {
    uint32_t node;
    uint32_t mesh;
    Mat4 local;  ///< below the node
  };

  void list_appearances();
  void decide_instancing(const std::vector<bool>& moves);
  void build_materials();
  void build_meshes(const std::vector<Mat4>& world);
  void append_mesh(uint32_t mesh, const Mat4* transform);
  void place_instances(const std::vector<Mat4>& world, bool first);
  void build_accel();
  void add_missing_light();
  void choose_camera(const std::string& name);
  void place_camera(const std::vector<Mat4>& world, bool first);
  void compute_bounds();
  void refresh_view();
  std::vector<AccelInstance> accel_instances() const;

  Scene source_;
  std::vector<std::string> notes_;
  std::vector<Appearance> appearances_;  ///< one an instance
  std::vector<bool> world_space_;        ///< one an appearance
  std::vector<Vertex> vertices_;
  std::vector<UVec3> triangles_;
  std::vector<Vec2> uv1_;
  std::vector<Vec4> colors_;
  std::vector<MeshView> meshes_;
  std::vector<uint32_t> mesh_of_appearance_;
  std::vector<Instance> instances_;
  std::vector<MaterialData> materials_;
  TextureStore textures_;
  LightBuilder lights_;
  Index camera_node_ = kNone;
  Camera camera_;
  Mat4 default_camera_{1};
  CameraView camera_view_;
  CameraView previous_camera_view_;
  IVec2 resolution_;
  SceneBounds bounds_;
  SceneView view_;
  std::unique_ptr<EmbreeAccel> accel_;
};

}  // namespace relume
