#include "techniques/gbuffer/features/reflection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"
#include "techniques/denoise/shared/split_light.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 45;
constexpr uint32_t kHeight = 37;
constexpr uint32_t kPixels = kWidth * kHeight;
constexpr float kCeiling = 3;

void add_ceiling(Scene& scene) {
  scene.materials.push_back(testing::matte(Rgb(0.5f)));
  Mesh mesh;
  mesh.positions = {{-50, 0, -50}, {50, 0, -50}, {50, 0, 50}, {-50, 0, 50}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = 1;
  scene.meshes.push_back(mesh);
  Node node;
  node.name = "ceiling";
  node.meshes = {1};
  node.transform.translation = Vec3(0, kCeiling, 0);
  scene.add_node(node);
}

/// A floor of `roughness` at y = 0 below a ceiling, seen obliquely.
Scene room(float roughness) {
  Material floor = testing::matte(Rgb(0.3f));
  floor.specular = 1;
  floor.roughness = roughness;
  Scene scene = testing::plate(floor, 40, 1);
  scene.cameras[0].projection = Projection::perspective;
  scene.cameras[0].fov_y_rad = 0.7f;
  scene.nodes[1].transform.translation = Vec3(0, 1.5f, 0);
  scene.nodes[1].transform.rotation = glm::angleAxis(-1.0f, Vec3(1, 0, 0));
  add_ceiling(scene);
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1);
  return scene;
}

RenderSettings settings_of(bool split = true) {
  RenderSettings s;
  s.width = kWidth;
  s.height = kHeight;
  s.threads = 1;
  s.path.max_bounces = 2;
  s.denoise = DenoiseChoice::svgf;
  s.features.split = split;
  return s;
}

template <typename T>
View<const T> view(const Session& session, const BufferKey<T>& key) {
  return buffer_table(session).view(key);
}

/// Moves the camera's node by `way`.
void walk(Session& session, const Scene& scene, const Vec3& way) {
  Transform eye = scene.nodes[1].transform;
  eye.translation += way;
  session.set_transform(1, eye);
}

TEST(Reflection, SharpImagesLieAsFarBehindTheFloor) {
  Scene scene = room(0.03f);
  Session session(scene, settings_of());
  session.render_frame();
  for (uint32_t i = 0; i < kPixels; ++i) {
    EXPECT_NEAR(view(session, kReflection.position)[i].y, -kCeiling, 0.3f) << i;
    EXPECT_NEAR(view(session, kFeature.position)[i].y, 0, 1e-5f);
    EXPECT_LT(max_component(view(session, kSpecularAlbedo)[i]), 0.3f);
    const Rgb parts = view(session, kSpecularAlbedo)[i] + view(session, kDiffuseAlbedo)[i];
    EXPECT_NEAR(parts.r, view(session, kFeatureAlbedo)[i].r, 1e-6f);
  }
}

TEST(Reflection, WideLobesShowTheirSurface) {
  Session session(room(0.5f), settings_of());
  session.render_frame();
  for (uint32_t i = 0; i < kPixels; ++i) {
    EXPECT_NEAR(view(session, kReflection.position)[i].y, 0, 0.02f) << i;
    EXPECT_EQ(view(session, kReflection.normal)[i], view(session, kFeature.normal)[i]);
  }
}

/// The image of the ceiling moves less than the reflecting floor, by the ratio of their distances.
TEST(Reflection, ImagesMoveLikeImages) {
  for (const float roughness : {0.05f, 0.3f, 0.6f}) {
    const Scene scene = room(roughness);
    Session session(scene, settings_of(), {1});
    session.render_frame();
    walk(session, scene, Vec3(0.05f, 0, 0));
    session.render_frame();
    for (uint32_t i = 0; i < kPixels; ++i) {
      const float floor = view(session, kFeature.motion)[i].x;
      const float image = view(session, kReflection.motion)[i].x;
      ASSERT_LT(floor, -0.1f);
      // Along a camera ray, distances are proportional to depths: 1.5 m and 1.5 + 3 m.
      EXPECT_NEAR(image / floor, 1.5f / (1.5f + kCeiling), 0.01f) << i << " " << roughness;
    }
  }
}

TEST(Reflection, ImagesOfMovingObjectsMove) {
  const Scene scene = room(0.05f);
  Session session(scene, settings_of(), {2});
  session.render_frame();
  Transform lower = scene.nodes[2].transform;
  lower.translation.y -= 0.25f;
  session.set_transform(2, lower);
  session.render_frame();
  for (uint32_t i = 0; i < kPixels; ++i) {
    const float image = view(session, kReflection.position)[i].y;
    const float before = view(session, kReflection.previous)[i].y;
    EXPECT_NEAR(before - image, -0.25f, 0.03f) << i;  // was lower
    EXPECT_EQ(view(session, kFeature.motion)[i], Vec2(0));
  }
}

TEST(Reflection, ConvexMirrorsShowImagesCloser) {
  EXPECT_FLOAT_EQ(reflection_detail::image_distance(3, 0), 3);
  EXPECT_NEAR(reflection_detail::image_distance(1e6f, 1 / 0.8f), 0.4f, 1e-5f);  // the focus, half a radius away
  Scene scene = find_builtin_scene("furnace")->build();
  constexpr float kRadius = 0.8f;
  scene.meshes[0] = icosphere(kRadius, 4);
  const CompiledScene compiled(scene, CompileOptions{.camera = {}, .width = kWidth, .height = kHeight});
  const Ray ray = [&] {
    Sampler sampler = SampleIndex{1, 0, 0, false}.sampler(kWidth / 2, kHeight / 2);
    return camera_ray(compiled.view().camera, kWidth / 2, kHeight / 2, sampler);
  }();
  const Hit hit = intersect(compiled.view().accel, ray, 0);
  ASSERT_TRUE(hit.valid());
  SurfacePoint sp;
  make_surface_point(compiled.view(), ray, hit, 0, sp);
  const float bend = reflection_detail::curvature(compiled.view(), hit, sp.frame.n);
  EXPECT_NEAR(bend, 1 / kRadius, 0.02f);
  EXPECT_NEAR(reflection_detail::curvature(compiled.view(), hit, -sp.frame.n), -bend, 1e-6f);
}

TEST(Reflection, IsComputedOnlyOnRequest) {
  Session session(room(0.2f), settings_of(false));
  session.render_frame();
  EXPECT_EQ(view(session, kSpecularAlbedo).size, 0u);
  EXPECT_EQ(view(session, kRadianceSpecular).size, 0u);
}

TEST(SplitLight, PartsMakeTheWhole) {
  const Rgb scattered(1, 2, 3);
  const Rgb found(0.25f, 0.5f, 1);
  Rgb diffuse;
  Rgb specular;
  const auto split = [&](const Rgb& diffuse_albedo, const Rgb& specular_albedo) {
    const SplitLightKernel kernel{
        {&scattered, 1}, {&found, 1}, {&diffuse_albedo, 1}, {&specular_albedo, 1}, {&diffuse, 1}, {&specular, 1}, 1};
    kernel(0, 0);
  };
  split(Rgb(0.5f), Rgb(0.1f));
  EXPECT_EQ(specular, found);
  EXPECT_EQ(diffuse, scattered - found);
  split(Rgb(0.5f), Rgb(0));  // followed mirrors, wide lobes
  EXPECT_EQ(specular, Rgb(0));
  EXPECT_EQ(diffuse, scattered);
  split(Rgb(0), Rgb(0.9f));  // metals
  EXPECT_EQ(specular, scattered);
  EXPECT_EQ(diffuse, Rgb(0));
}

}  // namespace
}  // namespace relume
