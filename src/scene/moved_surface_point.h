// Surface points of an open shutter: instance and triangle at the time of the ray. Included by surface_point_impl.h.
#pragma once

#include "scene/surface_point.h"

namespace relume {
namespace surface_detail {

/// The vertices of a triangle at one time.
struct MovedTriangle {
  Vertex corners[3];
  float error = 0;  ///< of the interpolated positions, by component and beyond that of Geometry, in their space
};

/// A vertex between two keys. Normals and tangents are interpolated as directions.
RELUME_HD inline Vertex mixed_vertex(const KeyTime& at, const Vertex& a, const Vertex& b, const Vertex& rest) {
  Vertex v = rest;  // texture coordinates
  v.position = at.mix(a.position, b.position);
  const Vec3 normal = at.mix(a.normal.unpack(), b.normal.unpack());
  const float length = glm::length(normal);
  if (length > 0.0f) v.normal = pack_normal(normal / length, rest.normal.handedness());
  const Vec3 tangent = at.mix(unpack_direction(a.tangent), unpack_direction(b.tangent));
  const float tangent_length = glm::length(tangent);
  if (tangent_length > 0.0f) v.tangent = pack_direction(tangent / tangent_length);
  return v;
}

/// Moves the triangle `t` of a deforming mesh with keys to a time. `t` then refers to the result.
RELUME_HD inline void move_triangle(const SceneView& scene, const MeshView& mesh, float time, TriangleAt& t,
                                    MovedTriangle& moved) {
  const KeyTime at(time, scene.motion.count);
  const uint32_t first = mesh.first_key + at.first * mesh.key_stride;
  float largest = 0;
  for (int k = 0; k < 3; ++k) {
    const Vertex& a = scene.motion.vertex_keys[first + t.index[k]];
    const Vertex& b = scene.motion.vertex_keys[first + mesh.key_stride + t.index[k]];
    moved.corners[k] = mixed_vertex(at, a, b, *t.v[k]);
    largest = relume::max(largest, relume::max(max_component(abs(a.position)), max_component(abs(b.position))));
    t.v[k] = &moved.corners[k];
  }
  moved.error = gamma_bound(8) * largest;
}

/// An instance at a time, from its keys. Its previous transform stays that of the frame.
RELUME_HD inline Instance moved_instance(const SceneView& scene, const Instance& instance, float time) {
  const KeyTime at(time, scene.motion.count);
  const Affine& a = scene.motion.instance_keys[instance.first_key + at.first];
  const Affine& b = scene.motion.instance_keys[instance.first_key + at.first + 1];
  Instance moved = instance;
  moved.to_world.linear = at.mix(a.linear, b.linear);
  moved.to_world.translation = at.mix(a.translation, b.translation);
  moved.normal_to_world = normal_matrix(moved.to_world.linear);
  return moved;
}

/// world_error() between two keys: ray queries and surfaces round the interpolated matrix in different ways.
RELUME_HD inline float moved_error(const SceneView& scene, const Instance& instance, float time, const Vec3& position,
                                   float error) {
  const KeyTime at(time, scene.motion.count);
  const Affine& a = scene.motion.instance_keys[instance.first_key + at.first];
  const Affine& b = scene.motion.instance_keys[instance.first_key + at.first + 1];
  return 2.0f * (world_error(a, position, error) + world_error(b, position, error));
}

}  // namespace surface_detail

RELUME_HD_NOINLINE inline void make_moved_surface_point(const SceneView& scene, Ray ray, Hit hit, float cone_width,
                                                        SurfacePoint& sp, float wavelength_nm) {
  using namespace surface_detail;
  const Instance& at_middle = scene.instances[hit.instance];
  const MeshView& mesh = scene.meshes[at_middle.mesh];
  TriangleAt t = triangle_at(scene, mesh, hit.primitive, hit.u, hit.v);
  const bool moves = at_middle.first_key != kNoKeys;
  const bool deforms = mesh.first_key != kNoKeys;
  MovedTriangle triangle;
  if (deforms) move_triangle(scene, mesh, ray.time, t, triangle);
  Instance instance = at_middle;
  if (moves) instance = moved_instance(scene, at_middle, ray.time);
  make_point_on(scene, instance, t, ray, hit, cone_width, sp, wavelength_nm);
  if (!moves && !deforms) return;
  const Vec3 p = interpolate(t.v[0]->position, t.v[1]->position, t.v[2]->position, t.weights);
  const float error = gamma_bound(7) * max_component(abs(p)) + triangle.error;
  if (moves) {
    sp.position_error = relume::max(sp.position_error, moved_error(scene, at_middle, ray.time, p, error));
  } else if (at_middle.in_world_space) {
    sp.position_error += triangle.error;
  } else {
    sp.position_error = relume::max(sp.position_error, world_error(at_middle.to_world, p, error));
  }
  const SurfacePosition middle = surface_position(scene, hit);
  sp.previous_position = sp.position - (middle.now - middle.before);
}

}  // namespace relume
