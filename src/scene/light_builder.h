// Collects the emitters of a scene into the arrays of a LightsView.
#pragma once

#include <unordered_map>
#include <vector>

#include "lights/light.h"
#include "scene/scene.h"
#include "scene/scene_view.h"

namespace relume {

/// Transforms and visibility of the nodes of a scene at one time; one entry per node.
struct PlacedNodes {
  const std::vector<Mat4>& world;
  const std::vector<bool>& visible;
};

class LightBuilder {
 public:
  /// Builds the environment arrays (map, sampling table). CompiledScene resolves `automatic`; here it is none.
  void set_environment(const Environment& environment);

  /// Discards the sampling tables of textured emitters after a change of their materials.
  void discard_texture_tables();

  /// Rebuilds the list of lights: triangles of emissive instances, or parallelograms if all triangles of the mesh pair
  /// up, then punctual lights, then those at infinity. Writes Instance::first_light and Instance::paired_lights.
  /// `geometry` needs vertices, triangles, meshes, instances, materials, textures.
  void collect(const SceneView& geometry, std::vector<Instance>& instances, const Scene& scene,
               const PlacedNodes& nodes, const SceneBounds& bounds);

  /// Marks all lights as unchanged since the previous frame.
  void mark_unchanged();

  LightsView view() const;
  /// Bytes of lights, their sampling tables, and the environment map.
  size_t memory_bytes() const;

 private:
  /// Builds the sampling table and the mean of the environment map.
  void build_environment_distribution();
  void add_triangles(const SceneView& geometry, uint32_t instance_index, Instance& instance);
  /// Builds the sampling tables of all triangles with textured emission. Each is built once per mesh: instances
  /// share it, and motion keeps it.
  void add_textured(const SceneView& geometry, const std::vector<Instance>& instances);
  void add_punctual_lights(const Scene& scene, const PlacedNodes& nodes, bool at_infinity);
  void mark_changes();
  bool same(const Light& a, const Light& b) const;

  std::vector<Light> lights_;
  std::vector<Light> previous_;  ///< of the previous frame, with the same size
  std::vector<LightId> changed_;
  uint32_t first_infinite_ = 0;
  /// Marks a triangle whose texture is black everywhere, without emission.
  static constexpr int32_t kBlackTexture = -1;
  std::unordered_map<uint32_t, int32_t> textured_indices_;  ///< by triangle index: its number, or kBlackTexture
  std::vector<TexturedTriangle> textured_;
  std::vector<AliasEntry> entries_;
  View<const TextureView> textures_;
  std::vector<Rgb> environment_map_;
  Distribution2DStorage environment_distribution_;
  EnvironmentView environment_;
  bool has_previous_ = false;         ///< whether a frame has ended
  bool environment_changed_ = false;  ///< since the end of the last frame
  bool has_sun_ = false;
  DirectionalLight sun_{};
  SceneBounds bounds_;
};

}  // namespace relume
