#include "techniques/reuse/restir_gi/reconnection.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"
#include "techniques/transport/path/testing/run_kernel.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::Random;

constexpr uint32_t kSize = 24;

struct Comparison {
  int samples = 0;
  int bound = 0;
  int movable = 0;
};

/// Expects that the sample of each pixel, added to the rest of its path, gives the whole path.
Comparison expect_whole_paths(const Scene& source) {
  const CompiledScene scene(source, {.camera = {}, .width = kSize, .height = kSize});
  const testing::TraceSettings settings{.width = kSize, .height = kSize, .max_bounces = 3, .russian_roulette = false};
  std::vector<Rgb> plain(kSize * kSize);
  std::vector<Rgb> rest(plain.size());
  std::vector<IndirectSample> samples(plain.size());
  testing::trace_pixels(scene, settings, RadianceOutput{mutable_view_of(plain)});
  testing::trace_pixels(scene, settings, RadianceOutput{mutable_view_of(rest)},
                        IndirectSampleOutput{mutable_view_of(samples)});
  const SceneView& view = scene.view();
  Comparison result;
  for (uint32_t i = 0; i < kSize * kSize; ++i) {
    const uint32_t x = i % kSize;
    const uint32_t y = i / kSize;
    Sampler sampler = SampleIndex{.seed = 7, .sample = 3}.sampler(x, y);  // as in trace_pixels()
    const Sampler of_path = sampler;
    const Ray ray = lone_camera_ray(view.camera, x, y, sampler);
    const Hit hit = intersect_from_camera(view.accel, ray, of_path.camera_ray_id());
    if (!hit.valid()) continue;
    Rgb whole = rest[i];
    if (const IndirectVertex& vertex = samples[i].vertex; samples[i].weight > 0.0f) {
      Receiver r;
      make_receiver(view, record_of(view, x, y, of_path, hit), r);
      const Reconnection c = reconnect(r.sp.position, place_of(view, vertex));
      whole += r.path.throughput * reflected_from(view, r, c, vertex.radiance) * (samples[i].weight / c.geometry());
      ++result.samples;
      result.bound += vertex.has(IndirectVertex::kBound) ? 1 : 0;
      result.movable += ReconnectionRule{}.moves(vertex) ? 1 : 0;
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(whole[c], plain[i][c], 2e-3f * (1.0f + plain[i][c])) << x << ' ' << y;
  }
  EXPECT_GT(result.samples, 250);
  return result;
}

TEST(IndirectSample, IsTheLightThatItsPathLacks) {
  const Comparison walls = expect_whole_paths(find_builtin_scene("cornell")->build());
  EXPECT_GT(walls.movable, walls.samples / 2);
  EXPECT_LT(walls.movable, walls.samples) << "glossy boxes";
  const Comparison spheres = expect_whole_paths(find_builtin_scene("cornell-spheres")->build());
  EXPECT_LT(spheres.movable, spheres.samples) << "mirror and glass";
}

/// Camera and box are in a medium, whose absorption along the first segment is part of samples.
TEST(IndirectSample, IsBoundToItsPixelByAMedium) {
  Scene scene = find_builtin_scene("cornell")->build();
  testing::add_mesh(scene, testing::tint({0.05f, 0.1f, 0.2f}), box(Vec3(-40), Vec3(40)));
  const Comparison result = expect_whole_paths(scene);
  EXPECT_EQ(result.bound, result.samples);
  EXPECT_EQ(result.movable, 0);
}

SurfacePlace random_place(Random& random) {
  const Vec3 position = random.point(1);
  return {position, random.direction(), 0.0f};
}

TEST(ReconnectionJacobian, IsTheRatioOfCosinesAndSquaredDistances) {
  Random random(3);
  int pairs = 0;
  for (int n = 0; n < 4000; ++n) {
    const SurfacePlace vertex = random_place(random);
    const Vec3 a = random.point(2);
    const Vec3 b = random.point(2);
    const float at_a = reconnect(a, vertex).geometry();
    const float at_b = reconnect(b, vertex).geometry();
    if (!(at_a > 0.0f && at_b > 0.0f)) continue;
    ++pairs;
    const Vec3 to_a = a - vertex.position;
    const Vec3 to_b = b - vertex.position;
    const float cosines =
        (glm::dot(to_b, vertex.front) / glm::length(to_b)) / (glm::dot(to_a, vertex.front) / glm::length(to_a));
    const float jacobian = cosines * glm::dot(to_a, to_a) / glm::dot(to_b, to_b);
    ASSERT_NEAR(at_b / at_a / jacobian, 1, 1e-3f);
    ASSERT_NEAR((at_b / at_a) * (at_a / at_b), 1, 1e-5f) << "there and back";
  }
  EXPECT_GT(pairs, 500);
}

TEST(ReconnectionNormal, TurnsWithItsSurface) {
  Random random(11);
  for (int n = 0; n < 200; ++n) {
    const Vec3 normal = random.direction();
    const Vec3 axis = random.direction();
    const Mat3 turn = glm::mat3_cast(glm::angleAxis(0.1f + 3 * random.next(), axis));
    IndirectVertex vertex;
    vertex.normal = pack_direction(normal);
    const uint32_t packed = vertex.normal;
    turn_normal(Mat3(1), vertex);
    EXPECT_EQ(vertex.normal, packed) << "at rest";
    turn_normal(2.0f * turn, vertex);
    EXPECT_LT(glm::length(unpack_direction(vertex.normal) - turn * normal), 3e-4f);
    turn_normal(glm::inverse(turn), vertex);
    EXPECT_LT(glm::length(unpack_direction(vertex.normal) - normal), 6e-4f);
    const uint32_t last = vertex.normal;
    turn_normal(Mat3(0), vertex);
    EXPECT_EQ(vertex.normal, last) << "flattened";
  }
}

TEST(ReconnectionRule, RefusesBothDirectionsOrNone) {
  Random random(5);
  const ReconnectionRule rule{.largest_jacobian = 4};
  int refused = 0;
  int accepted = 0;
  for (int n = 0; n < 4000; ++n) {
    const float a = std::exp(4 * random.next() - 2);
    const float b = std::exp(4 * random.next() - 2);
    EXPECT_EQ(rule.connects(a, b), rule.connects(b, a));
    (rule.connects(a, b) ? accepted : refused) += 1;
    EXPECT_FALSE(rule.connects(a, 0.0f));
    EXPECT_FALSE(rule.connects(0.0f, b));
  }
  EXPECT_GT(refused, 500);
  EXPECT_GT(accepted, 500);
  EXPECT_TRUE(rule.connects(1, 3.9f));
  EXPECT_FALSE(rule.connects(1, 4.1f));
}

TEST(ReconnectionRule, MovesLambertianVertices) {
  IndirectVertex vertex;
  vertex.alpha = 0.3f;
  const ReconnectionRule exact{.least_alpha = 0.2f};
  const ReconnectionRule glossy{.least_alpha = 0.2f, .reuses_glossy = true};
  EXPECT_FALSE(exact.moves(vertex));
  EXPECT_TRUE(glossy.moves(vertex));
  vertex.alpha = 0.1f;
  EXPECT_FALSE(glossy.moves(vertex));
  vertex.traits = IndirectVertex::kLambert;
  EXPECT_TRUE(exact.moves(vertex));
  vertex.traits |= IndirectVertex::kBound;
  EXPECT_FALSE(exact.moves(vertex));
  EXPECT_FALSE(glossy.moves(vertex));
}

/// The geometry terms of all points of a square add up to its solid angle.
TEST(Reconnection, IntegratesToTheSolidAngle) {
  constexpr int kCells = 256;
  const float half = 0.8f;
  const float height = 1.1f;
  double sum = 0;
  for (int i = 0; i < kCells * kCells; ++i) {
    const float x = (static_cast<float>(i % kCells) + 0.5f) / kCells * 2.0f - 1.0f;
    const float z = (static_cast<float>(i / kCells) + 0.5f) / kCells * 2.0f - 1.0f;
    const SurfacePlace vertex{{half * x, height, half * z}, {0, -1, 0}, 0.0f};
    sum += static_cast<double>(reconnect(Vec3(0), vertex).geometry() * 4.0f * half * half) / (kCells * kCells);
  }
  const double a = static_cast<double>(half * half);
  EXPECT_NEAR(sum, 4 * std::asin(a / (a + static_cast<double>(height * height))), 1e-3);
  EXPECT_EQ(reconnect(Vec3(0), {{0, 1, 0}, {0, 1, 0}, 0.0f}).geometry(), 0.0f) << "from behind";
  EXPECT_EQ(reconnect(Vec3(0), {Vec3(0), {0, 1, 0}, 0.0f}).geometry(), 0.0f) << "at the vertex";
}

}  // namespace
}  // namespace relume
