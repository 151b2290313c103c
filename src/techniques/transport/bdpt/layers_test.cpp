// All estimators agree on layered materials and on culled faces.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "techniques/transport/bdpt/testing/bdpt_frame.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

Material& material(Scene& scene, const std::string& name) {
  for (Material& m : scene.materials) {
    if (m.name == name) return m;
  }
  throw std::out_of_range(name);
}

glm::dvec3 mean_of(const Scene& scene, const BdptOptions& options, int spp) {
  glm::dvec3 sum(0);
  const std::vector<Rgb> image = render_bdpt(Scene(scene), options, spp);
  for (const Rgb& p : image) sum += glm::dvec3(p);
  return sum / static_cast<double>(image.size());
}

/// Paths from the camera alone, bidirectional ones and paths from the light alone have the same mean.
void expect_agreement(const Scene& scene, const std::string& name) {
  constexpr int kSamples = 512;
  const glm::dvec3 camera_alone = mean_of(scene, {.max_light_vertices = 1}, kSamples);
  const glm::dvec3 both = mean_of(scene, {}, kSamples);
  const glm::dvec3 light_alone = mean_of(scene, {.light_only = true}, kSamples);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(both[c] / camera_alone[c], 1.0, 0.02) << name << ", channel " << c;
    EXPECT_NEAR(light_alone[c] / camera_alone[c], 1.0, 0.03) << name << ", channel " << c;
  }
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

void add_streaks(Scene& scene) {
  for (const char* name : {"metal", "floor"}) material(scene, name).anisotropy = 0.7f;
}

void add_leaves(Scene& scene) {
  for (const char* name : {"ball", "pane"}) material(scene, name).diffuse_transmission = 0.6f;
}

/// A coat that leans to one side of its base, and one over a lamp.
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

TEST(BdptLayers, AllEstimatorsAgree) {
  const std::pair<const char*, std::function<void(Scene&)>> layers[] = {
      {"sheen", add_sheen}, {"film", add_film}, {"streaks", add_streaks}, {"leaves", add_leaves}, {"coats", add_coats}};
  for (const auto& [name, add] : layers) {
    Scene scene = make_zoo(ZooLight::triangles, ZooCamera::pinhole, false, false);
    add(scene);
    expect_agreement(scene, name);
  }
}

/// The other way round, with the normals.
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
    const glm::dvec3 whole = mean_of(scene, {.max_light_vertices = 1}, 256);
    for (const char* name : {"pane", "veil", "coated"}) {
      turn_over(scene, name);
      material(scene, name).cull_back_faces = true;
    }
    material(scene, "floor").cull_back_faces = true;
    expect_agreement(scene, kZooCameraNames[static_cast<int>(camera)]);
    const glm::dvec3 culled = mean_of(scene, {.max_light_vertices = 1}, 256);
    EXPECT_GT(glm::distance(culled, whole), 0.01 * glm::length(whole));
  }
}

}  // namespace
}  // namespace relume::testing
