// Tests that built-in scenes survive export to glTF and import.
#include <array>
#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
#include "scene_io/gltf/gltf_loader.h"
#include "scene_io/testing/written_gltf.h"

namespace relume {
namespace {

using Json = nlohmann::json;
using testing::expect_sound_accessors;
using testing::written_json;

/// Collects the names of all extensions in the document.
void collect_extensions(const Json& json, std::set<std::string>& names) {
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) {
    if (key == "extensions") {
      for (const auto& [name, members] : value.items()) names.insert(name);
    }
    collect_extensions(value, names);
  }
}

size_t triangle_count(const Json& gltf) {
  size_t sum = 0;
  for (const Json& node : gltf["nodes"]) {
    if (!node.contains("mesh")) continue;
    size_t copies = 1;
    if (node.contains("extensions") && node["extensions"].contains("EXT_mesh_gpu_instancing")) {
      const size_t accessor = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"];
      copies = gltf["accessors"][accessor]["count"];
    }
    for (const Json& primitive : gltf["meshes"][node["mesh"].get<size_t>()]["primitives"]) {
      sum += copies * gltf["accessors"][primitive["indices"].get<size_t>()]["count"].get<size_t>() / 3;
    }
  }
  return sum;
}

/// Allows the rounding of a few float operations, relative to the values.
void expect_near(const Mat4& a, const Mat4& b) {
  for (int c = 0; c < 4; ++c) EXPECT_LE(glm::distance(a[c], b[c]), 1e-5f * (1 + glm::length(a[c])));
}

/// Allows one conversion to degrees and back, or of factor times strength.
void expect_near(const Vec3& a, const Vec3& b) { EXPECT_LE(glm::distance(a, b), 1e-6f * glm::length(a)); }
void expect_near(float a, float b) { EXPECT_NEAR(a, b, 1e-6f * (1 + std::fabs(a))); }

void expect_same(const Material& a, const Material& b) {
  EXPECT_EQ(a.name, b.name);
  expect_near(a.emission, b.emission);
  EXPECT_EQ(std::tie(a.base_color, a.alpha, a.metallic, a.roughness, a.normal_scale, a.alpha_mode, a.alpha_cutoff),
            std::tie(b.base_color, b.alpha, b.metallic, b.roughness, b.normal_scale, b.alpha_mode, b.alpha_cutoff));
  EXPECT_EQ(std::tie(a.double_sided, a.unlit, a.ior, a.specular, a.specular_color, a.transmission, a.thickness),
            std::tie(b.double_sided, b.unlit, b.ior, b.specular, b.specular_color, b.transmission, b.thickness));
  EXPECT_EQ(std::tie(a.attenuation_color, a.attenuation_distance, a.clearcoat, a.clearcoat_roughness),
            std::tie(b.attenuation_color, b.attenuation_distance, b.clearcoat, b.clearcoat_roughness));
  EXPECT_EQ(a.microfacet_model, b.microfacet_model);
  for (size_t i = 0; i < texture_refs(a).size(); ++i) {
    EXPECT_EQ(texture_refs(a)[i]->used(), texture_refs(b)[i]->used()) << a.name;
    EXPECT_EQ(texture_refs(a)[i]->uv_set, texture_refs(b)[i]->uv_set) << a.name;
  }
}

void expect_same(const PunctualLight& a, const PunctualLight& b) {
  EXPECT_EQ(std::tie(a.name, a.type), std::tie(b.name, b.type));
  expect_near(a.intensity, b.intensity);
  expect_near(a.inner_cone_rad, b.inner_cone_rad);
  expect_near(a.outer_cone_rad, b.outer_cone_rad);
  expect_near(a.angular_diameter_rad, b.angular_diameter_rad);
}

void expect_same(const Camera& a, const Camera& b) {
  EXPECT_EQ(std::tie(a.name, a.projection, a.lens_radius), std::tie(b.name, b.projection, b.lens_radius));
  expect_near(a.fov_y_rad, b.fov_y_rad);
  expect_near(a.half_height, b.half_height);
  if (a.lens_radius > 0) expect_near(a.focus_distance, b.focus_distance);
}

void expect_same(const Environment& a, const Environment& b) {
  EXPECT_EQ(std::tie(a.kind, a.color, a.map), std::tie(b.kind, b.color, b.map));
  expect_near(a.rotation_rad, b.rotation_rad);
  if (a.kind != EnvironmentKind::sun_sky) return;
  const auto numbers = [](const SunSky& s) {
    return std::array{s.sun_elevation_rad,        s.sun_azimuth_rad, s.turbidity,       s.sky_scale,      s.sun_scale,
                      s.sun_angular_diameter_rad, s.ground_albedo.r, s.ground_albedo.g, s.ground_albedo.b};
  };
  for (size_t i = 0; i < numbers(a.sun_sky).size(); ++i) expect_near(numbers(a.sun_sky)[i], numbers(b.sun_sky)[i]);
}

class BuiltinExport : public ::testing::TestWithParam<std::string> {};

TEST_P(BuiltinExport, HasTheStructureOfTheScene) {
  const Scene scene = find_builtin_scene(GetParam())->build();
  const TempFolder folder;
  EXPECT_TRUE(write_gltf(folder / "scene.gltf", scene).empty());
  const Json gltf = written_json(folder / "scene.gltf");
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  EXPECT_EQ(gltf["nodes"].size(), scene.nodes.size());
  EXPECT_EQ(gltf["materials"].size(), scene.materials.size());
  EXPECT_EQ(gltf["cameras"].size(), scene.cameras.size());
  EXPECT_EQ(triangle_count(gltf), placed_triangles(scene));
  expect_sound_accessors(gltf, std::filesystem::file_size(folder / "scene.bin"));
  std::set<std::string> extensions;
  collect_extensions(gltf, extensions);
  EXPECT_EQ(gltf.value("extensionsUsed", std::set<std::string>()), extensions);
  EXPECT_EQ(gltf.contains("animations"), !scene.animation.empty());
}

/// The loaded scene equals the exported one.
TEST_P(BuiltinExport, RoundTripsUnchanged) {
  const Scene scene = find_builtin_scene(GetParam())->build();
  const TempFolder folder;
  write_gltf(folder / "scene.glb", scene);
  const Scene loaded = load_gltf(folder / "scene.glb");
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  ASSERT_EQ(loaded.nodes.size(), scene.nodes.size());
  EXPECT_EQ(placed_triangles(loaded), placed_triangles(scene));
  expect_same(scene.environment, loaded.environment);
  EXPECT_EQ(nlohmann::json::parse(loaded.settings_json), nlohmann::json::parse(scene.settings_json));
  EXPECT_TRUE(loaded.visible_sets == scene.visible_sets);
  const float end = animation_end(scene);
  EXPECT_EQ(animation_end(loaded), end);
  // The order of nodes may differ; built-in nodes have unique names.
  const auto node_named = [&](const std::string& name) {
    for (size_t i = 0; i < loaded.nodes.size(); ++i) {
      if (loaded.nodes[i].name == name) return i;
    }
    ADD_FAILURE() << name;
    return size_t{0};
  };
  for (const float time : {0.0f, 0.37f * end}) {
    const std::vector<Mat4> before = world_matrices(scene, time);
    const std::vector<Mat4> after = world_matrices(loaded, time);
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
      const Node& node = scene.nodes[i];
      const size_t k = node_named(node.name);
      expect_near(before[i], after[k]);
      ASSERT_EQ(loaded.nodes[k].instances.size(), node.instances.size());
      for (size_t j = 0; j < node.instances.size(); ++j) expect_near(node.instances[j], loaded.nodes[k].instances[j]);
      ASSERT_EQ(node.light == kNone, loaded.nodes[k].light == kNone) << node.name;
      if (node.light != kNone) {
        expect_same(scene.lights[static_cast<size_t>(node.light)],
                    loaded.lights[static_cast<size_t>(loaded.nodes[k].light)]);
      }
      ASSERT_EQ(node.camera == kNone, loaded.nodes[k].camera == kNone) << node.name;
      if (node.camera != kNone) {
        expect_same(scene.cameras[static_cast<size_t>(node.camera)],
                    loaded.cameras[static_cast<size_t>(loaded.nodes[k].camera)]);
      }
      ASSERT_EQ(loaded.nodes[k].meshes.size(), node.meshes.size());
      for (size_t j = 0; j < node.meshes.size(); ++j) {
        const Mesh& a = scene.meshes[static_cast<size_t>(node.meshes[j])];
        const Mesh& b = loaded.meshes[static_cast<size_t>(loaded.nodes[k].meshes[j])];
        EXPECT_EQ(a.positions, b.positions);
        ASSERT_EQ(a.normals.size(), b.normals.size());
        // The loader normalises again.
        for (size_t v = 0; v < a.normals.size(); ++v) ASSERT_LT(glm::distance(a.normals[v], b.normals[v]), 1e-6f);
        EXPECT_EQ(a.uv0, b.uv0);
        EXPECT_TRUE(a.triangles == b.triangles) << a.name;
        EXPECT_EQ(a.uv1, b.uv1);
        EXPECT_EQ(a.colors, b.colors);
        expect_same(scene.materials[static_cast<size_t>(a.material)],
                    loaded.materials[static_cast<size_t>(b.material)]);
      }
    }
  }
}

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const BuiltinScene& scene : builtin_scenes()) names.emplace_back(scene.name);
  for (const char* name : {"base-1", "skylight", "turntable-spot", "warehouse-rooms"}) names.emplace_back(name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(, BuiltinExport, ::testing::ValuesIn(all_names()), [](const auto& param) {
  std::string name = param.param;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
});

}  // namespace
}  // namespace relume
