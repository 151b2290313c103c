// Collects the emitters of a scene into the arrays behind a LightsView.
#pragma once

#include <unordered_map>
#include <vector>

#include "lights/light.h"
#include "scene/scene.h"
#include "scene/scene_view.h"

namespace relume {

/// Where the nodes of a scene are at one time, and whether they are shown; one entry a node.
struct PlacedNodes {
  const std::vector<Mat4>& world;
  const std::vector<bool>& visible;
};

class LightBuilder {
 public:
  /// Environment arrays (map, sampling table). CompiledScene decides what `automatic` is; here it
  /// is none.
  void set_environment(const Environment& environment);

  /// Forgets the sampling tables of textured emitters, whose materials have changed.
  void forget_textures();

  /// Rebuilds the list of lights: triangles of emissive instances, then punctual lights, then those at infinity. Writes
  /// Instance::first_light. `geometry` needs vertices, triangles, meshes, instances, materials, textures.
  void collect(const SceneView& geometry, std::vector<Instance>& instances, const Scene& scene,
               const PlacedNodes& nodes, const SceneBounds& bounds);

  /// Forgets which lights differ from the frame before.
  void mark_unchanged();

  LightsView view() const;
  /// Of lights, what samples them, and the environment's map.
  size_t memory_bytes() const;

 private:
  /// The sampling table of the environment's map, and the map's mean.
  void build_environment_distribution();
  void add_triangles(const SceneView& geometry, uint32_t instance_index, Instance& instance);
  /// Makes the sampling tables of all triangles with textured emission, each once, however often it appears or moves.
  void add_textured(const SceneView& geometry, const std::vector<Instance>& instances);
  void add_punctual_lights(const Scene& scene, const PlacedNodes& nodes, bool at_infinity);
  void mark_changes();
  bool same(const Light& a, const Light& b) const;

  std::vector<Light> lights_;
  std::vector<Light> previous_;  ///< one frame ago, as many
  std::vector<LightId> changed_;
  uint32_t first_infinite_ = 0;
  /// The triangle's texture is black everywhere; it emits nothing.
  static constexpr int32_t kBlackTexture = -1;
  std::unordered_map<uint32_t, int32_t> textured_indices_;  ///< by index of the triangle; its number, or kBlackTexture
  std::vector<TexturedTriangle> textured_;
  std::vector<AliasEntry> entries_;
  View<const TextureView> textures_;
  std::vector<Rgb> environment_map_;
  Distribution2DStorage environment_distribution_;
  EnvironmentView environment_;
  bool has_previous_ = false;         ///< a frame has ended
  bool environment_changed_ = false;  ///< since the last frame ended
  bool has_sun_ = false;
  DirectionalLight sun_{};
  SceneBounds bounds_;
};

}  // namespace relume
