// A compiled scene with an open shutter: at every key, it equals the scene posed at that time.
#include <gtest/gtest.h>

#include <cmath>

#include "core/hash.h"
#include "scene/compiled_scene.h"
#include "scene/ray_queries.h"
#include "scene/surface_point.h"
#include "scene/testing/figure.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

using testing::animate_scale;
using testing::figure;
using testing::plate;

constexpr uint32_t kKeys = 9;
constexpr float kTurn_rad = 1.2f;

CompileOptions options_at(float time_s, AccelChoice accel, const Shutter& shutter = {}) {
  return {.time_s = time_s, .width = 16, .height = 16, .accel = accel, .shutter = shutter};
}

/// Open during the whole first second: a ray's time is then that of the animation.
CompiledScene open(const Scene& scene, AccelChoice accel) {
  return CompiledScene(scene, options_at(0.5f, accel, {.seconds = 1, .keys = kKeys}));
}

void animate_turn(Scene& scene, Index node, float angle_rad) {
  scene.animation.push_back({node,
                             AnimatedProperty::rotation,
                             Interpolation::linear,
                             {0, 1},
                             {Vec4(0, 0, 0, 1), Vec4(0, 0, std::sin(angle_rad / 2), std::cos(angle_rad / 2))}});
}

/// A plate that turns about the axis of view.
Scene turning_plate(const Material& material = {}) {
  Scene scene = plate(material);
  animate_turn(scene, 0, kTurn_rad);
  return scene;
}

Ray random_ray(uint32_t i, float time) {
  const Vec3 from(3 * to_unit_float(hash(i, 1u)) - 1.5f, 3 * to_unit_float(hash(i, 2u)) - 0.5f, 4);
  const Vec3 to(3 * to_unit_float(hash(i, 3u)) - 1.5f, 3 * to_unit_float(hash(i, 4u)) - 0.5f, 0);
  return {from, glm::normalize(to - from), kInfinity, time};
}

/// Compares hits and surface points of `opened` at the time of each key with those of a scene at rest at that time.
void expect_posed_at_keys(const Scene& scene, AccelChoice accel) {
  const CompiledScene opened = open(scene, accel);
  int hits = 0;
  for (uint32_t k = 0; k < kKeys; ++k) {
    const float time = static_cast<float>(k) / (kKeys - 1);
    const CompiledScene posed(scene, options_at(time, accel));
    int differing = 0;
    for (uint32_t i = 0; i < 500; ++i) {
      const Ray ray = random_ray(i, time);
      const Hit a = intersect(opened.view(), ray, i);
      const Hit b = intersect(posed.view(), ray, i);
      if (a.instance != b.instance || a.primitive != b.primitive) {
        ++differing;
        continue;
      }
      if (!a.valid()) continue;
      ++hits;
      SurfacePoint p;
      SurfacePoint q;
      make_surface_point(opened.view(), ray, a, 0, p);
      make_surface_point(posed.view(), ray, b, 0, q);
      EXPECT_EQ(p.time, time);
      EXPECT_LT(glm::length(p.position - q.position), 2e-6f);
      EXPECT_LT(glm::length(p.ng - q.ng), 1e-5f);
      EXPECT_LT(glm::length(p.ns - q.ns), 2e-4f);  // packed
      EXPECT_GE(p.position_error, q.position_error);
    }
    EXPECT_LE(differing, 2) << time;  // at edges
  }
  EXPECT_GT(hits, 500);
}

TEST(OpenShutter, InstancesAreAtTheirKeys) {
  for (const AccelChoice accel : {AccelChoice::embree, AccelChoice::bvh}) expect_posed_at_keys(turning_plate(), accel);
}

TEST(OpenShutter, SkinsAndMorphsAreAtTheirKeys) {
  for (const AccelChoice accel : {AccelChoice::embree, AccelChoice::bvh}) {
    expect_posed_at_keys(figure({.morphs = true}), accel);
    expect_posed_at_keys(figure({.morphs = true, .skinned = false}), accel);
  }
}

/// Between keys, points move along chords.
TEST(OpenShutter, TurnsShrinkByTheirSagitta) {
  const CompiledScene opened = open(turning_plate(), AccelChoice::bvh);
  const double bound = 1 - std::cos(static_cast<double>(kTurn_rad) / (kKeys - 1) / 2);
  double largest = 0;
  for (int i = 0; i <= 64; ++i) {
    const float time = static_cast<float>(i) / 64;
    SurfacePoint sp;
    make_surface_point(opened.view(), {Vec3(0), Vec3(0, 0, -1), kInfinity, time}, {0, 0, 1, 0, 0}, 0, sp);
    const double angle = static_cast<double>(kTurn_rad) * i / 64 - M_PI / 4;  // of the corner (1, -1)
    const Vec3 exact(std::sqrt(2.0) * std::cos(angle), std::sqrt(2.0) * std::sin(angle), 0);
    largest = std::max(largest, static_cast<double>(glm::length(sp.position - exact)) / std::sqrt(2.0));
  }
  EXPECT_LT(largest, 1.01 * bound + 1e-6);
  EXPECT_GT(largest, 0.5 * bound);
}

TEST(OpenShutter, NothingMovesWhileItIsClosed) {
  CompiledScene compiled = open(turning_plate(), AccelChoice::bvh);
  EXPECT_EQ(compiled.view().motion.count, kKeys);
  EXPECT_NE(compiled.set_shutter({}), Change::none);
  EXPECT_TRUE(compiled.view().motion.empty());
  EXPECT_FALSE(compiled.view().camera.shutter_open);
  EXPECT_EQ(compiled.view().instances[0].first_key, kNoKeys);
  EXPECT_EQ(compiled.view().accel.bvh.key_count, 0u);
  const CompiledScene rest(turning_plate(), options_at(0.5f, AccelChoice::bvh));
  for (uint32_t i = 0; i < 500; ++i) {
    const Ray ray = random_ray(i, to_unit_float(hash(i, 5u)));
    ASSERT_EQ(intersect(compiled.view(), ray, i).t, intersect(rest.view(), ray, i).t);
  }
}

TEST(OpenShutter, CamerasAreAtTheirKeys) {
  Scene scene = plate();
  animate_turn(scene, 1, kTurn_rad);
  scene.animation.push_back(
      {1, AnimatedProperty::translation, Interpolation::linear, {0, 1}, {Vec4(0, 0, 3, 0), Vec4(1, 0, 2, 0)}});
  CompiledScene opened = open(scene, AccelChoice::embree);
  ASSERT_EQ(opened.view().camera.keys.size, kKeys);
  for (uint32_t k = 0; k < kKeys; ++k) {
    const float time = static_cast<float>(k) / (kKeys - 1);
    const CameraView expected = CompiledScene(scene, options_at(time, AccelChoice::embree)).view().camera;
    const CameraView camera = camera_at(opened.view().camera, time);
    EXPECT_LT(glm::length(camera.position - expected.position), 1e-6f);
    EXPECT_LT(glm::length(camera.axes.n - expected.axes.n), 1e-6f);
    EXPECT_LT(glm::length(camera.axes.t - expected.axes.t), 1e-6f);
    EXPECT_LT(glm::length(camera.axes.b - expected.axes.b), 1e-6f);
  }
  opened.set_camera(opened.camera());
  EXPECT_TRUE(opened.view().camera.keys.empty());  // a caller's camera rests
  opened.set_camera(std::nullopt);
  EXPECT_EQ(opened.view().camera.keys.size, kKeys);
}

TEST(OpenShutter, SamplesOfMovingLightsAreOnTheirSurfaces) {
  Material material;
  material.emission = Rgb(3);
  for (const bool deforms : {false, true}) {
    Scene scene = deforms ? figure({.rings = 4, .segments = 3, .morphs = true}) : turning_plate(material);
    scene.materials[0].emission = Rgb(3);
    scene.materials[0].double_sided = true;
    const CompiledScene opened = open(scene, AccelChoice::bvh);
    const LightsView& lights = opened.view().lights;
    ASSERT_FALSE(lights.first_keys.empty());
    int valid = 0;
    for (uint32_t i = 0; i < 600; ++i) {
      const float time = to_unit_float(hash(i, 1u));
      const Vec3 p(2 * to_unit_float(hash(i, 2u)) - 1, 0.5f, 1.5f);
      const LightId id = hash(i, 3u) % lights.first_infinite;
      const Vec2 u(to_unit_float(hash(i, 4u)), to_unit_float(hash(i, 5u)));
      const LightSample s = sample_li(lights, id, p, u, time);
      if (!s.valid()) continue;
      const Hit hit = intersect(opened.view(), {p, s.wi, kInfinity, time}, i);
      ASSERT_TRUE(hit.valid());
      EXPECT_LE(hit.t, s.distance * 1.0001f);
      SurfacePoint sp;
      make_surface_point(opened.view(), {p, s.wi, kInfinity, time}, hit, 0, sp);
      if (sp.light != id) continue;  // another part of the mesh is in front
      ++valid;
      EXPECT_LT(glm::length(sp.position - s.position), 1e-4f);
      EXPECT_NEAR(pdf_li(lights, id, p, s.wi, sp.emitter_point()) / s.pdf_w, 1, 1e-3);
      EXPECT_NEAR(pdf_le(lights, id, sp.emitter_point(), -s.wi).pdf_a * moved_light(lights, id, time).area, 1, 1e-4);
    }
    EXPECT_GT(valid, 100);
  }
}

TEST(OpenShutter, WhatCannotBeInterpolatedRests) {
  Scene scene = plate();
  animate_scale(scene, 0, Vec3(1), Vec3(-1, 1, 1));
  const CompiledScene opened = open(scene, AccelChoice::embree);
  EXPECT_EQ(opened.view().instances[0].first_key, kNoKeys);
  EXPECT_TRUE(opened.view().motion.empty());
}

/// A surface that moves evenly comes from where it was at the same time of the previous frame's shutter.
TEST(OpenShutter, PreviousPositionsAreThoseOfTheSameInstant) {
  Scene scene = plate();
  scene.animation.push_back(
      {0, AnimatedProperty::translation, Interpolation::linear, {0, 4}, {Vec4(0), Vec4(4, 0, 0, 0)}});
  CompiledScene compiled(scene, options_at(1, AccelChoice::bvh, {.seconds = 0.5f, .keys = 3}));
  compiled.end_frame();
  compiled.set_time(1.75f);
  for (const float time : {0.0f, 0.3f, 0.5f, 0.9f}) {
    SurfacePoint sp;
    make_surface_point(compiled.view(), {Vec3(0), Vec3(0, 0, -1), kInfinity, time}, {0, 0, 0.2f, 0.3f, 0}, 0, sp);
    EXPECT_NEAR(sp.position.x - sp.previous_position.x, 0.75f, 1e-5f);
    EXPECT_NEAR(sp.position.x, 1.5f + 0.5f * time + (-1 + 2 * 0.2f + 2 * 0.3f), 1e-5f);
  }
}

}  // namespace
}  // namespace relume
