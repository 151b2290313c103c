#include <algorithm>

#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::GltfBuilder;
using testing::json;
using testing::SceneFolder;

/// Folder with base.gltf: a triangle with material "paint" in node "part", a camera and a light.
class RelumeJson : public ::testing::Test {
 protected:
  RelumeJson() {
    GltfBuilder file;
    file.add("cameras", {{"type", "perspective"}, {"name", "old"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    file.add("materials", {{"name", "paint"}});
    file.add_root({{"name", "part"},
                   {"mesh", file.add_triangle({{"material", 0}})},
                   {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1}}});
    file.add_root({{"name", "eye"}, {"camera", 0}});
    folder_.write("base.gltf", file.text());
  }

  Scene load(json extra) const {
    extra["scene"] = "base.gltf";
    return load_scene(folder_.write("s.json", extra.dump()));
  }
  std::string error(const json& extra) const {
    return error_of([&] { load(extra); });
  }

  SceneFolder folder_;
};

Vec3 camera_direction(const Mat4& world) { return -Vec3(world[2]); }

TEST_F(RelumeJson, PutsItsCameraFirst) {
  const Scene scene = load({{"camera",
                             {{"eye", {1, 2, 3}},
                              {"target", {1, 2, 13}},
                              {"fov_y_deg", 90},
                              {"lens_radius", 0.1},
                              {"focus_distance", 4},
                              {"projection", "panoramic"}}}});
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_FLOAT_EQ(scene.cameras[0].fov_y_rad, kPi / 2);
  EXPECT_EQ(scene.cameras[0].lens_radius, 0.1f);
  EXPECT_EQ(scene.cameras[0].focus_distance, 4.0f);
  EXPECT_EQ(scene.cameras[0].projection, Projection::panoramic);
  EXPECT_EQ(scene.cameras[1].name, "old");
  EXPECT_EQ(scene.nodes[1].camera, 1);
  EXPECT_EQ(scene.nodes[2].camera, 0);
  const Mat4 world = world_matrices(scene, 0)[2];
  EXPECT_EQ(Vec3(world[3]), Vec3(1, 2, 3));
  EXPECT_NEAR(glm::distance(camera_direction(world), Vec3(0, 0, 1)), 0, 1e-6);
}

TEST_F(RelumeJson, AnimatesTheCamera) {
  const Scene scene = load({{"camera", {{"fov_y_deg", 60}}},
                            {"camera_keys",
                             {{{"time", 0}, {"eye", {0, 0, 0}}, {"target", {0, 0, -1}}},
                              {{"time", 2}, {"eye", {4, 0, 0}}, {"target", {5, 0, 0}}}}}});
  const Mat4 start = world_matrices(scene, 0)[2];
  const Mat4 middle = world_matrices(scene, 1)[2];
  EXPECT_NEAR(glm::distance(camera_direction(start), Vec3(0, 0, -1)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(Vec3(middle[3]), Vec3(2, 0, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(camera_direction(middle), glm::normalize(Vec3(1, 0, -1))), 0,
              1e-6);  // halfway through the turn
  EXPECT_NEAR(glm::distance(Vec3(middle[1]), Vec3(0, 1, 0)), 0, 1e-6);
}

TEST_F(RelumeJson, LooksStraightDown) {
  const Scene scene = load({{"camera", {{"eye", {0, 5, 0}}, {"target", {0, 0, 0}}}}});
  EXPECT_NEAR(glm::distance(camera_direction(world_matrices(scene, 0)[2]), Vec3(0, -1, 0)), 0, 1e-6);
}

TEST_F(RelumeJson, AddsLights) {
  const Scene scene =
      load({{"lights",
             {{{"type", "spot"},
               {"position", {1, 2, 3}},
               {"direction", {0, -2, 0}},
               {"intensity", {1, 2, 3}},
               {"inner_cone_deg", 10},
               {"outer_cone_deg", 20}},
              {{"type", "directional"}, {"name", "sun"}, {"intensity", 5}, {"angular_diameter_deg", 0.5}},
              {{"type", "point"}}}}});
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].type, PunctualType::spot);
  EXPECT_EQ(scene.lights[0].intensity, Rgb(1, 2, 3));
  EXPECT_FLOAT_EQ(scene.lights[0].inner_cone_rad, kPi / 18);
  EXPECT_FLOAT_EQ(scene.lights[0].outer_cone_rad, kPi / 9);
  EXPECT_EQ(scene.lights[1].intensity, Rgb(5));
  EXPECT_FLOAT_EQ(scene.lights[1].angular_diameter_rad, kPi / 360);
  const Mat4 world = world_matrices(scene, 0)[2];
  EXPECT_EQ(Vec3(world[3]), Vec3(1, 2, 3));
  EXPECT_NEAR(glm::distance(camera_direction(world), Vec3(0, -1, 0)), 0, 1e-6);  // lights also shine along -Z
}

TEST_F(RelumeJson, SetsTheEnvironment) {
  const Scene constant = load({{"environment", {{"constant", {1, 2, 3}}, {"scale", 2}}}});
  EXPECT_EQ(constant.environment.kind, EnvironmentKind::constant);
  EXPECT_EQ(constant.environment.color, Rgb(2, 4, 6));
  const Scene sky =
      load({{"environment",
             {{"sun_sky", {{"elevation_deg", 30}, {"azimuth_deg", 90}, {"turbidity", 5}, {"ground_albedo", 0.1}}}}}});
  EXPECT_EQ(sky.environment.kind, EnvironmentKind::sun_sky);
  EXPECT_FLOAT_EQ(sky.environment.sun_sky.sun_elevation_rad, kPi / 6);
  EXPECT_FLOAT_EQ(sky.environment.sun_sky.sun_azimuth_rad, kPi / 2);
  EXPECT_EQ(sky.environment.sun_sky.turbidity, 5.0f);
  EXPECT_EQ(sky.environment.sun_sky.ground_albedo, Rgb(0.1f));
}

/// Radiance file of 2 × 1 texels without run lengths: (1, 0.5, 0.25) has mantissas 128, 64, 32 and exponent 129 - 128.
const std::string kSky =
    std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") + "\x80\x40\x20\x81\x80\x80\x80\x82";

TEST_F(RelumeJson, ReadsEnvironmentMaps) {
  folder_.write("sky.hdr", kSky);
  const Scene scene = load({{"environment", {{"map", "sky.hdr"}, {"rotation_deg", 180}, {"scale", 3}}}});
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::map);
  EXPECT_FLOAT_EQ(scene.environment.rotation_rad, kPi);
  EXPECT_EQ(scene.environment.color, Rgb(3));
  ASSERT_EQ(scene.environment.map.size(), 2u);
  // Readers differ in adding half a step (2^-8) to the mantissa.
  EXPECT_NEAR(glm::distance(scene.environment.map[0], Rgb(1, 0.5f, 0.25f)), 0, 0.008);
  EXPECT_NE(error({{"environment", {{"map", "missing.hdr"}}}}).find("missing.hdr"), std::string::npos);
}

TEST_F(RelumeJson, FindsEnvironmentMapsByNameIfTheirPathIsFromAnotherMachine) {
  std::filesystem::create_directory(folder_.path() / "textures");
  for (const char* const place : {"textures/sky.hdr", "sky.hdr"}) {
    const auto sky = folder_.write(place, kSky);
    for (const char* const path : {R"(C:\art\sky.hdr)", "C:/art/sky.hdr", R"(\\srv\x\sky.hdr)", R"(..\art\sky.hdr)",
                                   "file:///C:/art/sky.hdr", "/nowhere/sky.hdr"}) {
      const Scene scene = load({{"environment", {{"map", path}}}});
      EXPECT_EQ(scene.environment.map.size(), 2u) << path;
      EXPECT_EQ(std::count(scene.source_files.begin(), scene.source_files.end(), sky), 1) << path;
    }
  }
}

TEST_F(RelumeJson, OverridesMaterials) {
  const Scene scene = load({{"materials",
                             {{"paint",
                               {{"base_color", {0.1, 0.2, 0.3}},
                                {"roughness", 0.25},
                                {"emission", 7},
                                {"alpha_mode", "blend"},
                                {"microfacet_model", "beckmann"},
                                {"double_sided", true}}}}}});
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, Rgb(7));
  EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(m.microfacet_model, MicrofacetModel::beckmann);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.metallic, 1.0f);  // unchanged
}

TEST_F(RelumeJson, MovesNodes) {
  const Scene scene = load({{"nodes",
                             {{"part",
                               {{"translation", {1, 0, 0}},
                                {"keys",
                                 {{{"time", 0}, {"rotation_deg", {0, 0, 0}}},
                                  {{"time", 2}, {"rotation_deg", {0, 180, 0}}, {"scale", {1, 1, 1}}}}}}}}}});
  EXPECT_EQ(scene.animation.size(), 2u);
  const Mat4 middle = world_matrices(scene, 1)[0];
  EXPECT_NEAR(glm::distance(Vec3(middle[3]), Vec3(1, 0, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(Vec3(middle[0]), Vec3(0, 0, -1)), 0, 1e-6);  // 90° about +Y
}

TEST_F(RelumeJson, MovesItsOwnLights) {
  const Scene scene =
      load({{"lights", {{{"type", "point"}, {"name", "lamp"}}}},
            {"nodes",
             {{"lamp",
               {{"keys", {{{"time", 0}, {"translation", {0, 1, 0}}}, {{"time", 2}, {"translation", {4, 1, 0}}}}}}}}}});
  const Node& lamp = scene.nodes.back();
  ASSERT_EQ(lamp.name, "lamp");
  EXPECT_EQ(Vec3(world_matrices(scene, 1).back()[3]), Vec3(2, 1, 0));
  EXPECT_EQ(animation_end(scene), 2.0f);
}

TEST_F(RelumeJson, TurnsAllTheWayRound) {
  const json keys = {{{"time", 0}, {"rotation_deg", {0, 0, 0}}}, {{"time", 4}, {"rotation_deg", {0, 360, 0}}}};
  const Scene scene = load({{"nodes", {{"part", {{"scale", {1, 1, 1}}, {"keys", keys}}}}}});
  const Vec3 expected[] = {{1, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  for (int t = 0; t <= 4; ++t) {
    const Mat4 world = world_matrices(scene, static_cast<float>(t))[0];
    EXPECT_NEAR(glm::distance(Vec3(world[0]), expected[t]), 0, 1e-5) << t;
  }
}

TEST_F(RelumeJson, KeepsSettingsVerbatim) {
  EXPECT_EQ(json::parse(load({{"settings", {{"max-bounces", 4}, {"psf", {{"cell", 1.5}}}}}}).settings_json),
            (json{{"max-bounces", 4}, {"psf", {{"cell", 1.5}}}}));
  EXPECT_TRUE(load(json::object()).settings_json.empty());
}

TEST_F(RelumeJson, RefersToBuiltinScenes) {
  const Scene scene = load_scene(folder_.write("b.json", R"({"scene": "builtin:cornell"})"));
  EXPECT_FALSE(scene.meshes.empty());
  const auto unknown = folder_.write("u.json", R"({"scene": "builtin:nothing"})");
  const std::string message = error_of([&] { load_scene(unknown); });
  EXPECT_NE(message.find("'nothing'"), std::string::npos);
  EXPECT_NE(message.find("cornell"), std::string::npos);
}

TEST_F(RelumeJson, ErrorsNameTheirPlace) {
  const json eye = {{"eye", {0, 0, 0}}, {"target", {0, 0, 0}}};
  const std::vector<std::pair<json, const char*>> cases = {
      {{{"camra", json::object()}}, "unknown key 'camra'; valid here are scene, camera"},
      {{{"camera", {{"eyee", {0, 0, 0}}}}}, "unknown key 'camera.eyee'; valid here are name, eye, target"},
      {{{"camera", {{"eye", {0, 0}}, {"target", {0, 0, 0}}}}}, "camera.eye must be a list of three numbers, not [0,0]"},
      {{{"camera", {{"eye", {0, 0, 0}}}}}, "camera.target is missing"},
      {{{"camera", eye}}, "camera.target equals the position of the camera"},
      {{{"camera", {{"eye", {0, 0, 0}}, {"target", {0, 0, 1}}, {"fov_y_deg", 200}}}},
       "camera.fov_y_deg is 200, but must be from"},
      {{{"camera", {{"eye", {0, 0, 0}}, {"target", {0, 0, 1}}, {"projection", "fisheye"}}}},
       "valid are perspective, orthographic, panoramic"},
      {{{"camera", 3}}, "camera must be an object, not number"},
      {{{"camera_keys", json::array()}}, "camera_keys is empty"},
      {{{"camera_keys",
         {{{"time", 0}, {"eye", {0, 0, 0}}, {"target", {0, 0, 1}}},
          {{"time", 0}, {"eye", {0, 0, 0}}, {"target", {0, 0, 1}}}}}},
       "camera_keys[1].time is 0, but must be later"},
      {{{"lights", {{{"type", "area"}}}}}, "lights[0].type is 'area'; valid are point, spot, directional"},
      {{{"lights", {{{"type", "point"}, {"intensity", -1}}}}}, "lights[0].intensity is -1, but must not be negative"},
      {{{"lights", json::object()}}, "lights must be a list"},
      {{{"environment", {{"constant", 1}, {"map", "x"}}}}, "exactly one of constant, map, sun_sky"},
      {{{"environment", {{"constant", "blue"}}}},
       "environment.constant must be a number or a list of three numbers, not \"blue\""},
      {{{"materials", {{"pain", json::object()}}}}, "no material 'pain'; it has paint"},
      {{{"materials", {{"paint", {{"rough", 1}}}}}}, "unknown key 'materials.paint.rough'"},
      {{{"materials", {{"paint", {{"roughness", 2}}}}}}, "materials.paint.roughness is 2, but must be from 0 to 1"},
      {{{"materials", {{"paint", {{"dispersion", -1}}}}}}, "materials.paint.dispersion is -1, but must"},
      {{{"materials", {{"paint", {{"dispersion", 21}}}}}},
       "materials.paint.dispersion is 21, but must be from 0 to 20"},
      {{{"nodes", {{"x", json::object()}}}}, "no node 'x'; it has part, eye"},
      {{{"settings", 4}}, "settings must be an object"},
  };
  for (const auto& [extra, expected] : cases) {
    const std::string message = error(extra);
    EXPECT_NE(message.find(expected), std::string::npos) << message;
    EXPECT_NE(message.find("s.json: "), std::string::npos) << message;
  }
}

TEST_F(RelumeJson, ReportsThePositionOfSyntaxErrors) {
  const auto file = folder_.write("broken.json", "{\n  \"scene\": \"base.gltf\",\n  \"camera\" 3\n}");
  EXPECT_NE(error_of([&] { load_scene(file); }).find("broken.json:3:12: JSON"), std::string::npos);
  const auto huge = folder_.write("huge.json", R"({"scene": 1e999})");
  EXPECT_EQ(error_of([&] { load_scene(huge); }),
            huge.string() + ": not valid JSON: a number is beyond 1.8e308; give a smaller one");
  const auto none = folder_.write("none.json", "{}");
  EXPECT_NE(error_of([&] { load_scene(none); }).find("scene is missing"), std::string::npos);
  const auto nested = folder_.write("nested.json", R"({"scene": "nested.json"})");
  EXPECT_NE(error_of([&] { load_scene(nested); }).find("another JSON file"), std::string::npos);
  const auto shouting = folder_.write("shouting.JSON", R"({"scene": "shouting.JSON"})");
  EXPECT_NE(error_of([&] { load_scene(shouting); }).find("another JSON file"), std::string::npos);
  const auto remote = folder_.write("remote.json", R"({"scene": "https://a.b/c.gltf"})");
  EXPECT_NE(error_of([&] { load_scene(remote); }).find("not a local file"), std::string::npos);
}

}  // namespace
}  // namespace relume
