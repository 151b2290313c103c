// Small glTF files made in code whose images are known: a square fills the view of a camera that looks straight at
// it.
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
/// Texture coordinates that show a whole texture upright on it.
inline const std::vector<float> kUpright = {0, 0, 1, 0, 0, 1, 1, 1};
/// Its two triangles; they face +Z.
inline const std::vector<uint16_t> kTriangles = {0, 2, 1, 1, 2, 3};

/// A glTF file with an orthographic camera above the plane z = 0 that sees [-1, 1]² of it, +X to the right and +Y up.
class Stage {
 public:
  Stage();

  GltfBuilder file;

  /// Attributes of the square: POSITION and, unless empty, TEXCOORD_0.
  json square(const std::vector<float>& uv = kUpright);
  /// A mesh of the square's triangles; returns its index.
  int mesh(const json& attributes, const json& material);
  /// The same in a root node, whose other members are those of `node`; returns the node.
  int show(const json& attributes, const json& material, const json& node = json::object());
  /// A texture and the info that refers to it; its texels are RGBA, row by row from the top. `sampler`: its members;
  /// texels are not interpolated unless it says so.
  json texture(int width, int height, const std::vector<uint8_t>& texels, const json& sampler = json::object());
  /// A light of KHR_lights_punctual in a root node.
  void light(const json& light, const json& node = json::object());
  /// A directional light of 10 lux that falls on the square `tilt` radians from the viewer's right.
  void sun(float tilt = 0.4f);
  /// Keys of one property of a node, which joins the only animation. `components` numbers a key.
  void animate(int node, const char* path, const std::vector<float>& times, const std::vector<float>& values,
               int components, const char* interpolation = "LINEAR");

  /// The document, which names the extensions that it uses.
  std::string text();
  /// The scene in a uniform environment.
  Scene load(float environment = 0);
};

/// Lets `doc` name the extensions that it uses, as glTF asks.
void name_extensions(json& doc);

/// Quaternion of a rotation by `angle` radians about `axis` (unit), as glTF writes it.
json rotation_json(const Vec3& axis, float angle);

/// Material that shows its base colour from everywhere.
json unlit_json(const json& base_color_texture = {}, const json& factor = {});
/// Black, and glows: light for scenes that must not be given any other.
json glowing_json(const json& radiance);
/// Lambert of this albedo and nothing else.
json matte_json(float albedo);

/// Texels whose channels and neighbours all differ, so that a wrong one shows.
std::vector<uint8_t> colorful(int width, int height);

/// Linear value of an 8-bit sRGB code (IEC 61966-2-1).
double linear_of(int code);

/// `spp` samples a pixel, half a second into the animation, without Russian roulette.
Image image(Scene scene, int size = 16, int spp = 4, int max_bounces = PathSettings{}.max_bounces);

/// Expects every pixel within `tolerance` of what `expected` says for the point of the square at its centre.
void expect_pixels(const Image& image, double tolerance, const std::function<Rgb(double x, double y)>& expected);

/// Expects two images to differ nowhere by more than `tolerance`.
void expect_same(const Image& a, const Image& b, double tolerance);

/// How a scene is made: by a feature of glTF, without it to the same effect, or as by a loader that ignores the
/// feature.
enum class Way { feature, plain, ignored };

struct FeatureCase {
  const char* name;
  Scene (*scene)(Way);
  double tolerance = 1e-5;  ///< radiance; more where numbers are stored another way
  int max_bounces = PathSettings{}.max_bounces;
};

/// For messages of GoogleTest.
inline void PrintTo(const FeatureCase& c, std::ostream* out) { *out << c.name; }
inline std::string feature_name(const ::testing::TestParamInfo<FeatureCase>& info) { return info.param.name; }

/// The feature shows what it should, which is not what would show without it, and the loader has nothing to complain
/// of.
class FeatureTest : public ::testing::TestWithParam<FeatureCase> {
 protected:
  void check() const;
};

}  // namespace relume::support
