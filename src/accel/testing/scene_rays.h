// Rays through a compiled scene, like those of a path tracer.
#pragma once

#include <vector>

#include "accel/testing/soup.h"
#include "scene/compiled_scene.h"

namespace relume::testing {

struct SceneRays {
  std::vector<Ray> primary;  ///< of the camera, in the order of pixels
  std::vector<Ray> diffuse;  ///< from their hits, in directions distributed by the cosine
  std::vector<Ray> shadow;   ///< from their hits to points in the scene's bounds
};

/// Corner of a triangle in world space.
inline Vec3 world_corner(const SceneView& scene, const Instance& instance, uint32_t primitive, int corner) {
  const UVec3& index = scene.triangles[scene.meshes[instance.mesh].first_triangle + primitive];
  const Vec3& p = scene.vertices[index[corner]].position;
  return instance.in_world_space ? p : instance.to_world.point(p);
}

/// One ray of each kind per pixel of a width × height image; fewer where camera rays miss.
inline SceneRays scene_rays(const CompiledScene& compiled, int width, int height, uint32_t seed) {
  const SceneView& scene = compiled.view();
  CameraView camera = scene.camera;
  camera.resolution = Vec2(static_cast<float>(width), static_cast<float>(height));
  Random random(seed);
  SceneRays rays;
  const SceneBounds bounds = compiled.bounds();
  for (int i = 0; i < width * height; ++i) {
    const Vec2 raster(static_cast<float>(i % width) + random.uniform(),
                      static_cast<float>(i / width) + random.uniform());
    const Ray ray = generate(camera, raster, {random.uniform(), random.uniform()});
    rays.primary.push_back(ray);
    const Hit hit = intersect_from_camera(scene.accel, ray, 0);
    if (!hit.valid()) continue;
    const Instance& instance = scene.instances[hit.instance];
    const Vec3 p0 = world_corner(scene, instance, hit.primitive, 0);
    const Vec3 normal = glm::cross(world_corner(scene, instance, hit.primitive, 1) - p0,
                                   world_corner(scene, instance, hit.primitive, 2) - p0);
    if (!(length_squared(normal) > 0)) continue;
    Vec3 n = glm::normalize(normal);
    if (glm::dot(n, ray.direction) > 0) n = -n;
    const Vec3 p = ray.origin + ray.direction * hit.t;
    const Vec3 origin = p + n * (1e-5f * max_component(abs(p)));
    rays.diffuse.push_back({origin, glm::normalize(n * 1.001f + random.direction()), kInfinity});
    const Vec3 to_light = bounds.center + bounds.radius * random.point(-0.5f, 0.5f) - origin;
    const float distance = glm::length(to_light);
    if (distance > 0) rays.shadow.push_back({origin, to_light / distance, distance});
  }
  return rays;
}

}  // namespace relume::testing
