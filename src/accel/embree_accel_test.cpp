#include "accel/embree_accel.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr float kSpacing = 3;

/// Triangles of two meshes in a row along x. The first mesh is stored in its final position for instances in world
/// space; instance nodes place the second.
struct Row {
  struct Placement {
    bool in_world_space = true;
    bool moves = false;
  };

  explicit Row(const std::vector<Placement>& placements) {
    constexpr std::array<Vec3, 3> kTriangle{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)};
    vertices.assign(kTriangle.begin(), kTriangle.end());
    indices = {0, 1, 2};
    meshes.emplace_back();
    for (const Placement& placement : placements) {
      const Vec3 place(kSpacing * static_cast<float>(instances.size()), 0, 0);
      instances.push_back({.mesh = 0,
                           .to_world = glm::translate(Mat4(1), place),
                           .in_world_space = placement.in_world_space,
                           .moves = placement.moves});
      if (!placement.in_world_space) continue;
      instances.back().mesh = static_cast<uint32_t>(meshes.size());
      for (const Vec3& corner : kTriangle) {
        indices.push_back(static_cast<uint32_t>(vertices.size()));
        vertices.push_back(corner + place);
      }
      meshes.emplace_back();
    }
    for (size_t i = 0; i < meshes.size(); ++i)
      meshes[i] = {&vertices[0].x, sizeof(Vec3), vertices.size(), &indices[3 * i], 1, covers};
  }

  EmbreeAccel build() {
    for (AccelMesh& mesh : meshes) mesh.needs_opacity = covers;
    const auto function = [](const void* context, uint32_t instance, uint32_t, float, float) {
      return instance == *static_cast<const uint32_t*>(context) ? 0.0f : 1.0f;
    };
    return {meshes, instances, {function, &hole}};
  }

  std::vector<Vec3> vertices;
  std::vector<uint32_t> indices;
  std::vector<AccelMesh> meshes;
  std::vector<AccelInstance> instances;
  bool covers = false;
  uint32_t hole = 0;  ///< the missing instance, if `covers`
};

/// The instance hit at each position of the row, by single rays and packets; -1: none.
std::vector<int> hits_along(const EmbreeAccel& accel, size_t count) {
  std::vector<int> found;
  for (size_t i = 0; i < count; ++i) {
    const Ray ray{.origin = Vec3(kSpacing * static_cast<float>(i), 0, 5), .direction = Vec3(0, 0, -1)};
    const uint32_t id = 0;
    const Hit hit = intersect(accel.view(), ray, id);
    Hit in_packet;
    bool hidden = false;
    intersect_packet(accel.view(), &ray, &id, &in_packet, 1);
    occluded_packet(accel.view(), &ray, &id, &hidden, 1);
    EXPECT_EQ(in_packet.instance, hit.instance);
    EXPECT_EQ(hidden, hit.valid());
    EXPECT_EQ(occluded(accel.view(), ray, id), hit.valid());
    found.push_back(hit.valid() ? static_cast<int>(hit.instance) : -1);
  }
  return found;
}

constexpr Row::Placement kWorld{};
constexpr Row::Placement kNode{.in_world_space = false};
constexpr Row::Placement kMoving{.in_world_space = false, .moves = true};

TEST(EmbreeAccel, FindsEveryMixtureOfInstances) {
  for (const std::vector<Row::Placement>& row : {std::vector{kWorld, kWorld, kWorld},
                                                 {kNode, kNode, kNode},
                                                 {kNode, kWorld, kNode},
                                                 {kWorld, kNode, kWorld},
                                                 {kMoving, kWorld, kNode},
                                                 {kNode, kWorld, kMoving}}) {
    Row scene(row);
    EXPECT_EQ(hits_along(scene.build(), 3), (std::vector{0, 1, 2}));
  }
}

TEST(EmbreeAccel, AsksForTheOpacityOfTheRightInstance) {
  for (const std::vector<Row::Placement>& row :
       {std::vector{kWorld, kWorld, kWorld}, {kNode, kWorld, kNode}, {kMoving, kWorld, kNode}}) {
    for (uint32_t hole = 0; hole < 3; ++hole) {
      Row scene(row);
      scene.covers = true;
      scene.hole = hole;
      std::vector<int> expected{0, 1, 2};
      expected[hole] = -1;
      EXPECT_EQ(hits_along(scene.build(), 3), expected);
    }
  }
}

TEST(EmbreeAccel, OpacityCanBeSwitched) {
  Row scene({kNode, kWorld, kNode});
  scene.hole = 1;
  EmbreeAccel accel = scene.build();
  EXPECT_EQ(hits_along(accel, 3), (std::vector{0, 1, 2}));
  accel.set_filters(scene.instances[1].mesh, scene.instances, true, false);
  EXPECT_EQ(hits_along(accel, 3), (std::vector{0, -1, 2}));
  accel.set_filters(scene.instances[1].mesh, scene.instances, false, false);
  EXPECT_EQ(hits_along(accel, 3), (std::vector{0, 1, 2}));
}

TEST(EmbreeAccel, UpdatesMoveInstances) {
  Row scene({kMoving, kWorld, kNode});
  EmbreeAccel accel = scene.build();
  scene.instances[0].to_world = glm::translate(Mat4(1), Vec3(3 * kSpacing, 0, 0));
  accel.update(scene.instances);
  EXPECT_EQ(hits_along(accel, 4), (std::vector{-1, 1, 2, 0}));
}

}  // namespace
}  // namespace relume
