#include <array>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "relume/scene_io.h"
#include "scene_io/gltf/gltf_loader.h"
#include "scene_io/gltf/gltf_output.h"
#include "scene_io/testing/scene_files.h"
#include "scene_io/testing/written_gltf.h"
#include "scene_io/texture_decode.h"

namespace relume {
namespace {

using Json = nlohmann::json;
using testing::contents;
using testing::expect_sound_accessors;
using testing::written_json;

template <typename T>
T word_at(const std::string& bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// One quad with `material`.
Scene small_scene(Material material) {
  SceneBuilder builder("small");
  builder.add("quad", quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), builder.add_material(std::move(material)));
  builder.add_camera({0, 0, 3}, {0, 0, 0}, 40);
  return builder.take();
}

Texture small_texture(PixelFormat format) {
  Texture texture;
  texture.name = "two by one";
  texture.width = 2;
  texture.height = 1;
  texture.format = format;
  if (format == PixelFormat::rgba32_float) {
    const std::array<float, 8> values = {4, 0.5f, 0, 1, 0.25f, 1, 2, 0.5f};
    texture.texels.resize(sizeof values);
    std::memcpy(texture.texels.data(), values.data(), sizeof values);
  } else {
    for (const int value : {0, 55, 200, 255, 1, 128, 254, 7}) texture.texels.push_back(static_cast<std::byte>(value));
  }
  return texture;
}

TEST(GltfNumbers, AreShortAndExact) {
  EXPECT_EQ(gltf::number(0.1f).dump(), "0.1");
  EXPECT_EQ(gltf::number(-2).dump(), "-2.0");
  for (const float value : {1.0f / 3, 1e-30f, 3.1415927f, 16777216.0f, -0.0f})
    EXPECT_EQ(Json::parse(gltf::number(value).dump()).get<float>(), value);
}

TEST(GltfWriter, DefaultMaterialsStayEmpty) {
  const TempFolder folder;
  Material material;
  material.cull_back_faces = true;
  write_gltf(folder / "a.gltf", small_scene(material));
  const Json gltf = written_json(folder / "a.gltf");
  EXPECT_EQ(gltf["materials"][0], Json::parse(R"({"pbrMetallicRoughness": {}})"));
  EXPECT_FALSE(gltf.contains("extensionsUsed"));
}

TEST(GltfWriter, NamesTheCropThatItDoesNotWrite) {
  const TempFolder folder;
  Scene scene = small_scene({});
  EXPECT_TRUE(write_gltf(folder / "a.gltf", scene).empty());
  scene.crop.right = 0.5f;
  EXPECT_EQ(write_gltf(folder / "a.gltf", scene).size(), 1u);
}

TEST(GltfWriter, ReplacesInvalidUtf8InNames) {
  const TempFolder folder;
  Material material;
  material.name = "gr\xfcn";  // Latin-1
  for (const char* name : {"a.gltf", "a.glb"}) {
    write_gltf(folder / name, small_scene(material));
    EXPECT_EQ(load_scene(folder / name).materials[0].name, "gr\xef\xbf\xbdn");
  }
}

TEST(GltfWriter, WritesExtensionsThatDifferFromDefaults) {
  Material m;
  m.emission = {8, 4, 2};
  m.ior = 1.33f;
  m.dispersion = 0.5f;
  m.specular = 0.25f;
  m.specular_color = {1, 0.5f, 0.5f};
  m.transmission = 0.75f;
  m.thickness = 0.5f;
  m.attenuation_color = {0.5f, 0.25f, 1};
  m.attenuation_distance = 2;
  m.clearcoat = 1;
  m.clearcoat_roughness = 0.125f;
  m.unlit = true;
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 0.25f;
  m.double_sided = true;
  m.microfacet_model = MicrofacetModel::beckmann;
  const TempFolder folder;
  write_gltf(folder / "a.gltf", small_scene(m));
  EXPECT_EQ(written_json(folder / "a.gltf")["materials"][0], Json::parse(R"({
    "pbrMetallicRoughness": {}, "emissiveFactor": [1, 0.5, 0.25], "alphaMode": "MASK", "alphaCutoff": 0.25,
    "doubleSided": true, "extras": {"relume": {"microfacet_model": "beckmann"}},
    "extensions": {
      "KHR_materials_emissive_strength": {"emissiveStrength": 8},
      "KHR_materials_unlit": {}, "KHR_materials_ior": {"ior": 1.33},
      "KHR_materials_dispersion": {"dispersion": 0.5},
      "KHR_materials_specular": {"specularFactor": 0.25, "specularColorFactor": [1, 0.5, 0.5]},
      "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.125},
      "KHR_materials_transmission": {"transmissionFactor": 0.75},
      "KHR_materials_volume": {"thicknessFactor": 0.5, "attenuationColor": [0.5, 0.25, 1], "attenuationDistance": 2}}
  })"));
}

TEST(GltfWriter, WritesTexturesOnce) {
  Material m;
  m.base_color_texture.texture = 0;
  m.base_color_texture.uv_set = 1;
  m.base_color_texture.scale = {2, 3};
  m.emission_texture.texture = 0;
  Scene scene = small_scene(m);
  scene.textures.push_back(small_texture(PixelFormat::rgba8_srgb));
  scene.textures[0].wrap_u = WrapMode::mirror;
  scene.textures[0].filter = FilterMode::nearest;
  const TempFolder folder;
  EXPECT_TRUE(write_gltf(folder / "a b.gltf", scene).empty());
  const Json gltf = written_json(folder / "a b.gltf");
  EXPECT_EQ(gltf["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"], Json::parse(R"({
    "index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": {"scale": [2, 3]}}})"));
  EXPECT_EQ(gltf["materials"][0]["emissiveTexture"], Json::parse(R"({"index": 0})"));
  EXPECT_EQ(gltf["samplers"],
            Json::parse(R"([{"magFilter": 9728, "minFilter": 9728, "wrapS": 33648, "wrapT": 10497}])"));
  ASSERT_EQ(gltf["images"].size(), 1u);
  EXPECT_EQ(gltf["images"][0]["uri"], "a%20b.texture0.png");
  const std::string png = contents(folder / "a b.texture0.png");
  const Texture decoded = decode_texture(std::as_bytes(std::span(png)), "png", PixelFormat::rgba8_srgb);
  EXPECT_EQ(decoded.texels, scene.textures[0].texels);
}

TEST(GltfWriter, ConvertsTexturesToTheUseThatGltfExpects) {
  Material m;
  m.base_color_texture.texture = 0;
  m.metallic_roughness_texture.texture = 0;
  Scene scene = small_scene(m);
  scene.textures.push_back(small_texture(PixelFormat::rgba8_linear));
  const TempFolder folder;
  EXPECT_EQ(write_gltf(folder / "a.gltf", scene).size(), 1u);
  const std::string color = contents(folder / "a.texture0.png");
  const std::string data = contents(folder / "a.texture0.data.png");
  EXPECT_EQ(decode_texture(std::as_bytes(std::span(data)), "png", PixelFormat::rgba8_linear).texels,
            scene.textures[0].texels);
  const Texture encoded = decode_texture(std::as_bytes(std::span(color)), "png", PixelFormat::rgba8_srgb);
  EXPECT_EQ(static_cast<int>(encoded.texels[1]), 128);  // 55/255 of the light is sRGB 128/255 (IEC 61966-2-1)
  EXPECT_EQ(static_cast<int>(encoded.texels[7]), 7);    // alpha stays
}

TEST(GltfWriter, KeepsFloatTexelsInExr) {
  Material m;
  m.emission_texture.texture = 0;
  Scene scene = small_scene(m);
  scene.textures.push_back(small_texture(PixelFormat::rgba32_float));
  const TempFolder folder;
  EXPECT_EQ(write_gltf(folder / "a.glb", scene).size(), 1u);
  const ExrFile exr = read_exr(folder / "a.texture0.exr");
  ASSERT_NE(exr.find("R"), nullptr);
  EXPECT_EQ(exr.find("R")->values, (std::vector<float>{4, 0.25f}));
  EXPECT_EQ(exr.find("A")->values, (std::vector<float>{1, 0.5f}));
}

TEST(GltfWriter, WritesGlbChunks) {
  const TempFolder folder;
  write_gltf(folder / "a.glb", small_scene(Material()));
  const std::string bytes = contents(folder / "a.glb");
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word_at<uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(word_at<uint32_t>(bytes, 8), bytes.size());
  const size_t json_size = word_at<uint32_t>(bytes, 12);
  EXPECT_EQ(json_size % 4, 0u);
  const Json gltf = Json::parse(bytes.substr(20, json_size));
  const size_t binary = 20 + json_size;
  EXPECT_EQ(bytes.substr(binary + 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(binary + 8 + word_at<uint32_t>(bytes, binary), bytes.size());
  expect_sound_accessors(gltf, gltf["buffers"][0]["byteLength"]);
  const Json& position = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<size_t>()];
  EXPECT_EQ(position["min"], Json::parse("[0, 0, 0]"));
  EXPECT_EQ(position["max"], Json::parse("[1, 1, 0]"));
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(GltfWriter, ShearedInstancesBecomeNodes) {
  Scene scene = small_scene(Material());
  Mat4 shear(1);
  shear[1][0] = 0.5f;
  scene.nodes[0].instances = {Mat4(1), shear};
  const TempFolder folder;
  EXPECT_EQ(write_gltf(folder / "a.gltf", scene).size(), 1u);
  const Json gltf = written_json(folder / "a.gltf");
  ASSERT_EQ(gltf["nodes"].size(), 4u);
  EXPECT_EQ(gltf["nodes"][0]["children"], Json::parse("[2, 3]"));
  EXPECT_FALSE(gltf["nodes"][0].contains("mesh"));
  EXPECT_EQ(gltf["nodes"][3]["matrix"][4], 0.5);
  EXPECT_EQ(gltf["scenes"][0]["nodes"], Json::parse("[0, 1]"));
}

TEST(GltfWriter, KeepsKindsOfEnvironmentsAndAspectRatios) {
  const TempFolder folder;
  for (const EnvironmentKind kind : {EnvironmentKind::none, EnvironmentKind::studio, EnvironmentKind::automatic}) {
    for (const float rotation : {0.0f, 0.5f}) {
      Scene scene = small_scene(Material());
      scene.environment.kind = kind;
      scene.environment.rotation_rad = rotation;
      scene.cameras[0].aspect_ratio = 1.5f;
      EXPECT_TRUE(write_gltf(folder / "a.glb", scene).empty());
      const Scene loaded = load_gltf(folder / "a.glb");
      EXPECT_EQ(loaded.environment.kind, kind);
      const float kept = kind == EnvironmentKind::none ? 0.0f : rotation;
      EXPECT_NEAR(loaded.environment.rotation_rad, kept, 1e-6f);
      EXPECT_EQ(loaded.cameras[0].aspect_ratio, 1.5f);
    }
  }
}

TEST(GltfWriter, KeepsMixturesInExtras) {
  Material mixture;
  mixture.name = "mixture";
  mixture.mix_first = 2;
  mixture.mix_second = 1;
  mixture.mix_share = 0.25f;
  mixture.mix_texture.texture = 0;
  Scene scene = small_scene(mixture);
  scene.materials.emplace_back().name = "second";
  scene.materials.emplace_back().name = "first";
  Texture& texture = scene.textures.emplace_back();
  texture.width = texture.height = 1;
  texture.format = PixelFormat::rgba8_linear;
  texture.texels.assign(4, std::byte{100});
  const TempFolder folder;
  EXPECT_EQ(write_gltf(folder / "a.gltf", scene).size(), 1u);
  const Scene loaded = load_gltf(folder / "a.gltf");
  const Material& m = loaded.materials.at(0);
  EXPECT_FLOAT_EQ(m.mix_share, 0.25f);
  EXPECT_EQ(loaded.textures.at(static_cast<size_t>(m.mix_texture.texture)).texels[0], std::byte{100});
  EXPECT_EQ(loaded.materials.at(static_cast<size_t>(m.mix_first)).name, "first");
  EXPECT_EQ(loaded.materials.at(static_cast<size_t>(m.mix_second)).name, "second");
}

TEST(GltfWriter, IgnoresDamagedMixtures) {
  const TempFolder folder;
  write_gltf(folder / "a.gltf", small_scene({}));
  const std::string text = written_json(folder / "a.gltf").dump();
  const auto load = [&](const std::string& mix) {
    Json gltf = Json::parse(text);
    gltf["materials"][0]["extras"]["relume"]["mix"] = Json::parse(mix);
    write_file(folder / "b.gltf", gltf.dump());
    return load_gltf(folder / "b.gltf");
  };
  for (const char* mix : {R"({"first": 0})", R"({"first": 0, "second": 1e9})", R"({"first": -3, "second": 0})"}) {
    const Scene scene = load(mix);
    EXPECT_EQ(scene.materials.at(0).mix_first, kNone);
    EXPECT_TRUE(testing::mentions(scene.warnings, "a part of its mixture does not exist")) << mix;
  }
  EXPECT_THROW(load(R"({"first": 0, "second": 0})"), Error);  // of itself
}

TEST(GltfWriter, MixturesAreNestedToALimit) {
  const TempFolder folder;
  const auto load = [&](int length, bool from_inside) {
    Json gltf = Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": []}]})");
    for (int i = 0; i <= length; ++i) {
      Json material = Json::object();
      if (i < length) material["extras"]["relume"]["mix"] = {{"first", i + 1}, {"second", i + 1}};
      gltf["materials"].push_back(material);
    }
    const int every = length > 100 ? length : 1;
    for (int i = 0; i <= length; i += every)
      gltf["meshes"][0]["primitives"].push_back(
          {{"attributes", {{"POSITION", 0}}}, {"material", from_inside ? length - i : i}});
    write_file(folder / "a.gltf", gltf.dump());
    return load_gltf(folder / "a.gltf").materials.size();
  };
  for (const bool from_inside : {false, true}) {
    EXPECT_EQ(load(kMaxMixDepth, from_inside), static_cast<size_t>(kMaxMixDepth) + 1);
    EXPECT_THROW(load(kMaxMixDepth + 1, from_inside), Error);
    EXPECT_THROW(load(2000, from_inside), Error);
  }
}

TEST(GltfWriter, KeepsUnsupportedDataInExtras) {
  Scene scene = small_scene(Material());
  scene.settings_json = R"({"max-bounces": 3})";
  scene.environment.kind = EnvironmentKind::map;
  scene.environment.width = 2;
  scene.environment.height = 1;
  scene.environment.map = {Rgb(1, 2, 3), Rgb(100, 0, 0.5f)};
  scene.environment.color = Rgb(2);
  scene.cameras[0].lens_radius = 0.25f;
  scene.cameras[0].focus_distance = 4;
  PunctualLight sun;
  sun.type = PunctualType::directional;
  sun.angular_diameter_rad = kPi / 180;
  scene.lights.push_back(sun);
  scene.nodes[0].light = 0;
  const TempFolder folder;
  EXPECT_TRUE(write_gltf(folder / "a.gltf", scene).empty());
  const Json gltf = written_json(folder / "a.gltf");
  EXPECT_EQ(gltf["scenes"][0]["extras"]["relume"], Json::parse(R"({
    "environment": {"map": "a.environment.exr", "scale": [2, 2, 2]}, "settings": {"max-bounces": 3}})"));
  EXPECT_EQ(gltf["cameras"][0]["extras"]["relume"], Json::parse(R"({"lens_radius": 0.25, "focus_distance": 4})"));
  EXPECT_EQ(gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"]["relume"]["angular_diameter_deg"], 1);
  EXPECT_EQ(gltf["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"], 0);
  EXPECT_EQ(read_image(folder / "a.environment.exr").pixels, scene.environment.map);
  write_gltf(folder / "my room+%41.gltf", scene);
  EXPECT_EQ(load_gltf(folder / "my room+%41.gltf").environment.map, scene.environment.map);

  scene.environment = Environment();
  scene.environment.kind = EnvironmentKind::sun_sky;
  scene.environment.sun_sky.sun_elevation_rad = kPi / 6;
  write_gltf(folder / "b.gltf", scene);
  const Json sky = written_json(folder / "b.gltf")["scenes"][0]["extras"]["relume"]["environment"]["sun_sky"];
  EXPECT_NEAR(sky["elevation_deg"].get<double>(), 30, 1e-5);  // float degrees
  EXPECT_EQ(sky["turbidity"], 3);
}

TEST(GltfWriter, RejectsUnwritableScenes) {
  const TempFolder folder;
  const Scene scene = small_scene(Material());
  EXPECT_THROW(write_gltf(folder / "a.obj", scene), Error);
  EXPECT_THROW(write_gltf(folder / "missing/a.gltf", scene), Error);
  Scene broken = scene;
  broken.meshes[0].triangles[0].x = 99;
  EXPECT_THROW(write_gltf(folder / "a.gltf", broken), Error);
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace relume
