// Scenes with analytic images for tests of the caches.
#pragma once

#include "builtin_scenes/shapes.h"
#include "scene/testing/media.h"

namespace relume::testing {

inline void add_camera(Scene& scene, const Camera& camera, const Vec3& position, const glm::quat& rotation) {
  scene.cameras.push_back(camera);
  Node eye;
  eye.camera = static_cast<Index>(scene.cameras.size()) - 1;
  eye.transform.translation = position;
  eye.transform.rotation = rotation;
  scene.add_node(eye);
}

/// A camera inside a closed box whose walls have the albedo `albedo` and emit radiance 1. With D bounces every pixel is
/// 1 + albedo + … + albedo^D.
inline Scene closed_furnace(float albedo) {
  Scene scene;
  scene.name = "closed furnace";
  Material wall = matte(Rgb(albedo));
  wall.emission = Rgb(1);
  add_mesh(scene, wall, flipped(box({-1, -1, -1}, {1, 1, 1})));
  Camera camera;
  camera.fov_y_rad = 1.2f;
  add_camera(scene, camera, {0.1f, 0.2f, 0.5f}, glm::quat(1, 0, 0, 0));
  return scene;
}

inline double closed_furnace_radiance(double albedo, int bounces) {
  double sum = 0;
  double power = 1;
  for (int k = 0; k <= bounces; ++k, power *= albedo) sum += power;
  return sum;
}

/// A plate at y = 0 under a constant sky of radiance 1, seen from above. It fills the image of an orthographic camera,
/// and every pixel is the albedo without noise.
inline Scene plate_under_sky(const Material& material) {
  Scene scene;
  scene.name = "plate";
  Mesh mesh;
  mesh.positions = {{-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_mesh(scene, material, mesh);
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = 1;
  add_camera(scene, camera, {0, 0.5f, 0}, glm::angleAxis(-kPi / 2, Vec3(1, 0, 0)));
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1);
  return scene;
}

}  // namespace relume::testing
