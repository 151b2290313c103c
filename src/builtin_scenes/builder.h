// Builds scenes from the steps that all built-in scenes share.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace relume {

/// Purely Lambert: no specular lobe.
Material matte(std::string name, const Rgb& albedo);
/// Lambert under a dielectric coat of IOR 1.5 with perceptual roughness `roughness`.
Material glossy(std::string name, const Rgb& albedo, float roughness);
/// Conductor; `color` is its reflectance at normal incidence. Roughness 0 is a mirror.
Material metal(std::string name, const Rgb& color, float roughness);
/// Smooth clear dielectric that bounds a volume. White is attenuated to `attenuation_color` after
/// `attenuation_distance` metres.
Material glass(std::string name, float ior, const Rgb& attenuation_color = Rgb(1),
               float attenuation_distance = kInfinity);
/// Black surface that emits `radiance` from its front.
Material emitter(std::string name, const Rgb& radiance);

struct CameraKey {
  float time_s;
  Vec3 eye;
  Vec3 target;
};

class SceneBuilder {
 public:
  explicit SceneBuilder(std::string name) { scene_.name = std::move(name); }

  Index add_material(Material material);
  Index add_texture(Texture texture);
  /// Adds a mesh without a node.
  Index add_mesh(std::string name, Mesh mesh, Index material);
  /// Adds a mesh with a separate node; returns the node.
  Index add(std::string name, Mesh mesh, Index material, const Transform& transform = {}, Index parent = kNone);
  /// Adds a node that only groups others.
  Index add_group(std::string name, const Transform& transform = {}, Index parent = kNone);
  /// Adds a node that shows `mesh` once per matrix.
  Index add_instances(std::string name, Index mesh, std::vector<Mat4> instances);

  /// Adds a camera with a full vertical angle in degrees. The first camera is the default. Returns the camera's node.
  Index add_camera(const Vec3& eye, const Vec3& target, float fov_y_deg, const std::string& name = "camera");
  /// Moves a camera node through the keys along Catmull-Rom curves of eye and target, resampled every 0.1 s.
  void add_camera_path(Index node, const std::vector<CameraKey>& keys);
  void add_channel(AnimationChannel channel) { scene_.animation.push_back(std::move(channel)); }
  void add_channel(ParameterChannel channel) { scene_.parameter_animation.push_back(std::move(channel)); }
  /// Turns `node` about +Y `turns` times, with `seconds` per full turn.
  void add_turning(Index node, float seconds, int turns);

  void set_visible_sets(std::vector<VisibleSet> sets) { scene_.visible_sets = std::move(sets); }
  void set_environment(Environment environment) { scene_.environment = std::move(environment); }
  /// The scene with a fixed exposure and tone map, so that its images are comparable.
  Scene take() {
    scene_.settings_json = R"({"exposure": 0, "tone-map": "agx"})";
    return std::move(scene_);
  }

 private:
  Scene scene_;
};

}  // namespace relume
