// Makes small glTF files with known images: a square fills the view of a camera facing it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "scene_io/testing/scene_files.h"
#include "support/measure.h"
#include "techniques/transport/path/settings.h"

namespace relume::support {

using testing::GltfBuilder;
using testing::json;

/// Corners of the square [-1, 1]² in the plane z = 0: upper left, upper right, lower left, lower right.
inline const std::vector<float> kCorners = {-1, 1, 0, 1, 1, 0, -1, -1, 0, 1, -1, 0};
/// Texture coordinates for an upright texture over the whole square.
inline const std::vector<float> kUpright = {0, 0, 1, 0, 0, 1, 1, 1};
/// Triangles of the square, facing +Z.
inline const std::vector<uint16_t> kTriangles = {0, 2, 1, 1, 2, 3};

/// A glTF file with an orthographic camera above the plane z = 0 that covers [-1, 1]², +X to the right and +Y up.
class Stage {
 public:
  Stage();

  GltfBuilder file;

  /// Attributes of the square: POSITION and, unless empty, TEXCOORD_0.
  json square(const std::vector<float>& uv = kUpright);
  /// Adds a mesh of the square's triangles; returns its index.
  int mesh(const json& attributes, const json& material);
  /// Adds such a mesh in a root node with the other members of `node`; returns the node.
  int show(const json& attributes, const json& material, const json& node = json::object());
  /// Adds a texture of RGBA texels, in rows from the top, and returns its texture info. `sampler` holds the sampler's
  /// members; texels are not interpolated by default.
  json texture(int width, int height, const std::vector<uint8_t>& texels, const json& sampler = json::object());
  /// Adds a light of KHR_lights_punctual in a root node.
  void light(const json& light, const json& node = json::object());
  /// Adds a directional light of 10 lux, `tilt` radians from the normal towards the viewer's right.
  void sun(float tilt = 0.4f);
  /// Adds keys of a node property to the single animation. Each key has `components` numbers.
  void animate(int node, const char* path, const std::vector<float>& times, const std::vector<float>& values,
               int components, const char* interpolation = "LINEAR");

  /// The document with the list of its extensions.
  std::string text();
  /// The scene in a uniform environment of this radiance.
  Scene load(float environment = 0);
};

/// Adds the names of used extensions to `doc`, as glTF requires.
void name_extensions(json& doc);

/// Quaternion in glTF's order for a rotation by `angle` radians about the unit `axis`.
json rotation_json(const Vec3& axis, float angle);

/// Unlit material of this base colour.
json unlit_json(const json& base_color_texture = {}, const json& factor = {});
/// Black emissive material: light for scenes without other lights.
json glowing_json(const json& radiance);
/// Purely Lambertian material of this albedo.
json matte_json(float albedo);

/// Texels that differ in all channels and from their neighbours, so that mix-ups are visible.
std::vector<uint8_t> colorful(int width, int height);

/// Linear value of an 8-bit sRGB code (IEC 61966-2-1).
double linear_of(int code);

/// Renders `spp` samples per pixel, half a second into the animation, without Russian roulette.
Image image(Scene scene, int size = 16, int spp = 4, int max_bounces = PathSettings{}.max_bounces);

/// Expects every pixel to be within `tolerance` of `expected` at its centre on the square.
void expect_pixels(const Image& image, double tolerance, const std::function<Rgb(double x, double y)>& expected);

/// Expects all pixels of two images to differ by at most `tolerance`.
void expect_same(const Image& a, const Image& b, double tolerance);

/// Variant of a scene: with a glTF feature, with the same effect but without the feature, or as in a loader that
/// ignores it.
enum class Way { feature, plain, ignored };

struct FeatureCase {
  const char* name;
  Scene (*scene)(Way);
  double tolerance = 1e-5;  ///< in radiance; higher for less precise encodings
  int max_bounces = PathSettings{}.max_bounces;
};

/// Printing for GoogleTest.
inline void PrintTo(const FeatureCase& c, std::ostream* out) { *out << c.name; }
inline std::string feature_name(const ::testing::TestParamInfo<FeatureCase>& info) { return info.param.name; }

/// Expects the feature to have the intended effect, to differ from ignoring it, and to load without warnings.
class FeatureTest : public ::testing::TestWithParam<FeatureCase> {
 protected:
  void check() const;
};

}  // namespace relume::support
