// Agreement of all estimators on layered and dispersive materials and on culled faces.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "techniques/transport/bdpt/testing/image_mean.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

Material& material(Scene& scene, const std::string& name) {
  for (Material& m : scene.materials) {
    if (m.name == name) return m;
  }
  throw std::out_of_range(name);
}

/// Mean difference of two images with the same random numbers, relative to the mean of the first.
double relative_difference(const Scene& a, const Scene& b) {
  const std::vector<Rgb> first = render_bdpt(Scene(a), kCameraAlone, 16);
  const std::vector<Rgb> second = render_bdpt(Scene(b), kCameraAlone, 16);
  double difference = 0;
  double sum = 0;
  for (size_t p = 0; p < first.size(); ++p) {
    difference += static_cast<double>(luminance(abs(first[p] - second[p])));
    sum += static_cast<double>(luminance(first[p]));
  }
  return difference / sum;
}

void add_sheen(Scene& scene) {
  Material& floor = material(scene, "floor");
  floor.sheen_color = Rgb(0.8f, 0.6f, 0.4f);
  floor.sheen_roughness = 0.5f;
}

void add_film(Scene& scene) {
  for (const char* name : {"wall", "rough glass", "metal"}) material(scene, name).iridescence = 0.9f;
  material(scene, "wall").specular = 1;
}

void add_anisotropy(Scene& scene) {
  for (const char* name : {"metal", "floor"}) material(scene, name).anisotropy = 0.7f;
}

void add_diffuse_transmission(Scene& scene) {
  for (const char* name : {"ball", "pane"}) material(scene, name).diffuse_transmission = 0.6f;
}

/// Adds a coat tilted to one side of its base, and a coat over a lamp.
void add_coats(Scene& scene) {
  Texture leaning;
  leaning.width = leaning.height = 1;
  leaning.format = PixelFormat::rgba8_linear;
  for (const int code : {170, 100, 240, 255}) leaning.texels.push_back(static_cast<std::byte>(code));
  scene.textures.push_back(leaning);
  Material& coated = material(scene, "coated");
  coated.clearcoat_normal_texture.texture = static_cast<Index>(scene.textures.size()) - 1;
  coated.clearcoat = 1;
  material(scene, "lamp").clearcoat = 1;
}

/// Adds dispersion strong enough to separate the channels' images of the lamp.
void add_dispersion(Scene& scene) {
  for (Material& m : scene.materials) {
    if (m.thickness > 0.0f) m.dispersion = 5;
  }
}

/// A layer, and a view from `eye` that an object of the zoo with this layer fills.
struct Layer {
  const char* name;
  std::function<void(Scene&)> add;
  Vec3 eye;
  Vec3 target;
};

const Layer kLayers[] = {{"dispersion", add_dispersion, {0.5f, 1.6f, 2.4f}, {1.05f, 0.2f, 0.4f}},
                         {"sheen", add_sheen, {0.2f, 1.2f, 3.4f}, {0.2f, 0, 1.5f}},
                         {"film", add_film, {0.8f, 1.6f, 2.0f}, {0, 0.5f, -0.7f}},
                         {"anisotropy", add_anisotropy, {0.2f, 1.2f, 3.4f}, {0.2f, 0, 1.5f}},
                         {"diffuse transmission", add_diffuse_transmission, {-1.1f, 1.2f, 2.5f}, {-1.1f, 0.5f, 0.3f}},
                         {"coats", add_coats, {-1.6f, 1.6f, 1.2f}, {-1.6f, 0.6f, -1.0f}}};

/// Images of an estimator. Half as many as other scenes have: the bounds, in standard errors, are 1.4 times theirs.
constexpr int kSamples = 256;

void look_at_layer(Scene& scene, const Layer& layer) {
  scene.cameras.back().fov_y_rad = 0.35f;
  scene.nodes.back().transform = look_at(layer.eye, layer.target);
}

TEST(BdptLayers, AllEstimatorsAgree) {
  for (const Layer& layer : kLayers) {
    Scene scene = make_zoo(ZooLight::triangles, ZooCamera::pinhole, false, false);
    look_at_layer(scene, layer);
    const Scene base = scene;
    layer.add(scene);
    EXPECT_GT(relative_difference(base, scene), 0.01) << layer.name << " changes nothing";
    expect_agreement(scene, layer.name, kSamples);
  }
}

/// With delta scattering and bent shading normals, where light tracing loses some light. Layers at odd positions or the
/// others.
void expect_same_mean_on_smooth_and_bent_surfaces(bool odd) {
  for (const Layer& layer : kLayers) {
    if ((&layer - kLayers) % 2 != (odd ? 1 : 0)) continue;
    Scene scene = make_zoo(ZooLight::triangles, ZooCamera::pinhole, true, true);
    layer.add(scene);
    expect_same_mean(mean_of(scene, {}, kSamples), mean_of(scene, kCameraAlone, kSamples), layer.name);
  }
}
/// Dispersion, films and diffuse transmission.
TEST(BdptLayers, AgreeOnSmoothAndBentSurfaces) { expect_same_mean_on_smooth_and_bent_surfaces(false); }
TEST(SlowBdptLayers, AgreeOnSmoothAndBentSurfaces) { expect_same_mean_on_smooth_and_bent_surfaces(true); }

/// Reverses the faces and normals of a node's mesh.
void turn_over(Scene& scene, const std::string& node_name) {
  for (const Node& node : scene.nodes) {
    if (node.name != node_name) continue;
    Mesh& mesh = scene.meshes.at(static_cast<size_t>(node.meshes.at(0)));
    for (UVec3& t : mesh.triangles) std::swap(t.y, t.z);
    for (Vec3& n : mesh.normals) n = -n;
  }
}

TEST(BdptLayers, AllEstimatorsAgreeOnCulledFaces) {
  for (const ZooCamera camera : {ZooCamera::pinhole, ZooCamera::thin_lens}) {
    Scene scene = make_zoo(ZooLight::triangles, camera, false, false);
    const Scene whole = scene;
    for (const char* name : {"pane", "veil", "coated"}) {
      turn_over(scene, name);
      material(scene, name).cull_back_faces = true;
    }
    material(scene, "floor").cull_back_faces = true;
    expect_agreement(scene, kZooCameraNames[static_cast<int>(camera)], kSamples);
    EXPECT_GT(relative_difference(whole, scene), 0.01);
  }
}

}  // namespace
}  // namespace relume::testing
