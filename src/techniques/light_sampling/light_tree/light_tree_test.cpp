#include "techniques/light_sampling/light_tree/light_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "testing/random.h"

namespace relume {
namespace {

SurfacePoint point_at(const Vec3& position, const Vec3& normal) {
  SurfacePoint sp{};
  sp.position = position;
  sp.frame = make_frame(glm::normalize(normal));
  return sp;
}

TEST(LightTree, HoldsEveryEmitterOnce) {
  const CompiledScene scene(find_builtin_scene("warehouse")->build(), {});
  const LightsView& lights = scene.view().lights;
  const LightTreeData data = build_light_tree(lights);
  std::vector<LightId> held = data.lights;
  std::sort(held.begin(), held.end());
  std::vector<LightId> expected;
  for (LightId i = 0; i < lights.first_infinite; ++i) {
    if (luminance(power(lights, i)) > 0) expected.push_back(i);
  }
  ASSERT_GT(expected.size(), 250u);
  EXPECT_EQ(held, expected);
  for (const LightTreeNode& n : data.nodes) {
    for (uint32_t c = 0; c < kLightTreeWidth; ++c) {
      EXPECT_LE(n.lights[c], kLightTreeLeafSize);
      EXPECT_EQ(n.intensity[c] > 0, n.lights[c] > 0 || n.child[c] > 0);
    }
  }
  EXPECT_LT(data.nodes.size(), expected.size() / 4);  // wide nodes are mostly full
}

TEST(LightTree, BoundsArePositiveWhereLightsShine) {
  // The bound of a group is positive wherever one of its lights shines.
  const CompiledScene scene(find_builtin_scene("warehouse")->build(), {});
  const LightsView& lights = scene.view().lights;
  const LightTreeData data = build_light_tree(lights);
  testing::Random random(3);
  int shining = 0;
  for (int i = 0; i < 3000; ++i) {
    const light_tree::Point p{scene.bounds().center + random.point(20), random.direction(), 0};
    const LightId id = static_cast<LightId>(random.next() * static_cast<float>(lights.first_infinite));
    const LightSample s = sample_li(lights, id, p.position, random.next_2d());
    if (!s.valid() || glm::dot(s.wi, p.normal) <= 1e-3f) continue;
    ++shining;
    EXPECT_GT(light_tree::importance(p, bounds_of(lights, id)), 0.0f);
    for (uint32_t at = data.place[id]; at != light_tree::kNoParent; at = data.nodes[at / 8].parent) {
      float weights[kLightTreeWidth];
      light_tree::child_weights(p, data.nodes[at / 8], weights);
      EXPECT_GT(weights[at % 8], 0.0f);
    }
  }
  EXPECT_GT(shining, 200);
}

TEST(LightTree, BoundsPointAndSpotLights) {
  const testing::LightScene scene = testing::make_light_scene({});
  testing::Random random(4);
  for (const LightId id : {4u, 5u}) {
    int lit = 0;
    for (int i = 0; i < 2000; ++i) {
      const light_tree::Point p{random.point(2), random.direction(), 0};
      const LightSample s = sample_li(scene.lights(), id, p.position, {0.5f, 0.5f});
      if (!s.valid() || glm::dot(s.wi, p.normal) <= 1e-3f) continue;
      ++lit;
      EXPECT_GT(light_tree::importance(p, bounds_of(scene.lights(), id)), 0.0f);
    }
    EXPECT_GT(lit, 50);
  }
}

/// Builds the tree over `lights` and sets `view` to them.
LightTreeData tree_of(const std::vector<Light>& lights, LightsView& view) {
  view.lights = view_of(lights);
  view.first_infinite = view.lights.size;
  return build_light_tree(view);
}

/// A lamp that turns in its plane by a large angle, and tilts. Between two poses, its normal leaves their plane.
TEST(LightTree, BoundsHoldTheNormalsOfAMovingLampAtAllTimes) {
  constexpr float kTurn_rad = 2.1f;
  constexpr float kTilt_rad = 0.3f;
  std::vector<LightKey> keys;
  for (const float k : {0.0f, 1.0f, 2.0f}) {
    const auto tilted = [&](float x, float y) {
      return Vec3(x, y * std::cos(kTilt_rad * k), y * std::sin(kTilt_rad * k));
    };
    const float c = std::cos(kTurn_rad * k);
    const float s = std::sin(kTurn_rad * k);
    keys.push_back({Vec3(0), tilted(c, s), tilted(-s, c)});
  }
  std::vector<Light> lights = {Light::of(TriangleLight{})};
  lights[0].triangle.radiance = Rgb(1);
  lights[0].triangle.textured = -1;
  set_corners(lights[0].triangle, keys[1], 1);
  const std::vector<uint32_t> first_keys = {0};
  LightsView view;
  view.lights = view_of(lights);
  view.first_infinite = 1;
  view.keys = view_of(keys);
  view.first_keys = view_of(first_keys);
  view.key_count = 3;
  const LightBounds bounds = bounds_of(view, 0);
  float least = 1;
  for (int i = 0; i <= 200; ++i) {
    const Vec3 normal = moved_light(view, 0, static_cast<float>(i) / 200).normal;
    EXPECT_GE(glm::dot(normal, bounds.axis), bounds.cos_o - 1e-5f) << i;
    least = std::min(least, glm::dot(normal, lights[0].triangle.normal));
  }
  EXPECT_LT(least, std::cos(1.1f * kTilt_rad));  // the cone around the poses alone is too narrow
}

TEST(LightTree, SpotsWithoutASoftEdgeShine) {
  std::vector<Light> spots(2);
  for (Light& light : spots) light.kind = LightKind::spot;
  const float cos_cone = std::cos(0.4f);
  spots[0].spot = {Vec3(0, 2, 0), Vec3(0, -1, 0), Rgb(1), cos_cone, cos_cone};
  spots[1].spot = {Vec3(0.3f, 2, 0), glm::normalize(Vec3(0.2f, -1, 0.1f)), Rgb(3), cos_cone, cos_cone};
  LightsView view;
  const LightTreeData data = tree_of(spots, view);
  const LightTree tree = data.view(view);
  testing::Random random(5);
  int lit = 0;
  for (int i = 0; i < 5000; ++i) {
    const SurfacePoint sp = point_at(Vec3(0.1f, 1, 0) + random.point(1), Vec3(0, 1, 0));
    for (const LightId id : {0u, 1u}) {
      const LightSample s = sample_li(view, id, sp.position, {0.5f, 0.5f});
      if (!s.valid() || s.wi.y <= 1e-3f) continue;
      ++lit;
      EXPECT_GT(tree.pmf(sp, id), 0.0f);
    }
  }
  EXPECT_GT(lit, 200);
}

TEST(LightTree, FacesOfOneWallShineOneWay) {
  // Rounding of the angle between equal normals must not widen the cone to behind the wall.
  std::vector<Light> faces(64);
  const Vec3 normal = glm::normalize(Vec3(0.3f, 0.5f, 0.8f));
  const Frame wall = make_frame(normal);
  for (size_t i = 0; i < faces.size(); ++i) {
    faces[i].kind = LightKind::triangle;
    TriangleLight& t = faces[i].triangle;
    t = {};
    t.v0 = wall.to_world({static_cast<float>(i % 8), static_cast<float>(i / 8), 0});
    t.e1 = wall.to_world({1, 0, 0});
    t.e2 = wall.to_world({0, 1, 0});
    t.normal = normal;
    t.area = 0.5f;
    t.radiance = Rgb(1);
    t.textured = -1;
  }
  LightsView view;
  const LightTreeData data = tree_of(faces, view);
  for (const LightTreeNode& node : data.nodes) {
    for (uint32_t c = 0; c < kLightTreeWidth; ++c) {
      if (node.intensity[c] > 0) {
        EXPECT_GT(node.cos_o[c], 0.99999f);
      }
    }
  }
}

TEST(LightTree, UsesIntensityIfBoundsOverflow) {
  std::vector<Light> points(9);
  for (Light& light : points) {
    light.kind = LightKind::point;
    light.point = {Vec3(0), Rgb(1e29f)};
  }
  LightsView view;
  const LightTreeData data = tree_of(points, view);
  const LightTree tree = data.view(view);
  const SurfacePoint sp = point_at(Vec3(0, 1e-8f, 0), Vec3(0, -1, 0));
  float sum = 0;
  for (LightId i = 0; i < points.size(); ++i) sum += tree.pmf(sp, i);
  EXPECT_NEAR(sum, 1.0f, 1e-5f);
  EXPECT_GT(tree.sample(sp, {0.5f, 1}).pmf, 0.0f);
}

TEST(LightTree, PrefersTheNearLampThatFacesThePoint) {
  Scene scene;
  Material lamp;
  lamp.emission = Rgb(10);
  scene.materials.push_back(lamp);
  for (int i = 0; i < 16; ++i) {
    Mesh m;
    const auto x = static_cast<float>(4 * i);
    m.positions = {Vec3(x, 2, 0), Vec3(x + 0.2f, 2, 0), Vec3(x, 2, 0.2f)};
    m.triangles = {i == 3 ? UVec3(0, 2, 1) : UVec3(0, 1, 2)};  // the fourth faces up
    m.material = 0;
    scene.meshes.push_back(m);
    Node node;
    node.meshes = {i};
    scene.add_node(node);
  }
  const CompiledScene compiled(std::move(scene), {});
  const LightsView& lights = compiled.view().lights;
  const LightTreeData data = build_light_tree(lights);
  const LightTree tree = data.view(lights);
  const SurfacePoint sp = point_at(Vec3(12.1f, 0, 0.1f), Vec3(0, 1, 0));
  EXPECT_EQ(tree.pmf(sp, 3), 0.0f);  // faces away
  EXPECT_GT(tree.pmf(sp, 2), 4 * tree.pmf(sp, 8));
  const SurfacePoint below = point_at(Vec3(24.1f, 0, 0.1f), Vec3(0, 1, 0));
  // Directly below one lamp: neighbours 4 m off are 4.5 m away at 63°. cos² / d² gives each 1/25 of its weight.
  EXPECT_GT(tree.pmf(below, 6), 0.5f);
}

/// Lamps of all strengths a few metres above the plane y = 0: triangles that face down or sideways, points and spots.
std::vector<Light> lamps_over_a_floor(int count) {
  testing::Random random(6);
  std::vector<Light> lamps(static_cast<size_t>(count));
  for (size_t i = 0; i < lamps.size(); ++i) {
    const Vec3 at(16 * random.next(), 0.5f + 2.5f * random.next(), 16 * random.next());
    const Rgb strength(std::exp2(8 * random.next()));
    if (i % 4 == 0) {
      lamps[i].kind = LightKind::point;
      lamps[i].point = {at, strength};
    } else if (i % 4 == 1) {
      lamps[i].kind = LightKind::spot;
      lamps[i].spot = {at, glm::normalize(Vec3(random.next() - 0.5f, -1, 0)), strength, std::cos(0.5f), std::cos(0.9f)};
    } else {
      const Frame frame = make_frame(glm::normalize(Vec3(random.next() - 0.5f, i % 4 == 2 ? -1.0f : -0.1f, 0.3f)));
      lamps[i].kind = LightKind::triangle;
      TriangleLight& t = lamps[i].triangle = {};
      t.v0 = at;
      t.e1 = frame.to_world({0.2f, 0, 0});
      t.e2 = frame.to_world({0, 0.2f, 0});
      t.normal = frame.n;
      t.area = 0.02f;
      t.radiance = 25.0f * strength;
      t.textured = -1;
    }
  }
  return lamps;
}

/// Expected squared error of one sample, relative to the received light, summed over points of the floor.
TEST(LightTree, HasLessVarianceThanPowerWhereNothingIsHidden) {
  const std::vector<Light> lamps = lamps_over_a_floor(64);
  LightsView view;
  const LightTreeData data = tree_of(lamps, view);
  const LightTree tree = data.view(view);
  double all_power = 0;
  for (LightId i = 0; i < lamps.size(); ++i) all_power += static_cast<double>(luminance(power(view, i)));
  testing::Random random(7);
  double of_tree = 0;
  double of_power = 0;
  for (int point = 0; point < 200; ++point) {
    const SurfacePoint sp = point_at(Vec3(16 * random.next(), 0, 16 * random.next()), Vec3(0, 1, 0));
    double sum = 0;
    double tree_moment = 0;
    double power_moment = 0;
    for (LightId i = 0; i < lamps.size(); ++i) {
      const LightSample s = sample_li(view, i, sp.position, Vec2(0.5f));
      if (!s.valid() || s.wi.y <= 0) continue;
      const double sent = static_cast<double>(luminance(s.radiance) * s.wi.y / s.pdf_w);
      const auto pmf = static_cast<double>(tree.pmf(sp, i));
      ASSERT_GT(pmf, 0) << i;
      sum += sent;
      tree_moment += sent * sent / pmf;
      power_moment += sent * sent * all_power / static_cast<double>(luminance(power(view, i)));
    }
    ASSERT_GT(sum, 0);
    of_tree += tree_moment / (sum * sum) - 1;
    of_power += power_moment / (sum * sum) - 1;
  }
  EXPECT_LT(of_tree, 0.1 * of_power);  // measured: 0.069
}

TEST(LightTree, EmptySceneHasNoLight) {
  const LightTree none = build_light_tree(LightsView{}).view(LightsView{});
  EXPECT_EQ(none.sample(SurfacePoint{}, {0.3f, 1}).pmf, 0.0f);
  EXPECT_EQ(none.pmf(SurfacePoint{}, 0), 0.0f);
}

TEST(LightTree, SeparatesCoincidentLights) {
  // No plane separates equal centres, yet leaves hold at most two lights.
  std::vector<Light> same(37);
  for (Light& light : same) {
    light.kind = LightKind::point;
    light.point = {Vec3(1, 2, 3), Rgb(1)};
  }
  LightsView view;
  view.lights = view_of(same);
  view.first_infinite = view.lights.size;
  const LightTreeData data = build_light_tree(view);
  const LightTree tree = data.view(view);
  for (LightId i = 0; i < same.size(); ++i)
    EXPECT_NEAR(tree.pmf(point_at(Vec3(0), Vec3(0, 1, 0)), i), 1.0f / 37, 0.01f);
}

}  // namespace
}  // namespace relume
