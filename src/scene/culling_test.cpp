// Faces culled for the camera.
#include <utility>

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/testing/figure.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

Material culled() {
  Material material;
  material.cull_back_faces = true;
  return material;
}

const Ray kFromFront{{0.1f, 0.2f, 3}, {0, 0, -1}, kInfinity};
const Ray kFromBehind{{0.1f, 0.2f, -3}, {0, 0, 1}, kInfinity};

Hit in_packet(const AccelView& accel, const Ray& ray) {
  const uint32_t id = 1;
  Hit hit;
  intersect_packet_from_camera(accel, &ray, &id, &hit, 1);
  return hit;
}

/// The front of the plate faces +Z.
void expect_culled(const Scene& scene, const CompileOptions& options) {
  const CompiledScene compiled(scene, options);
  const AccelView& accel = compiled.view().accel;
  EXPECT_TRUE(compiled.view().culls_back_faces);
  EXPECT_TRUE(intersect_from_camera(accel, kFromFront, 1).valid());
  EXPECT_TRUE(in_packet(accel, kFromFront).valid());
  EXPECT_FALSE(intersect_from_camera(accel, kFromBehind, 1).valid());
  EXPECT_FALSE(in_packet(accel, kFromBehind).valid());
  // Rays towards the camera, which is at their end.
  EXPECT_FALSE(occluded_to_camera(accel, kFromFront, 1));
  EXPECT_TRUE(occluded_to_camera(accel, kFromBehind, 1));
  for (const Ray& ray : {kFromFront, kFromBehind}) {
    EXPECT_TRUE(intersect(accel, ray, 1).valid());
    EXPECT_TRUE(occluded(accel, ray, 1));
  }
}

TEST(Culling, HidesBackFacesFromTheCameraOnly) {
  const Scene scene = testing::plate(culled());
  for (const AccelChoice accel : {AccelChoice::embree, AccelChoice::bvh}) {
    expect_culled(scene, {.camera = {}, .movable = {}, .accel = accel});
    expect_culled(scene, {.camera = {}, .movable = {0}, .accel = accel});
  }
}

TEST(Culling, KeepsFrontFacesOfMirroredInstances) {
  Scene scene = testing::plate(culled());
  scene.nodes[0].transform.scale = Vec3(-1, 1, 1);
  for (const AccelChoice accel : {AccelChoice::embree, AccelChoice::bvh}) {
    expect_culled(scene, {.camera = {}, .movable = {}, .accel = accel});
    expect_culled(scene, {.camera = {}, .movable = {0}, .accel = accel});
  }
}

/// From outside, a closed tube shows its near side; from inside, it is invisible. Mirroring joints make no difference.
TEST(Culling, KeepsFrontFacesOfSkins) {
  const Ray from_outside{{0.03f, 1.1f, 3}, {0, 0, -1}, kInfinity};
  const Ray from_within{{0.03f, 1.1f, 0}, {0, 0, -1}, kInfinity};
  for (const auto& [choice, moves] : {std::pair(AccelChoice::embree, false),
                                      {AccelChoice::embree, true},
                                      {AccelChoice::bvh, false},
                                      {AccelChoice::bvh, true}}) {
    for (const float mirror : {1.0f, -1.0f}) {
      Scene scene = testing::figure({.swing_rad = 0});
      scene.materials[0] = culled();
      if (!moves) scene.animation.clear();
      scene.nodes[static_cast<size_t>(scene.skins[0].joints[0])].transform.scale.x = mirror;
      CompiledScene compiled(scene, {.accel = choice});
      for (const float time_s : {0.0f, 0.5f}) {
        if (moves) compiled.set_time(time_s);
        const AccelView& accel = compiled.view().accel;
        const Hit hit = intersect_from_camera(accel, from_outside, 1);
        ASSERT_TRUE(hit.valid()) << "moves " << moves << ", scale " << mirror << ", s " << time_s;
        EXPECT_LT(hit.t, 3.0f) << "moves " << moves << ", scale " << mirror << ", s " << time_s;
        EXPECT_FALSE(intersect_from_camera(accel, from_within, 1).valid())
            << "moves " << moves << ", scale " << mirror << ", s " << time_s;
        EXPECT_TRUE(intersect(accel, from_within, 1).valid());
      }
    }
  }
}

/// A blended surface also evaluates its opacity.
TEST(Culling, CombinesWithOpacity) {
  Material clear = culled();
  clear.alpha_mode = AlphaMode::blend;
  for (const float alpha : {0.0f, 1.0f}) {
    clear.alpha = alpha;
    const CompiledScene compiled(testing::plate(clear), {});
    const AccelView& accel = compiled.view().accel;
    EXPECT_EQ(intersect_from_camera(accel, kFromFront, 1).valid(), alpha == 1);
    EXPECT_FALSE(intersect_from_camera(accel, kFromBehind, 1).valid());
    EXPECT_EQ(intersect(accel, kFromBehind, 1).valid(), alpha == 1);
  }
}

TEST(Culling, SparesDoubleSidedMaterialsAndVolumes) {
  Material double_sided = culled();
  double_sided.double_sided = true;
  Material volume = culled();
  volume.transmission = volume.thickness = 1;
  for (const Material& material : {double_sided, volume, Material{}}) {
    const CompiledScene compiled(testing::plate(material), {});
    EXPECT_TRUE(intersect_from_camera(compiled.view().accel, kFromBehind, 1).valid());
    EXPECT_FALSE(compiled.view().culls_back_faces);
  }
}

TEST(Culling, FollowsTheMaterial) {
  CompiledScene compiled(testing::plate(Material{}), {});
  compiled.set_material(0, culled());
  EXPECT_FALSE(intersect_from_camera(compiled.view().accel, kFromBehind, 1).valid());
  compiled.set_material(0, Material{});
  EXPECT_TRUE(intersect_from_camera(compiled.view().accel, kFromBehind, 1).valid());
}

}  // namespace
}  // namespace relume
