// Checks that the reader recovers what the writer writes, and that renderings agree.
#include <cmath>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/scene_io.h"
#include "scene/testing/figure.h"
#include "scene_io/testing/same_image.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::mentions;
using testing::SceneFolder;

Scene read_back(const Scene& scene, std::vector<std::string>* notes = nullptr) {
  const SceneFolder folder;
  const auto file = folder.path() / "out.pbrt";
  const std::vector<std::string> found = write_pbrt(file, scene);
  if (notes) *notes = found;
  return load_scene(file);
}

/// A quad that faces the camera, which looks along -Z from (0.2, 0.1, 3), with a material of that name.
Scene scene_of(Material material) {
  Scene scene;
  material.name = "paint";
  scene.materials.push_back(std::move(material));
  Mesh mesh;
  mesh.name = "quad";
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0.5f}, {-1, 1, 0}};
  mesh.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = 0;
  scene.meshes.push_back(std::move(mesh));
  Node node;
  node.name = "quad";
  node.meshes = {0};
  scene.add_node(node);
  Node camera;
  camera.camera = 0;
  camera.transform.translation = {0.2f, 0.1f, 3};
  Camera& lens = scene.cameras.emplace_back();
  lens.name = "camera";
  lens.fov_y_rad = 0.7f;
  lens.aspect_ratio = 1.5f;
  scene.add_node(camera);
  scene.environment.kind = EnvironmentKind::constant;
  return scene;
}

Material diffuse(const Rgb& color) {
  Material material;
  material.base_color = color;
  material.metallic = material.specular = 0;
  return material;
}

Material back(const Material& material) { return read_back(scene_of(material)).materials.at(0); }

void expect_near(const Rgb& a, const Rgb& b, float tolerance = 1e-3f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << c;
}

TEST(PbrtWriter, MaterialsRoundTrip) {
  Material plastic;
  plastic.base_color = {0.2f, 0.4f, 0.6f};
  plastic.metallic = 0;
  plastic.roughness = 0.3f;
  plastic.ior = 1.4f;
  expect_near(back(plastic).base_color, plastic.base_color);
  EXPECT_NEAR(back(plastic).roughness, 0.3f, 1e-4);
  EXPECT_NEAR(back(plastic).ior, 1.4f, 1e-4);
  Material matte;
  matte.base_color = {0.2f, 0.4f, 0.6f};
  matte.metallic = 0;
  matte.specular = 0;
  EXPECT_EQ(back(matte).base_color, matte.base_color);
  EXPECT_EQ(back(matte).specular, 0);
  Material metal;
  metal.base_color = {0.9f, 0.6f, 0.3f};
  metal.metallic = 1;
  metal.roughness = 0.4f;
  metal.clearcoat = 1;
  metal.clearcoat_roughness = 0.2f;
  metal.anisotropy = 0;
  expect_near(back(metal).base_color, metal.base_color, 1e-5f);
  EXPECT_NEAR(back(metal).roughness, 0.4f, 1e-4);
  EXPECT_NEAR(back(metal).clearcoat_roughness, 0.2f, 1e-4);
  metal.clearcoat = 0;
  metal.anisotropy = 0.5f;
  EXPECT_NEAR(back(metal).anisotropy, 0.5f, 1e-4);
  EXPECT_NEAR(back(metal).roughness, 0.4f, 1e-4);
  Material paper;
  paper.base_color = {0.8f, 0.6f, 0.4f};
  paper.metallic = 0;
  paper.specular = 0;
  paper.diffuse_transmission = 0.25f;
  const Material paper_back = back(paper);
  expect_near(paper_back.base_color * (1 - paper_back.diffuse_transmission), paper.base_color * 0.75f);
  expect_near(paper_back.diffuse_transmission_color * paper_back.diffuse_transmission, Rgb(0.25f));
}

TEST(PbrtWriter, GlassRoundTrips) {
  Material glass;
  glass.metallic = 0;
  glass.roughness = 0.1f;
  glass.ior = 1.6f;
  glass.dispersion = 0.4f;
  glass.transmission = 1;
  glass.thickness = 1;
  glass.attenuation_color = {0.5f, 0.25f, 1};
  glass.attenuation_distance = 2;
  const Material loaded = back(glass);
  EXPECT_NEAR(loaded.ior, 1.6f, 1e-3);
  EXPECT_NEAR(loaded.dispersion, 0.4f, 0.02f);
  EXPECT_NEAR(loaded.roughness, 0.1f, 1e-4);
  for (int c = 0; c < 2; ++c)
    EXPECT_NEAR(std::log(loaded.attenuation_color[c]) / loaded.attenuation_distance,
                std::log(glass.attenuation_color[c]) / 2, 1e-4);
  glass.thickness = 0;
  EXPECT_NEAR(back(glass).ior, 1.6f, 1e-3);
  EXPECT_EQ(back(glass).thickness, 0);
}

TEST(PbrtWriter, PartialTransmissionBecomesAMix) {
  Material window = diffuse({1, 1, 1});
  window.specular = 1;
  window.transmission = 0.25f;
  window.thickness = 1;
  const Material loaded = back(window);
  EXPECT_NEAR(loaded.transmission, 0.25f, 1e-5);
  EXPECT_GT(loaded.thickness, 0);
}

TEST(PbrtWriter, MixturesRoundTrip) {
  Scene scene = scene_of({});
  scene.materials.insert(scene.materials.end(), {diffuse({0.1f, 0.2f, 0.3f}), diffuse({1, 1, 1})});
  scene.materials[0].mix_first = 2;
  scene.materials[0].mix_second = 1;
  scene.materials[0].mix_share = 0.75f;
  Material& glass = scene.materials[2];
  glass.transmission = glass.thickness = glass.attenuation_distance = 1;
  glass.attenuation_color.r = 0.5f;
  const std::vector<Material> m = read_back(scene).materials;
  EXPECT_FLOAT_EQ(m.at(0).mix_share, 0.75f);
  expect_near(m.at(static_cast<size_t>(m[0].mix_second)).base_color, {0.1f, 0.2f, 0.3f});
  const Material& in = m.at(static_cast<size_t>(m[0].mix_first));
  EXPECT_NEAR(std::pow(in.attenuation_color.r, 1 / in.attenuation_distance), 0.5f, 1e-3f);
}

TEST(PbrtWriter, MetallicTexturesRoundTrip) {
  Material paint;
  paint.base_color = {0.6f, 0.3f, 0.1f};
  paint.roughness = 0.5f;
  paint.metallic_roughness_texture.texture = 0;
  Scene scene = scene_of(paint);
  Texture& texture = scene.textures.emplace_back();
  texture.format = PixelFormat::rgba8_linear;
  texture.width = 2;
  texture.height = 1;
  for (const int value : {0, 255, 0, 255, 0, 255, 128, 255}) texture.texels.push_back(std::byte(value));
  const Scene loaded = read_back(scene);
  const Material& m = loaded.materials.at(0);
  expect_near(m.base_color, paint.base_color, 2e-3f);
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.specular, 1);
  const Texture& back = loaded.textures.at(static_cast<size_t>(m.metallic_roughness_texture.texture));
  EXPECT_EQ(back.texels[2], std::byte{0});
  EXPECT_EQ(back.texels[6], std::byte{128});
  EXPECT_NEAR(std::to_integer<int>(back.texels[1]), 128, 2);  // r, times the factor 1
}

TEST(PbrtWriter, EmissionMapsLieBetween0And1) {
  Material lamp = diffuse({0, 0, 0});
  lamp.emission = {1, 1, 1};
  lamp.emission_texture.texture = 0;
  Scene scene = scene_of(lamp);
  Texture& texture = scene.textures.emplace_back();
  texture.width = texture.height = 1;
  texture.texels.assign(4, std::byte{255});
  for (Vec2& uv : scene.meshes[0].uv0) uv += Vec2(-3, 1);
  std::vector<std::string> notes;
  EXPECT_EQ(read_back(scene, &notes).meshes.at(0).uv0, scene_of(lamp).meshes[0].uv0);
  EXPECT_FALSE(mentions(notes, "do not repeat"));
  scene.meshes[0].uv0[0].x = 4;
  read_back(scene, &notes);
  EXPECT_TRUE(mentions(notes, "textures of emission do not repeat"));
}

TEST(PbrtWriter, MixedMaterialsKeepTheirNormalMap) {
  Material paint = diffuse({0.5f, 0.5f, 0.5f});
  paint.metallic = 0.5f;
  paint.normal_texture.texture = 0;
  Scene scene = scene_of(paint);
  Texture& texture = scene.textures.emplace_back();
  texture.width = texture.height = 1;
  for (const int value : {200, 128, 200, 255}) texture.texels.push_back(std::byte(value));
  EXPECT_TRUE(read_back(scene).materials.at(0).normal_texture.used());
}

TEST(PbrtWriter, TexturesAndEmissionRoundTrip) {
  Material lamp = diffuse({1, 1, 1});
  lamp.emission = {1, 2, 3};
  lamp.double_sided = true;
  Scene scene = scene_of(lamp);
  Texture texture;
  texture.name = "t";
  texture.width = 2;
  texture.height = 1;
  texture.wrap_u = WrapMode::clamp;
  texture.wrap_v = WrapMode::clamp;
  for (const int value : {255, 0, 0, 255, 0, 100, 200, 255}) texture.texels.push_back(std::byte(value));
  scene.textures.push_back(texture);
  TextureRef& ref = scene.materials[0].base_color_texture;
  ref.texture = 0;
  ref.offset = {0.5f, 0.25f};
  ref.scale = {2, 3};
  const Scene loaded = read_back(scene);
  const Material& m = loaded.materials.at(0);
  EXPECT_EQ(m.emission, Rgb(1, 2, 3));
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.base_color_texture.offset, Vec2(0.5f, 0.25f));
  EXPECT_EQ(m.base_color_texture.scale, Vec2(2, 3));
  EXPECT_EQ(loaded.textures.at(0).texels, texture.texels);
  EXPECT_EQ(loaded.textures[0].wrap_u, WrapMode::clamp);
  EXPECT_EQ(loaded.meshes[0].uv0, scene.meshes[0].uv0);
}

void expect_same_image(const Scene& scene) { testing::expect_same_image(scene, read_back(scene)); }

TEST(PbrtWriter, RenderingsAgree) {
  expect_same_image(find_builtin_scene("cornell")->build());
  Material paint = diffuse({0.8f, 0.3f, 0.1f});
  paint.specular = 1;
  paint.roughness = 0.4f;
  Scene scene = scene_of(paint);
  Node lamp;
  lamp.light = 0;
  lamp.transform.translation = {1, 1, 2};
  scene.lights.resize(2);
  scene.lights[0].intensity = {3, 4, 5};
  scene.add_node(lamp);
  lamp.light = 1;
  lamp.transform.translation = {-1, 0, 2};
  scene.lights[1].type = PunctualType::directional;
  scene.lights[1].intensity = {1, 0.5f, 0.25f};
  scene.add_node(lamp);
  scene.environment.color = {0.1f, 0.2f, 0.3f};
  expect_same_image(scene);
}

TEST(PbrtWriter, EnvironmentMapsKeepTheirDirections) {
  Scene scene = scene_of({});
  Environment& e = scene.environment;
  e.kind = EnvironmentKind::map;
  e.width = 64;
  e.height = 32;
  e.rotation_rad = 0.7f;
  e.color = {2, 1, 0.5f};
  for (int i = 0; i < 64 * 32; ++i) {
    const float phi = (static_cast<float>(i % 64) + 0.5f) / 64 * 2 * kPi;
    e.map.emplace_back(1 + std::sin(phi), 1 + std::cos(phi), static_cast<float>(i / 64) / 32);
  }
  scene.meshes[0].triangles.resize(1);
  expect_same_image(scene);
}

TEST(PbrtWriter, SettingsRoundTrip) {
  Scene scene = scene_of({});
  scene.settings_json = R"({"exposure":1.5,"height":200,"max-bounces":3,"spp":7,"width":300})";
  scene.crop = {.left = 0.25f, .top = 0.1f, .right = 1.0f / 3, .bottom = 1};
  EXPECT_EQ(read_back(scene).settings_json, scene.settings_json);
  EXPECT_EQ(read_back(scene).crop, scene.crop);
}

TEST(PbrtWriter, CamerasRoundTrip) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic, Projection::panoramic}) {
    Scene scene = scene_of({});
    scene.cameras[0].projection = projection;
    scene.cameras[0].half_height = 2;
    scene.cameras[0].lens_radius = 0.25f;
    scene.cameras[0].focus_distance = 3;
    scene.nodes[1].transform.rotation = glm::normalize(Quaternion(0.9f, 0.1f, 0.3f, 0.2f));
    const Scene loaded = read_back(scene);
    EXPECT_EQ(loaded.cameras.at(0).projection, projection);
    const Mat4 expected = world_matrices(scene, 0)[1];
    const Mat4 found = world_matrices(loaded, 0).back();
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(glm::distance(expected[c], found[c]), 0, 1e-5) << c;
    EXPECT_EQ(loaded.nodes[0].meshes.size(), 1u);  // no mirrored world above
    if (projection == Projection::orthographic) {
      EXPECT_EQ(loaded.cameras[0].half_height, 2);
      EXPECT_EQ(loaded.cameras[0].lens_radius, 0) << "relume ignores it, and pbrt would not";
    }
    if (projection != Projection::perspective) continue;
    EXPECT_NEAR(loaded.cameras[0].fov_y_rad, 0.7f, 1e-5);
    EXPECT_EQ(loaded.cameras[0].lens_radius, 0.25f);
    EXPECT_EQ(loaded.cameras[0].focus_distance, 3);
  }
}

TEST(PbrtWriter, TheCameraIsThatOfRelume) {
  Scene scene = scene_of({});
  scene.nodes[1].camera = 1;
  scene.cameras.push_back(scene.cameras[0]);
  scene.cameras[1].fov_y_rad = 1.1f;
  Node node;
  node.camera = 0;  // the first camera, on the last node
  node.transform.translation = {0, 0, 5};
  scene.add_node(node);
  std::vector<std::string> notes;
  const Scene loaded = read_back(scene, &notes);
  EXPECT_NEAR(loaded.cameras.at(0).fov_y_rad, 0.7f, 1e-5);
  EXPECT_NEAR(world_matrices(loaded, 0).back()[3].z, 5, 1e-5);
  EXPECT_TRUE(mentions(notes, "the first camera is written"));
}

TEST(PbrtWriter, InstancesStayInstances) {
  Scene scene = scene_of({});
  scene.nodes[0].instances = {Mat4(1), glm::mat4_cast(Quaternion(0, 0, 1, 0))};
  const Scene loaded = read_back(scene);
  EXPECT_EQ(loaded.meshes.size(), 1u);
  EXPECT_EQ(placed_triangles(loaded), 4u);
}

TEST(PbrtWriter, NotesWhatIsLost) {
  Material cloth = diffuse({0.5f, 0.5f, 0.5f});
  cloth.sheen_color = {1, 1, 1};
  Scene scene = scene_of(cloth);
  scene.meshes[0].colors.assign(4, Vec4(1));
  std::vector<std::string> notes;
  read_back(scene, &notes);
  EXPECT_TRUE(mentions(notes, "sheen"));
  EXPECT_TRUE(mentions(notes, "vertex colours"));
  EXPECT_TRUE(mentions(notes, "out.pbrt: "));
  const size_t others = notes.size();
  scene.visible_sets = {{Vec3(-2), Vec3(2), {0}}};
  scene.settings_json = R"({"shutter":0.02})";
  read_back(scene, &notes);
  EXPECT_EQ(notes.size(), others + 2);
  EXPECT_TRUE(mentions(notes, "visible sets") && mentions(notes, "the shutter"));
}

TEST(PbrtWriter, FiguresHaveTheirPoseAtTime0) {
  Scene scene = testing::figure({.morphs = true});
  for (AnimationChannel& channel : scene.animation) channel.times = {-0.5f, 0.5f};
  scene.settings_json = R"({"height":24,"width":24})";
  std::vector<std::string> notes;
  read_back(scene, &notes);
  EXPECT_TRUE(mentions(notes, "time 0"));
  expect_same_image(scene);
}

TEST(PbrtWriter, ModelsKeepTheirDefaultCameraAndStudio) {
  Scene model = scene_of(diffuse({0.5f, 0.3f, 0.1f}));
  model.nodes.pop_back();
  model.cameras.clear();
  model.environment.kind = EnvironmentKind::automatic;
  model.settings_json = R"({"height":24,"width":24})";
  expect_same_image(model);
  EXPECT_EQ(read_back(model).environment.kind, EnvironmentKind::map);
}

TEST(PbrtWriter, KeepsItsSources) {
  const SceneFolder folder;
  const auto file = folder.path() / "a.pbrt";
  write_pbrt(file, scene_of({}));
  const Scene loaded = load_scene(file);
  EXPECT_NE(error_of([&] { write_pbrt(file, loaded); }).find("would be replaced"), std::string::npos);
  EXPECT_NE(error_of([&] { write_pbrt(folder.path() / "a.pbr", loaded); }).find(".pbrt; choose it"), std::string::npos);
  EXPECT_NE(error_of([&] { write_pbrt(folder.path() / "none" / "a.pbrt", loaded); }).find("cannot be made"),
            std::string::npos);
}

TEST(PbrtWriter, FailedWritesLeaveNothing) {
  const SceneFolder folder;
  Scene scene = scene_of({});
  scene.source_files = {folder.write("a.pbrt", "WorldBegin\n")};
  EXPECT_NE(error_of([&] { write_pbrt(folder.path() / "a.pbrt", scene); }).find("would be replaced"),
            std::string::npos);
  std::error_code error;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.pbrt-data", error));
}

TEST(PbrtWriter, PbrtScenesExportToGltf) {
  const SceneFolder folder;
  write_pbrt(folder.path() / "a.pbrt", scene_of(diffuse({0.1f, 0.2f, 0.3f})));
  const Scene scene = load_scene(folder.path() / "a.pbrt");
  write_gltf(folder.path() / "a.glb", scene);
  const Scene loaded = load_scene(folder.path() / "a.glb");
  expect_near(loaded.materials.at(0).base_color, {0.1f, 0.2f, 0.3f});
  EXPECT_EQ(loaded.settings_json.empty(), false);
}

}  // namespace
}  // namespace relume
