#include "scene_io/assimp/assimp_loader.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "image/testing/png.h"
#include "relume/image_io.h"
#include "relume/scene_io.h"
#include "scene_io/testing/example_files.h"

namespace relume {
namespace {

using testing::dae_text;
using testing::error_of;
using testing::fbx_text;
using testing::kGrey;
using testing::make_png;
using testing::mentions;
using testing::SceneFolder;
using testing::solid_png;
using testing::to_bytes;

constexpr const char* kQuad =
    "mtllib a.mtl\nusemtl m\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3 4/4\n";

Scene load_obj(const SceneFolder& folder, const std::string& material) {
  folder.write("a.mtl", "newmtl m\n" + material);
  return load_scene(folder.write("a.obj", kQuad));
}

size_t material_of(const Scene& scene) { return static_cast<size_t>(scene.meshes.at(0).material); }

/// World position of a vertex of the first mesh.
Vec3 world_position(const Scene& scene, size_t vertex) {
  const auto world = world_matrices(scene, 0);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (!scene.nodes[i].meshes.empty())
      return transform_point(world[i],
                             scene.meshes[static_cast<size_t>(scene.nodes[i].meshes[0])].positions.at(vertex));
  }
  return Vec3(kInfinity);
}

TEST(Assimp, RecordsTheFilesThatItReads) {
  const std::string triangle = "\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  const std::string far_down = "v 9 9 9" + std::string(size_t{2} << 20, '\n') + "mtllib a.mtl";
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"mtllib a.mtl", {"a.mtl"}},
      {far_down, {"a.mtl"}},
      {"mtllib of my room.mtl", {"of my room.mtl"}},
      {R"(mtllib C:\art\a.mtl)", {"a.mtl"}},
      {"mtllib nowhere.mtl", {"nowhere.mtl", "room.mtl"}},  // assimp's replacement of a missing library
  };
  const SceneFolder folder;
  for (const char* name : {"a.mtl", "of my room.mtl", "room.mtl"}) folder.write(name, "newmtl m\nKd 0.1 0.2 0.3\n");
  for (const auto& [line, names] : cases) {
    SCOPED_TRACE(line.substr(line.rfind('\n') + 1));
    const auto obj = folder.write("room.obj", line + triangle);
    const Scene scene = load_scene(obj);
    EXPECT_EQ(scene.materials[material_of(scene)].base_color, Rgb(0.1f, 0.2f, 0.3f));
    const auto& files = scene.source_files;
    EXPECT_EQ(files.front(), obj);
    for (const std::string& name : names)
      EXPECT_EQ(std::count(files.begin(), files.end(), folder.path() / name), 1) << name;
  }
}

TEST(Assimp, LoadsObjWithTrianglesNormalsAndFlippedTextureCoordinates) {
  const SceneFolder folder;
  const Scene scene = load_obj(folder, "Kd 0.1 0.2 0.3\n");
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions.size(), 4u);
  ASSERT_EQ(mesh.normals.size(), 4u);
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  for (size_t i = 0; i < 4; ++i)
    EXPECT_EQ(mesh.uv0[i], Vec2(mesh.positions[i].x, 1 - mesh.positions[i].y));  // v points down
  EXPECT_EQ(scene.materials[material_of(scene)].base_color, Rgb(0.1f, 0.2f, 0.3f));
}

TEST(Assimp, TurnsPhongIntoMetallicRoughness) {
  const SceneFolder folder;
  const auto material = [&](const std::string& text) {
    const Scene scene = load_obj(folder, text);
    return scene.materials.at(material_of(scene));
  };
  const Material matt = material("Kd 0.5 0.5 0.5\nKs 0 0 0\nNs 100\n");
  EXPECT_EQ(matt.specular, 0.0f);
  EXPECT_EQ(matt.roughness, 1.0f);
  EXPECT_EQ(matt.metallic, 0.0f);
  const Material plastic = material("Kd 0.5 0 0\nKs 0.5 0.5 0.5\nNs 126\n");
  EXPECT_EQ(plastic.specular, 1.0f);
  EXPECT_EQ(plastic.metallic, 0.0f);
  EXPECT_FLOAT_EQ(plastic.roughness, std::sqrt(std::sqrt(2.0f / 128.0f)));
  const Material metal = material("Kd 0 0 0\nKs 0.9 0.6 0.3\nNs 200\n");
  EXPECT_EQ(metal.metallic, 1.0f);
  EXPECT_EQ(metal.base_color, Rgb(0.9f, 0.6f, 0.3f));
  const Material pbr = material("Kd 0.5 0.6 0.7\nPr 0.25\nPm 0.75\n");
  EXPECT_EQ(pbr.base_color, Rgb(0.5f, 0.6f, 0.7f));
  EXPECT_EQ(pbr.roughness, 0.25f);
  EXPECT_EQ(pbr.metallic, 0.75f);
  const Material lamp = material("Kd 0 0 0\nKe 3 4 5\n");
  EXPECT_EQ(lamp.emission, Rgb(3, 4, 5));
  const Material veil = material("Kd 1 1 1\nd 0.25\n");
  EXPECT_EQ(veil.alpha, 0.25f);
  EXPECT_EQ(veil.alpha_mode, AlphaMode::blend);
}

TEST(Assimp, MissingEmissiveTextureDoesNotEmit) {
  const SceneFolder folder;
  folder.write("lamp.png", solid_png(2, 2, 255, 255, 255, 255));
  const auto emission = [&](const std::string& text) {
    const Scene scene = load_obj(folder, text);
    return scene.materials.at(material_of(scene)).emission;
  };
  EXPECT_EQ(emission("Ke 0 0 0\nmap_Ke lamp.png\n"), Rgb(1));
  Image bright(2, 2);
  for (Rgb& pixel : bright.pixels) pixel = Rgb(5);
  write_image(folder.path() / "lamp.exr", bright);
  EXPECT_EQ(emission("Ke 0 0 0\nmap_Ke lamp.exr\n"), Rgb(1));
  EXPECT_EQ(emission("Ke 0 0 0\nmap_Ke nowhere.png\n"), Rgb(0));
  EXPECT_EQ(emission("Ke 3 4 5\nmap_Ke nowhere.png\n"), Rgb(3, 4, 5));
}

TEST(Assimp, MergesOpacityIntoTheColourTexture) {
  const SceneFolder folder;
  folder.write("color.png", solid_png(2, 2, 10, 20, 30, 255));
  folder.write("holes.png", solid_png(4, 4, 0, 0, 0, 255));
  const Scene scene = load_obj(folder, "Kd 1 1 1\nmap_Kd color.png\nmap_d holes.png\n");
  const Material& m = scene.materials[material_of(scene)];
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  const Texture& texture = scene.textures.at(static_cast<size_t>(m.base_color_texture.texture));
  EXPECT_EQ(texture.width, 4);
  EXPECT_EQ(texture.format, PixelFormat::rgba8_srgb);
  EXPECT_EQ(std::to_integer<int>(texture.texels[0]), 10);
  EXPECT_EQ(std::to_integer<int>(texture.texels[3]), 0);
}

TEST(Assimp, MasksColourTexturesWithHoles) {
  const SceneFolder folder;
  folder.write("leaf.png", solid_png(2, 2, 10, 20, 30, 0));
  const Scene scene = load_obj(folder, "Kd 1 1 1\nmap_Kd leaf.png\n");
  EXPECT_EQ(scene.materials[material_of(scene)].alpha_mode, AlphaMode::mask);
}

TEST(Assimp, PacksRoughnessAndMetalness) {
  const SceneFolder folder;
  folder.write("r.png", solid_png(2, 2, 100, 0, 0, 255));
  folder.write("m.png", solid_png(2, 2, 200, 0, 0, 255));
  const Scene scene = load_obj(folder, "Kd 1 1 1\nPr 1\nPm 1\nmap_Pr r.png\nmap_Pm m.png\n");
  const TextureRef& ref = scene.materials[material_of(scene)].metallic_roughness_texture;
  ASSERT_TRUE(ref.used());
  const Texture& texture = scene.textures[static_cast<size_t>(ref.texture)];
  EXPECT_EQ(texture.format, PixelFormat::rgba8_linear);
  EXPECT_EQ(std::to_integer<int>(texture.texels[1]), 100);
  EXPECT_EQ(std::to_integer<int>(texture.texels[2]), 200);
}

TEST(Assimp, ReplacesMissingTexturesAndTellsHeightFromNormalMaps) {
  const SceneFolder folder;
  folder.write("grey.png", solid_png(2, 2, 90, 90, 90, 255));
  folder.write("normal.png", solid_png(2, 2, 120, 130, 250, 255));
  const Scene height = load_obj(folder, "Kd 1 1 1\nmap_Kd C:\\nowhere\\missing.png\nmap_Bump grey.png\n");
  EXPECT_TRUE(mentions(height.warnings, "missing.png"));
  EXPECT_TRUE(mentions(height.warnings, "height maps"));
  const Scene normal = load_obj(folder, "Kd 1 1 1\nmap_Bump normal.png\n");
  const TextureRef& ref = normal.materials[material_of(normal)].normal_texture;
  ASSERT_TRUE(ref.used());
  EXPECT_EQ(std::to_integer<int>(normal.textures[static_cast<size_t>(ref.texture)].texels[2]), 250);
}

/// Texel 0 of a float texture.
Vec4 first_texel(const Scene& scene, const TextureRef& ref) {
  const Texture& texture = scene.textures.at(static_cast<size_t>(ref.texture));
  EXPECT_EQ(texture.format, PixelFormat::rgba32_float);
  Vec4 texel(-1);
  if (texture.texels.size() >= sizeof texel) std::memcpy(&texel, texture.texels.data(), sizeof texel);
  return texel;
}

TEST(Assimp, CombinesImagesOfMoreThanEightBits) {
  const SceneFolder folder;
  folder.write("height.png", make_png(2, 1, 16, kGrey, {0x12, 0x34, 0x56, 0x78}));
  EXPECT_TRUE(mentions(load_obj(folder, "Kd 1 1 1\nmap_Bump height.png\n").warnings, "height maps"));

  folder.write("r.png", make_png(1, 1, 16, kGrey, {0x27, 0x10}));
  folder.write("m.png", solid_png(2, 2, 200, 0, 0, 255));
  const Scene rough = load_obj(folder, "Kd 1 1 1\nPr 1\nPm 1\nmap_Pr r.png\nmap_Pm m.png\n");
  EXPECT_EQ(first_texel(rough, rough.materials[material_of(rough)].metallic_roughness_texture),
            Vec4(1, 10000.0f / 65535.0f, 200.0f / 255.0f, 1));

  Image bright(1, 1);
  bright.pixels[0] = Rgb(2, 3, 4);
  write_image(folder.path() / "bright.exr", bright);
  folder.write("holes.png", solid_png(4, 4, 0, 0, 0, 255));
  const Scene masked = load_obj(folder, "Kd 1 1 1\nmap_Kd bright.exr\nmap_d holes.png\n");
  EXPECT_EQ(first_texel(masked, masked.materials[material_of(masked)].base_color_texture), Vec4(2, 3, 4, 0));
}

TEST(Assimp, RepairsFloatTexturesWithAWarning) {
  const SceneFolder folder;
  Image image(1, 1);
  image.pixels[0] = Rgb(std::nanf(""), 0.5f, 3);
  write_image(folder.path() / "r.exr", image);
  const Scene scene = load_obj(folder, "Kd 1 1 1\nPr 1\nmap_Pr r.exr\n");
  EXPECT_EQ(first_texel(scene, scene.materials[material_of(scene)].metallic_roughness_texture).y, 0.0f);
  EXPECT_TRUE(mentions(scene.warnings, "r.exr: 2 values are negative, above 1 or not finite"));
}

TEST(Assimp, LoadsStlAndOff) {
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\nendloop\nendfacet\nendsolid "
      "a\n";
  EXPECT_EQ(load_assimp_from_memory(to_bytes(stl), "stl", "a.stl").meshes.at(0).triangles.size(), 1u);
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(load_assimp_from_memory(to_bytes(off), "off", "a.off").meshes.at(0).positions.size(), 3u);
}

TEST(Assimp, SkipsEmptySolids) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\nendloop\nendfacet\n";
  const auto load = [](const std::string& text) { return load_assimp_from_memory(to_bytes(text), "stl", "a.stl"); };
  const std::string empty = "solid empty\nendsolid empty\n";
  const Scene scene = load("solid a\n" + facet + "endsolid a\n" + empty + "solid b\n" + facet + facet + "endsolid b\n");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].triangles.size() + scene.meshes[1].triangles.size(), 3u);
  EXPECT_EQ(placed_triangles(scene), 3u);
  EXPECT_NE(error_of([&] { load(empty + empty); }).find("no triangles"), std::string::npos);
}

TEST(Assimp, ConvertsColladaUnitsAxesLightsAndCameras) {
  const Scene scene = load_assimp_from_memory(to_bytes(dae_text()), "dae", "a.dae");
  // (0, 0, 100) cm with Z up is (0, 1, 0) m with Y up.
  EXPECT_NEAR(glm::distance(world_position(scene, 0), Vec3(0, 1, 0)), 0, 1e-6);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_NEAR(scene.cameras[0].fov_y_rad, 40 * kPi / 180, 1e-3);  // converted to the horizontal angle and back
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].intensity, Rgb(2, 3, 4));
}

TEST(Assimp, ConvertsFbxUnitsAndAxes) {
  const Scene y_up = load_assimp_from_memory(to_bytes(fbx_text(1)), "fbx", "a.fbx");
  EXPECT_NEAR(glm::distance(world_position(y_up, 0), Vec3(0, 0, 1)), 0, 1e-6);
  const Scene z_up = load_assimp_from_memory(to_bytes(fbx_text(2)), "fbx", "a.fbx");
  EXPECT_NEAR(glm::distance(world_position(z_up, 0), Vec3(0, 1, 0)), 0, 1e-6);
}

/// Peak memory of this process and of its largest child, in KiB.
long peak_kib() {
  rusage self{};
  rusage children{};
  getrusage(RUSAGE_SELF, &self);
  getrusage(RUSAGE_CHILDREN, &children);
  return self.ru_maxrss + children.ru_maxrss;
}

TEST(Assimp, StopsReadersThatExhaustMemory) {
  std::string dae = dae_text();
  dae.replace(dae.find("<p>0 1 2</p>"), 12, "<p>0 x 2</p>");
  const std::string off = "OFF\n353535235358 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  // assimp's versions differ here: the result is a scene or an Error.
  error_of([&] { load_assimp_from_memory(to_bytes(dae), "dae", "a.dae"); });
  error_of([&] { load_assimp_from_memory(to_bytes(off), "off", "a.off"); });
  EXPECT_LT(peak_kib(), 2 << 20);
}

TEST(Assimp, RejectsUnreadableFiles) {
  const SceneFolder folder;
  EXPECT_NE(error_of([&] { load_scene(folder.path() / "missing.obj"); }).find("does not exist"), std::string::npos);
  EXPECT_NE(error_of([&] { load_scene(folder.write("a.xyz", "1")); }).find("extension 'xyz'"), std::string::npos);
  EXPECT_NE(error_of([&] { load_scene(folder.write("e.obj", "")); }).find("empty"), std::string::npos);
  EXPECT_NE(error_of([&] { load_scene(folder.write("c.obj", "# nothing\n\n\n\n\n\n\n\n\n")); }), "");
  EXPECT_NE(error_of([&] { load_scene(folder.path()); }), "");
}

}  // namespace
}  // namespace relume
