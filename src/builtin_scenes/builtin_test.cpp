// Properties of all built-in scenes, and of individual ones.
#include "builtin_scenes/builtin.h"

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/testing/scene_queries.h"
#include "relume/builtin_scenes.h"

namespace relume {
namespace {

using testing::camera_node;
using testing::emissive_count;
using testing::Hit;
using testing::scene_named;
using testing::spread;
using testing::trace;
using testing::triangle_count;

TEST(BuiltinScenes, NamesAreUniqueAndFound) {
  std::set<std::string_view> names;
  for (const std::vector<BuiltinScene>* list : {&builtin_scenes(), &experiment_scenes()}) {
    for (const BuiltinScene& scene : *list) {
      EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
      EXPECT_FALSE(scene.summary.empty()) << scene.name;
      EXPECT_EQ(find_builtin_scene(scene.name), &scene);
      EXPECT_EQ(scene_named(scene.name).name, scene.name);
    }
  }
  EXPECT_EQ(find_builtin_scene("no such scene"), nullptr);
}

class EveryScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryScene, Validates) {
  const Scene& scene = scene_named(GetParam());
  EXPECT_NO_THROW(validate(scene, GetParam()));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_P(EveryScene, HasACameraAndLight) {
  const Scene& scene = scene_named(GetParam());
  ASSERT_FALSE(scene.cameras.empty());
  EXPECT_EQ(scene.nodes[camera_node(scene)].camera, 0);
  EXPECT_TRUE(emissive_count(scene) > 0 || scene.environment.kind != EnvironmentKind::none);
}

TEST_P(EveryScene, ReportsWhetherItMoves) {
  const Scene& scene = scene_named(GetParam());
  const std::string_view summary = find_builtin_scene(GetParam())->summary;
  const bool camera_path = summary.ends_with("(camera path)");
  const bool camera_moves = moving_nodes(scene)[camera_node(scene)];
  EXPECT_EQ(camera_path, camera_moves) << summary;
  EXPECT_EQ(camera_path || summary.ends_with("(animated)"), !scene.animation.empty()) << summary;
}

TEST_P(EveryScene, NormalsAgreeWithWinding) {
  for (const Mesh& mesh : scene_named(GetParam()).meshes) {
    EXPECT_FALSE(mesh.triangles.empty()) << mesh.name;
    size_t wrong = 0;
    size_t degenerate = 0;
    for (const UVec3& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t.x];
      const Vec3 cross = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
      degenerate += cross == Vec3(0);
      if (mesh.normals.empty()) continue;
      for (const uint32_t i : {t.x, t.y, t.z}) wrong += glm::dot(cross, mesh.normals[i]) <= 0;
    }
    EXPECT_EQ(wrong, 0u) << mesh.name;
    EXPECT_EQ(degenerate, 0u) << mesh.name;
    for (const Vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-5f) << mesh.name;  // a few float roundings
  }
}

TEST_P(EveryScene, MaterialsArePlausible) {
  const bool furnace = GetParam() == "furnace";
  for (const Material& m : scene_named(GetParam()).materials) {
    const float most = max_component(m.base_color);
    if (m.transmission == 0) {
      EXPECT_LE(most, furnace ? 1.0f : 0.9f) << m.name;
    }
    EXPECT_GE(min_component(m.base_color), 0.0f) << m.name;
    EXPECT_FALSE(m.double_sided) << m.name;
  }
}

TEST_P(EveryScene, MatricesKeepOrientation) {
  const Scene& scene = scene_named(GetParam());
  for (const Mat4& m : world_matrices(scene, 0)) EXPECT_GT(glm::determinant(Mat3(m)), 0);
  for (const Node& node : scene.nodes) {
    for (const Mat4& m : node.instances) EXPECT_GT(glm::determinant(Mat3(m)), 0) << node.name;
  }
}

/// A camera path that starts at time 0 starts with the view of the still camera.
TEST_P(EveryScene, AnimationStartsAtTheStill) {
  const Scene& scene = scene_named(GetParam());
  Scene still = scene;
  still.animation.clear();
  const std::vector<Mat4> moving = world_matrices(scene, 0);
  const std::vector<Mat4> at_rest = world_matrices(still, 0);
  for (size_t i = 0; i < moving.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      EXPECT_LT(glm::distance(moving[i][c], at_rest[i][c]), 1e-3f) << scene.nodes[i].name;  // matrices of up to 1e3
    }
  }
}

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const BuiltinSceneInfo& scene : list_builtin_scenes()) names.push_back(scene.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(, EveryScene, ::testing::ValuesIn(all_names()), [](const auto& param) {
  std::string name = param.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

TEST(BuiltinScenes, SizesAreAsPromised) {
  EXPECT_GE(triangle_count(scene_named("cover")), 1'000'000u);
  EXPECT_EQ(emissive_count(scene_named("cover")), 2u * 10);
  EXPECT_EQ(emissive_count(scene_named("warehouse")), 2u * 268);
  EXPECT_EQ(triangle_count(scene_named("warehouse")), 157'208u);
  const Scene& city = scene_named("city");
  EXPECT_GE(triangle_count(city), 10'000'000u);
  size_t in_memory = 0;
  for (const Mesh& mesh : city.meshes) in_memory += mesh.triangles.size();
  EXPECT_LE(in_memory, 300'000u);
}

TEST(BuiltinScenes, AnimatedScenesMove) {
  for (const char* name :
       {"turntable", "turntable-spot", "slit", "corridor", "city", "warehouse", "mine", "cornell-closed"}) {
    const Scene& scene = scene_named(name);
    EXPECT_FALSE(scene.animation.empty()) << name;
    EXPECT_GT(animation_end(scene), 5.0f) << name;
  }
  for (const char* name : {"corridor", "city", "warehouse", "mine", "cornell-closed"}) {
    const Scene& scene = scene_named(name);
    EXPECT_TRUE(moving_nodes(scene)[camera_node(scene)]) << name;
  }
  for (const char* name :
       {"turntable", "turntable-spot", "slit"}) {  // lamps move in view of a camera at rest, and of a moving one
    const Scene& scene = scene_named(name);
    ASSERT_EQ(scene.cameras.size(), 2u) << name;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
      if (scene.nodes[i].camera == kNone) continue;
      EXPECT_EQ(moving_nodes(scene)[i], scene.nodes[i].camera == 1) << name;
    }
  }
}

/// Lamps with caustics that only chance finds cover at most 0.1 % of the ceiling (5.5 m squared).
TEST(BuiltinScenes, CausticLampsAreSmall) {
  for (const char* name : {"cornell-water", "cornell-glass"}) {
    const float area = testing::emissive_area(scene_named(name));
    EXPECT_GT(area, 0.0f);
    EXPECT_LE(area, 0.001f * sqr(5.5f));
  }
}

/// In a closed room every ray hits a front face: there are no gaps and no inverted walls.
TEST(BuiltinScenes, RoomsAreClosed) {
  for (const char* name : {"cornell-closed", "cornell-mirror", "corridor", "warehouse", "warehouse-rooms",
                           "warehouse-140", "warehouse-399", "slit", "door", "lamp-room"}) {
    const Scene& scene = scene_named(name);
    const Vec3 eye(world_matrices(scene, 0)[camera_node(scene)][3]);
    const int rays = 500;
    for (int i = 0; i < rays; ++i) {
      const Hit hit = trace(scene, eye, spread(i, rays));
      ASSERT_NE(hit.material, nullptr) << name << ", ray " << i;
      ASSERT_TRUE(hit.front) << name << ", ray " << i << " meets the back of " << hit.material->name;
    }
  }
}

/// The single lamp is hidden: no camera ray hits it.
TEST(BuiltinScenes, HiddenLampsAreHidden) {
  for (const char* name : {"corridor", "door"}) {
    const Scene& scene = scene_named(name);
    const std::vector<Mat4> world = world_matrices(scene, 0);
    const Vec3 eye(world[camera_node(scene)][3]);
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
      for (const Index m : scene.nodes[i].meshes) {
        const Mesh& mesh = scene.meshes[static_cast<size_t>(m)];
        if (is_black(scene.materials[static_cast<size_t>(mesh.material)].emission)) continue;
        for (int k = 0; k < 100; ++k) {
          const Vec2 uv(0.05f + 0.1f * static_cast<float>(k % 10), 0.05f + 0.1f * static_cast<float>(k / 10));
          const Vec3 p = mesh.positions[0] + uv.x * (mesh.positions[1] - mesh.positions[0]) +
                         uv.y * (mesh.positions[3] - mesh.positions[0]);
          const Hit hit = trace(scene, eye, glm::normalize(transform_point(world[i], p) - eye));
          ASSERT_NE(hit.material, nullptr);
          EXPECT_TRUE(is_black(hit.material->emission)) << name;
        }
      }
    }
  }
}

TEST(BuiltinScenes, FurnaceIsWhite) {
  const Scene& scene = scene_named("furnace");
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::constant);
  EXPECT_EQ(scene.environment.color, Rgb(1));
  EXPECT_EQ(scene.materials.at(0).base_color, Rgb(1));
  EXPECT_EQ(scene.materials.at(0).specular, 0);
}

}  // namespace
}  // namespace relume
