// Surface points of an open shutter: instance and triangle at the time of the ray. Included by surface_point_impl.h.
#pragma once

#include "scene/surface_point.h"

namespace relume {
namespace surface_detail {

/// A triangle at a time within the shutter. It reads the keys each time it is asked, because copies of vertices and
/// matrices would need the memory of a device's thread.
struct MovedTriangleAt : TriangleAt {
  const MotionView& motion;
  KeyTime at;
  uint32_t first_vertex = 0;  ///< of the key before the time, added to the vertex index
  uint32_t stride = 0;        ///< vertices from one key to the next
  uint32_t first_matrix = 0;  ///< of the key before the time
  bool deforms = false;
  bool moves = false;

  RELUME_HD MovedTriangleAt(const TriangleAt& rest, const SceneView& scene, const MeshView& mesh,
                            const Instance& instance, float time)
      : TriangleAt(rest),
        motion(scene.motion),
        at(time, scene.motion.count),
        first_vertex(mesh.first_key + at.first * mesh.key_stride),
        stride(mesh.key_stride),
        first_matrix(instance.first_key + at.first),
        deforms(mesh.first_key != kNoKeys),
        moves(instance.first_key != kNoKeys) {}

  RELUME_HD const Vertex& before(int k) const { return motion.vertex_keys[first_vertex + index[k]]; }
  RELUME_HD const Vertex& after(int k) const { return motion.vertex_keys[first_vertex + stride + index[k]]; }

  RELUME_HD Vec3 position(int k) const {
    return deforms ? at.mix(before(k).position, after(k).position) : v[k]->position;
  }
  /// Normals and tangents are interpolated as directions; 0 between opposite ones.
  RELUME_HD Vec3 normal(int k) const {
    return deforms ? direction(before(k).normal.unpack(), after(k).normal.unpack()) : v[k]->normal.unpack();
  }
  RELUME_HD Vec3 tangent(int k) const {
    return deforms ? direction(unpack_direction(before(k).tangent), unpack_direction(after(k).tangent))
                   : unpack_direction(v[k]->tangent);
  }
  RELUME_HD Affine to_world(const Instance& instance) const {
    if (!moves) return instance.to_world;
    const Affine& a = motion.instance_keys[first_matrix];
    const Affine& b = motion.instance_keys[first_matrix + 1];
    return {at.mix(a.linear, b.linear), at.mix(a.translation, b.translation)};
  }
  RELUME_HD Vec3 vector_to_world(const Instance& instance, const Vec3& d) const {
    if (!moves) return instance.to_world.vector(d);
    return at.mix(motion.instance_keys[first_matrix].vector(d), motion.instance_keys[first_matrix + 1].vector(d));
  }
  RELUME_HD Vec3 normal_to_world(const Instance& instance, const Vec3& n) const {
    return moves ? normal_matrix(to_world(instance).linear) * n : instance.normal_to_world * n;
  }

  /// Error of the interpolated corners, by component and beyond that of Geometry, in their space.
  RELUME_HD float corner_error() const {
    float largest = 0;
    for (int k = 0; k < 3 && deforms; ++k) {
      const float of_keys = relume::max(max_component(abs(before(k).position)), max_component(abs(after(k).position)));
      largest = relume::max(largest, of_keys);
    }
    return gamma_bound(8) * largest;
  }
  /// world_error() between two keys: ray queries and surfaces round the interpolated matrix in different ways.
  RELUME_HD float moved_error(const Vec3& position, float error) const {
    const Affine& a = motion.instance_keys[first_matrix];
    const Affine& b = motion.instance_keys[first_matrix + 1];
    return 2.0f * (world_error(a, position, error) + world_error(b, position, error));
  }

 private:
  RELUME_HD Vec3 direction(const Vec3& a, const Vec3& b) const {
    const Vec3 mixed = at.mix(a, b);
    const float length = glm::length(mixed);
    return length > 0.0f ? mixed / length : Vec3(0);
  }
};

}  // namespace surface_detail

RELUME_HD_NOINLINE inline void make_moved_surface_point(const SceneView& scene, const Ray& ray, const Hit& hit,
                                                        float cone_width, SurfacePoint& sp, float wavelength_nm) {
  using namespace surface_detail;
  const Instance& instance = scene.instances[hit.instance];
  const MeshView& mesh = scene.meshes[instance.mesh];
  const TriangleAt rest = triangle_at(scene, mesh, hit.primitive, hit.u, hit.v);
  const MovedTriangleAt t(rest, scene, mesh, instance, ray.time);
  make_point_on(scene, instance, t, ray, hit, cone_width, sp, wavelength_nm);
  if (!t.moves && !t.deforms) return;
  const Vec3 p = interpolate(t.position(0), t.position(1), t.position(2), t.weights);
  const float corner_error = t.corner_error();
  const float error = gamma_bound(7) * max_component(abs(p)) + corner_error;
  if (t.moves) {
    sp.position_error = relume::max(sp.position_error, t.moved_error(p, error));
  } else if (instance.in_world_space) {
    sp.position_error += corner_error;
  } else {
    sp.position_error = relume::max(sp.position_error, world_error(instance.to_world, p, error));
  }
  const SurfacePosition middle = surface_position(scene, hit);
  sp.previous_position = sp.position - (middle.now - middle.before);
}

}  // namespace relume
