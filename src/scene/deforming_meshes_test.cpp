#include "scene/deforming_meshes.h"

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/surface_point.h"
#include "scene/testing/expected_figure.h"
#include "testing/failing_memory.h"

namespace relume {
namespace {

using testing::expected_vertex;
using testing::ExpectedVertex;
using testing::figure;
using testing::FigureOptions;
using testing::stopped_figure;

CompileOptions small() { return {.width = 16, .height = 16}; }

class Deformed : public ::testing::TestWithParam<FigureOptions> {};

void expect_vertices(const FigureOptions& o, const Scene& scene, double rounding) {
  CompiledScene compiled(scene, small());
  for (const float time_s : {0.0f, 0.3f, 1.0f, 0.6f}) {
    compiled.set_time(time_s);
    const SceneView& view = compiled.view();
    double position = 0;
    double normal = 0;
    double tangent = 0;
    Box box;
    for (uint32_t v = 0; v < scene.meshes[0].positions.size(); ++v) {
      const ExpectedVertex e = expected_vertex(o, scene, v, static_cast<double>(time_s));
      position = std::max(position, glm::length(glm::dvec3(view.vertices[v].position) - e.position));
      normal = std::max(normal, glm::length(glm::dvec3(glm::normalize(view.vertices[v].normal.unpack())) - e.normal));
      tangent = std::max(tangent, glm::length(glm::dvec3(unpack_direction(view.vertices[v].tangent)) - e.tangent));
      box.add(view.vertices[v].position);
    }
    EXPECT_LE(position, 1e-5 * glm::length(glm::dvec3(box.extent())) + rounding) << time_s;
    EXPECT_LE(normal, 1e-4) << time_s;  // 16 bits per component
    EXPECT_LE(tangent, 2e-4) << time_s;
  }
}

TEST_P(Deformed, VerticesMatchDoublePrecision) { expect_vertices(GetParam(), figure(GetParam()), 0); }

TEST_P(Deformed, ScalesAndDistancesToo) {
  if (!GetParam().skinned) return;
  Scene scene = figure(GetParam());
  scene.nodes[2].transform.scale = Vec3(2, 0.5f, 1);  // scale of a middle joint
  scene.nodes[1].transform.translation = Vec3(300, -20, 7);
  expect_vertices(GetParam(), scene, 5e-5);  // floats at 300 m round by 1.5e-5, three times in the sum of a skin
}

TEST_P(Deformed, NormalsArePerpendicularToTheSurface) {
  FigureOptions options = GetParam();
  options.swing_rad = 0;  // blended normals are inexact where weights vary
  Scene scene = figure(options);
  if (options.skinned) scene.nodes[1].transform.scale = Vec3(3, 1, 1);  // normals and surface turn differently
  CompiledScene compiled(scene, small());
  compiled.set_time(0.8f);
  const SceneView& view = compiled.view();
  double sum = 0;
  for (const UVec3& t : view.triangles) {
    const Vec3 p0 = view.vertices[t.x].position;
    const Vec3 face = glm::normalize(glm::cross(view.vertices[t.y].position - p0, view.vertices[t.z].position - p0));
    const Vec3 mean = glm::normalize(view.vertices[t.x].normal.unpack() + view.vertices[t.y].normal.unpack() +
                                     view.vertices[t.z].normal.unpack());
    EXPECT_GT(glm::dot(face, mean), 0.85f);
    sum += glm::dot(face, mean);
  }
  EXPECT_GT(sum / view.triangles.size, 0.985);
}

TEST_P(Deformed, KeepsPreviousPositions) {
  CompiledScene compiled(figure(GetParam()), small());
  compiled.set_time(0.5f);
  compiled.end_frame();
  const Hit hit{0, 17, 0.3f, 0.2f, 1.0f};
  const SurfacePosition at_half = surface_position(compiled.view(), hit);
  EXPECT_EQ(at_half.now, at_half.before);
  EXPECT_NE(compiled.set_time(1) & Change::geometry, Change::none);
  const SurfacePosition at_end = surface_position(compiled.view(), hit);
  EXPECT_EQ(at_end.before, at_half.now);
  EXPECT_NE(at_end.now, at_half.now);
  compiled.end_frame();
  EXPECT_EQ(surface_position(compiled.view(), hit).before, at_end.now);
  EXPECT_EQ(compiled.set_time(1), Change::none);
}

TEST_P(Deformed, BoundsHoldAtEveryTime) {
  const Scene scene = figure(GetParam());
  CompiledScene compiled(scene, small());
  const SceneBounds bounds = compiled.bounds();
  for (float time_s = 0; time_s <= 1; time_s += 0.05f) {
    compiled.set_time(time_s);
    for (const Vertex& v : compiled.view().vertices) EXPECT_LE(glm::length(v.position - bounds.center), bounds.radius);
  }
}

TEST_P(Deformed, RaysHitTheDeformedSurface) {
  CompiledScene compiled(figure(GetParam()), small());
  for (const float time_s : {0.9f, 0.2f}) {
    compiled.set_time(time_s);
    const SceneView& view = compiled.view();
    for (uint32_t t = 0; t < view.triangles.size; t += 7) {
      const SurfacePosition p = surface_position(view, {0, t, 0.3f, 0.3f, 0});
      const UVec3 index = view.triangles[t];
      const Vec3 p0 = view.vertices[index.x].position;
      const Vec3 n =
          glm::normalize(glm::cross(view.vertices[index.y].position - p0, view.vertices[index.z].position - p0));
      const Hit hit = intersect(view.accel, {p.now + 1e-3f * n, -n, 2e-3f}, 0);
      ASSERT_TRUE(hit.valid()) << t;
      EXPECT_EQ(hit.primitive, t);
      EXPECT_NEAR(hit.t, 1e-3f, 1e-5f);
    }
  }
}

TEST_P(Deformed, DirectionsTurnWithTheSurface) {
  CompiledScene compiled(figure(GetParam()), small());
  const Hit hit{0, 200, 0.3f, 0.3f, 0};
  const auto normal = [&] {
    const UVec3 t = compiled.view().triangles[hit.primitive];
    const View<const Vertex> v = compiled.view().vertices;
    return glm::normalize(glm::cross(v[t.y].position - v[t.x].position, v[t.z].position - v[t.x].position));
  };
  EXPECT_EQ(previous_to_current(compiled.view(), hit), Mat3(1));
  const Vec3 before = normal();
  compiled.set_time(0.7f);
  EXPECT_LT(glm::length(previous_to_current(compiled.view(), hit) * before - normal()), 1e-5f);
}

INSTANTIATE_TEST_SUITE_P(Figures, Deformed,
                         ::testing::Values(FigureOptions{}, FigureOptions{.morphs = true},
                                           FigureOptions{.morphs = true, .skinned = false}),
                         [](const auto& tested) {
                           return std::string(tested.param.skinned ? "skinned" : "") +
                                  (tested.param.morphs ? "morphed" : "");
                         });

TEST(DeformingMeshes, PosesCountAsChangedAfterAnUpdateThatFailed) {
  Scene scene = figure({.parts = 2});
  const auto count = static_cast<uint32_t>(scene.meshes[0].positions.size());
  const JointMatrices joints = joint_matrices(scene, world_matrices(scene, 1));
  testing::FailingMemory memory;
  DeformingMeshes meshes(memory);
  meshes.add(scene, {0, 0, 0, 0, count});
  meshes.add(scene, {0, 1, 1, count, count});
  Array<Vertex> vertices;
  vertices.reset(2 * size_t{count});
  const auto update = [&] {
    return meshes.update(scene, joints, 1, vertices.mutable_view(), host_scene_launcher(Denormals::keep));
  };
  memory.fail_after(1);  // the joints of the second mesh
  EXPECT_THROW(update(), std::bad_alloc);
  EXPECT_EQ(update(), (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(vertices.read()[count - 1].position, vertices.read()[2 * size_t{count} - 1].position);
  EXPECT_TRUE(update().empty());
}

TEST_P(Deformed, StillFiguresAreOrdinaryMeshes) {
  const Scene scene = stopped_figure(GetParam());
  const CompiledScene compiled(scene, small());
  EXPECT_FALSE(compiled.view().meshes[0].deforms);
  EXPECT_TRUE(compiled.view().instances[0].in_world_space);
  EXPECT_EQ(compiled.view().previous_positions.size, 0u);
  for (uint32_t v = 0; v < scene.meshes[0].positions.size(); ++v) {
    const ExpectedVertex e = expected_vertex(GetParam(), scene, v, 0.5);
    EXPECT_LT(glm::length(glm::dvec3(compiled.view().vertices[v].position) - e.position), 2e-5);
  }
  CompileOptions movable = small();
  movable.movable = {GetParam().skinned ? 1 : 0};
  EXPECT_EQ(CompiledScene(scene, movable).view().meshes[0].deforms, GetParam().skinned);
}

}  // namespace
}  // namespace relume
