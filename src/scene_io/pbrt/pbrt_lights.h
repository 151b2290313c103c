// Converts pbrt's light sources and environments.
#pragma once

#include "scene_io/pbrt/pbrt_colors.h"
#include "scene_io/pbrt/pbrt_description.h"
#include "scene_io/pbrt/pbrt_image.h"

namespace relume::pbrt {

class Lights {
 public:
  /// `orientation`: from pbrt's world to relume's, orthogonal.
  Lights(const Mat3& orientation, Scene& scene, Colors& colors, ImageFiles& images, Warnings& warnings)
      : orientation_(orientation), scene_(scene), colors_(colors), images_(images), warnings_(warnings) {}

  /// Adds a light with its node, or adds to the environment. Throws Error for unknown types.
  void add(const LightEntity& light);
  /// Sets the scene's environment after the last light and material: none if anything else emits, as in pbrt, which
  /// renders scenes without lights black.
  void finish();

 private:
  void add_point(const LightEntity& light);
  void add_spot(const LightEntity& light);
  void add_distant(const LightEntity& light);
  void add_goniometric(const LightEntity& light);
  void add_infinite(const LightEntity& light);
  void add_map(const Image& image, const Mat3& from_world, const Rgb& scale);
  /// Adds a light at `position` that shines along `direction`, both in pbrt's world.
  void add_node(PunctualLight light, const Vec3& position, const Vec3& direction);
  Rgb intensity(const Parameters& parameters, std::string_view name);

  Mat3 orientation_;
  Scene& scene_;
  Colors& colors_;
  ImageFiles& images_;
  Warnings& warnings_;
  Rgb constant_{0};  ///< sum of the environments without an image
  bool has_infinite_ = false;
};

}  // namespace relume::pbrt
