// Tests that every acceleration structure must pass.
#include "accel/accel_structure.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "core/hash.h"

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

  std::unique_ptr<AccelStructure> build(AccelChoice choice) {
    for (AccelMesh& mesh : meshes) mesh.needs_opacity = covers;
    const auto function = [](const void* context, uint32_t instance, uint32_t, float, float) {
      return instance == *static_cast<const uint32_t*>(context) ? 0.0f : 1.0f;
    };
    return make_accel(choice, meshes, instances, {function, &hole});
  }

  std::vector<Vec3> vertices;
  std::vector<uint32_t> indices;
  std::vector<AccelMesh> meshes;
  std::vector<AccelInstance> instances;
  bool covers = false;
  uint32_t hole = 0;  ///< the missing instance, if `covers`
};

/// The instance hit at each position of the row, by single rays and packets; -1: none.
std::vector<int> hits_along(const AccelStructure& accel, size_t count) {
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

class AccelStructures : public ::testing::TestWithParam<AccelChoice> {};
INSTANTIATE_TEST_SUITE_P(Accel, AccelStructures, ::testing::Values(AccelChoice::embree, AccelChoice::bvh),
                         [](const auto& choice) { return choice.param == AccelChoice::bvh ? "Bvh" : "Embree"; });

constexpr Row::Placement kWorld{};
constexpr Row::Placement kNode{.in_world_space = false};
constexpr Row::Placement kMoving{.in_world_space = false, .moves = true};

TEST_P(AccelStructures, FindsEveryMixtureOfInstances) {
  for (const std::vector<Row::Placement>& row : {std::vector{kWorld, kWorld, kWorld},
                                                 {kNode, kNode, kNode},
                                                 {kNode, kWorld, kNode},
                                                 {kWorld, kNode, kWorld},
                                                 {kMoving, kWorld, kNode},
                                                 {kNode, kWorld, kMoving}}) {
    Row scene(row);
    EXPECT_EQ(hits_along(*scene.build(GetParam()), 3), (std::vector{0, 1, 2}));
  }
}

TEST_P(AccelStructures, AsksForTheOpacityOfTheRightInstance) {
  for (const std::vector<Row::Placement>& row :
       {std::vector{kWorld, kWorld, kWorld}, {kNode, kWorld, kNode}, {kMoving, kWorld, kNode}}) {
    for (uint32_t hole = 0; hole < 3; ++hole) {
      Row scene(row);
      scene.covers = true;
      scene.hole = hole;
      std::vector<int> expected{0, 1, 2};
      expected[hole] = -1;
      EXPECT_EQ(hits_along(*scene.build(GetParam()), 3), expected);
    }
  }
}

TEST_P(AccelStructures, OpacityCanBeSwitched) {
  Row scene({kNode, kWorld, kNode});
  scene.hole = 1;
  const std::unique_ptr<AccelStructure> accel = scene.build(GetParam());
  EXPECT_EQ(hits_along(*accel, 3), (std::vector{0, 1, 2}));
  accel->set_filters(scene.instances[1].mesh, scene.instances, true, false);
  EXPECT_EQ(hits_along(*accel, 3), (std::vector{0, -1, 2}));
  accel->set_filters(scene.instances[1].mesh, scene.instances, false, false);
  EXPECT_EQ(hits_along(*accel, 3), (std::vector{0, 1, 2}));
}

/// Wavy squares of `edge`² cells over each other: shared edges, silhouettes, and faces that coincide.
struct Waves {
  explicit Waves(uint32_t edge) {
    for (uint32_t i = 0; i < (edge + 1) * (edge + 1); ++i) {
      const auto x = static_cast<float>(i % (edge + 1));
      const auto y = static_cast<float>(i / (edge + 1));
      vertices.emplace_back(x, y, 0.4f * std::sin(1.7f * x) * std::cos(1.1f * y));
    }
    for (uint32_t i = 0; i < edge * edge; ++i) {
      const uint32_t corner = i / edge * (edge + 1) + i % edge;
      for (const uint32_t offset : {0u, 1u, edge + 2, 0u, edge + 2, edge + 1}) indices.push_back(corner + offset);
    }
    const AccelMesh mesh{&vertices[0].x, sizeof(Vec3), vertices.size(), indices.data(), indices.size() / 3, false};
    meshes.assign(2, mesh);
    const Mat4 behind = glm::translate(Mat4(1), Vec3(0.25f, 0.5f, -1));
    instances = {{.mesh = 0}, {.mesh = 1}, {.mesh = 0, .to_world = behind, .in_world_space = false}};
  }

  std::vector<Vec3> vertices;
  std::vector<uint32_t> indices;
  std::vector<AccelMesh> meshes;
  std::vector<AccelInstance> instances;
};

/// Every eighth ray is aimed at a vertex, every third at the middle of an edge.
std::vector<Ray> rays_at(const Waves& waves, size_t count) {
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const auto n = static_cast<uint32_t>(i);
    const Vec3 eye(6 + 3 * to_unit_float(hash(n, 1u)), 5, 4 + to_unit_float(hash(n, 2u)));
    const size_t triangle = hash(n, 3u) % (waves.indices.size() / 3);
    const auto corner = [&](size_t k) { return waves.vertices[waves.indices[3 * triangle + k]]; };
    Vec3 target = corner(0) + (corner(1) - corner(0)) * to_unit_float(hash(n, 4u));
    if (i % 8 == 0) target = corner(2);
    if (i % 3 == 0) target = 0.5f * (corner(1) + corner(2));
    rays.push_back({.origin = eye, .direction = glm::normalize(target - eye)});
  }
  return rays;
}

TEST_P(AccelStructures, PacketsFindTheHitsOfSingleRays) {
  const Waves waves(12);
  const std::unique_ptr<AccelStructure> accel = make_accel(GetParam(), waves.meshes, waves.instances, {});
  const std::vector<Ray> rays = rays_at(waves, 32000);
  std::vector<uint32_t> ids(kPacketSize, 0);
  size_t hit_count = 0;
  // Packets of 16 rays, and of fewer.
  for (size_t first = 0, size = 1; first + size <= rays.size(); first += size, size = size % kPacketSize + 1) {
    Hit hits[2][kPacketSize];
    bool blocked[kPacketSize];
    const int count = static_cast<int>(size);
    intersect_packet(accel->view(), &rays[first], ids.data(), hits[0], count);
    intersect_packet_from_camera(accel->view(), &rays[first], ids.data(), hits[1], count);
    occluded_packet(accel->view(), &rays[first], ids.data(), blocked, count);
    for (size_t i = 0; i < size; ++i) {
      const Hit single = intersect(accel->view(), rays[first + i], 0);
      hit_count += single.valid();
      for (const auto& packet : hits) {
        ASSERT_EQ(packet[i].instance, single.instance) << first + i;
        ASSERT_EQ(packet[i].primitive, single.primitive) << first + i;
        ASSERT_EQ(packet[i].t, single.t) << first + i;
      }
      ASSERT_EQ(blocked[i], single.valid()) << first + i;
    }
  }
  EXPECT_GT(hit_count, rays.size() / 2);
}

TEST_P(AccelStructures, UpdatesMoveInstances) {
  Row scene({kMoving, kWorld, kNode});
  const std::unique_ptr<AccelStructure> accel = scene.build(GetParam());
  scene.instances[0].to_world = glm::translate(Mat4(1), Vec3(3 * kSpacing, 0, 0));
  accel->update(scene.instances, {});
  EXPECT_EQ(hits_along(*accel, 4), (std::vector{-1, 1, 2, 0}));
  scene.instances[0].visible = false;
  accel->update(scene.instances, {});
  EXPECT_EQ(hits_along(*accel, 4), (std::vector{-1, 1, 2, -1}));
}

}  // namespace
}  // namespace relume
