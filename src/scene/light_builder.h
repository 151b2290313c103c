// Collects the emitters of a scene into the arrays of a LightsView.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "core/array.h"
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
  explicit LightBuilder(Memory& memory = host_memory())
      : lights_(memory),
        previous_(memory),
        changed_(memory),
        light_keys_(memory),
        first_light_keys_(memory),
        textured_(memory),
        entries_(memory),
        environment_map_(memory),
        environment_marginal_(memory),
        environment_conditional_(memory) {}

  /// Builds the environment arrays (map, sampling table). CompiledScene resolves `automatic`; here it is none.
  void set_environment(const Environment& environment);

  /// Removes all lights and the environment.
  void clear() noexcept;

  /// Discards the sampling tables of textured emitters after a change of their materials.
  void discard_texture_tables();

  /// Rebuilds the list of lights: triangles of emissive instances, or parallelograms if all triangles of the mesh pair
  /// up, then punctual lights, then those at infinity. Writes Instance::first_light and Instance::paired_lights.
  /// `geometry` needs vertices, triangles, meshes, instances, materials, textures.
  void collect(const SceneView& geometry, std::span<Instance> instances, const Scene& scene, const PlacedNodes& nodes,
               const SceneBounds& bounds);

  /// Marks all lights as unchanged since the previous frame.
  void mark_unchanged();

  LightsView view() const;
  /// Makes the arrays of view() readable by the host until the next launch.
  void open_for_host() const;
  /// Bytes of lights, their sampling tables, and the environment map.
  size_t memory_bytes() const;

 private:
  /// Stores the map, and builds its sampling table and its mean.
  void use_environment_map(std::span<const Rgb> map, int width, int height);
  void add_triangles(const SceneView& geometry, uint32_t instance_index, Instance& instance);
  /// Adds the corners of the next light at the keys of the shutter, and raises the light's error to theirs.
  void add_keys(const SceneView& geometry, const Instance& instance, uint32_t triangle, TriangleLight& light);
  /// Builds the sampling tables of all triangles with textured emission. Each is built once per mesh: instances
  /// share it, and motion keeps it.
  void add_textured(const SceneView& geometry, std::span<const Instance> instances);
  void add_punctual_lights(const Scene& scene, const PlacedNodes& nodes, bool at_infinity);
  void mark_changes();
  bool same(const Light& a, const Light& b) const;

  Array<Light> lights_;
  Array<Light> previous_;  ///< of the previous frame, with the same size
  Array<LightId> changed_;
  std::vector<LightKey> keys_;        ///< those of the next array, while collect() runs
  std::vector<uint32_t> first_keys_;  ///< the same
  Array<LightKey> light_keys_;        ///< LightsView::keys
  Array<uint32_t> first_light_keys_;  ///< LightsView::first_keys
  uint32_t key_count_ = 0;
  uint32_t first_infinite_ = 0;
  /// Marks a triangle whose texture is black everywhere, without emission.
  static constexpr int32_t kBlackTexture = -1;
  std::unordered_map<uint32_t, int32_t> textured_indices_;  ///< by triangle index: its number, or kBlackTexture
  Array<TexturedTriangle> textured_;
  Array<AliasEntry> entries_;
  TexturesView textures_;
  Array<Rgb> environment_map_;
  Array<float> environment_marginal_;
  Array<float> environment_conditional_;
  EnvironmentView environment_;
  bool has_previous_ = false;         ///< whether a frame has ended
  bool collected_ = false;            ///< whether lights may differ from `previous_`
  bool environment_changed_ = false;  ///< since the end of the last frame
  bool has_sun_ = false;
  DirectionalLight sun_{};
  SceneBounds bounds_;
};

}  // namespace relume
