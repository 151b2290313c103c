// The compiled scene for kernels: flat arrays, with indices instead of pointers.
#pragma once

#include "accel/accel.h"
#include "core/key_time.h"
#include "core/math.h"
#include "core/octahedral.h"
#include "core/view.h"
#include "lights/light.h"
#include "materials/energy_tables.h"
#include "materials/layers.h"
#include "materials/material.h"
#include "materials/texture.h"
#include "scene/camera_view.h"

namespace relume {

/// Affine map in columns.
struct Affine {
  Mat3 linear{1};
  Vec3 translation{0};

  RELUME_HD Vec3 point(const Vec3& p) const { return linear * p + translation; }
  RELUME_HD Vec3 vector(const Vec3& v) const { return linear * v; }
};

/// Transforms normals: the transpose of the inverse times the determinant.
RELUME_HD inline Mat3 cofactors(const Mat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

/// Transforms normals up to a positive factor, without overflow at any scale.
RELUME_HD inline Mat3 normal_matrix(const Mat3& m) {
  const float largest = max(max_component(abs(m[0])), max(max_component(abs(m[1])), max_component(abs(m[2]))));
  return cofactors(largest > 0 ? m / largest : m);
}

/// A unit normal with 16 bits per component. All have the same length, so three interpolate without a square root. The
/// fourth number is the handedness of the bitangent.
struct PackedNormal {
  int16_t x, y, z, sign;

  /// Vector of length 32767, to be interpolated and normalised.
  RELUME_HD Vec3 unpack() const { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
  RELUME_HD float handedness() const { return sign < 0 ? -1.0f : 1.0f; }
};

RELUME_HD inline PackedNormal pack_normal(const Vec3& n, float handedness) {
  const auto quantise = [](float c) {
    return static_cast<int16_t>(math::round_to_int(clamp(c, -1.0f, 1.0f) * 32767.0f));
  };
  return {quantise(n.x), quantise(n.y), quantise(n.z), static_cast<int16_t>(handedness < 0.0f ? -1 : 1)};
}

/// 32 bytes: a triangle touches three cache lines.
struct alignas(32) Vertex {
  Vec3 position;
  PackedNormal normal;
  Vec2 uv;           ///< first set
  uint32_t tangent;  ///< octahedral; valid if the mesh has tangents
};
static_assert(sizeof(Vertex) == 32);

struct MeshView {
  uint32_t first_triangle = 0;
  uint32_t triangle_count = 0;
  uint32_t material = 0;
  uint32_t first_uv1 = 0;  ///< offset added to the vertex index
  uint32_t first_color = 0;
  uint32_t first_previous = 0;
  bool has_normals = false;
  bool has_uv = false;
  bool has_tangents = false;
  bool has_uv1 = false;
  bool has_colors = false;
  bool deforms = false;          ///< whether its vertices move from frame to frame and have previous positions
  uint32_t first_key = kNoKeys;  ///< MotionView: offset of the first key, added to the vertex index; kNoKeys: rests
  uint32_t key_stride = 0;       ///< vertices from one key to the next
};

/// One instance of a mesh.
struct Instance {
  Affine to_world;
  Mat3 normal_to_world{1};  ///< cofactors of to_world.linear up to a factor: transforms normals
  Affine previous_to_world;
  uint32_t mesh = 0;
  LightId first_light = kNoLight;  ///< first of its triangles, if they emit
  bool paired_lights = false;      ///< whether triangles 2k and 2k + 1 are one light
  bool in_world_space = true;      ///< stored in world space, because static or skinned: the matrices are the identity
  float orientation = 1;           ///< −1: to_world or the skin mirrors
  bool visible = true;             ///< false: invisible to rays, no emission
  uint32_t first_key = kNoKeys;    ///< MotionView::instance_keys; kNoKeys: rests while the shutter is open
};

/// What moves while the shutter is open, posed at keys at equal steps of time. The number of keys is odd: the middle
/// one is the pose of the frame, which all other arrays hold. Between keys, points move along straight lines.
struct MotionView {
  View<const Affine> instance_keys;  ///< Instance::to_world; `count` for each moving instance
  View<const Vertex> vertex_keys;    ///< positions, normals and tangents of deforming meshes; the rest is undefined
  uint32_t count = 0;                ///< 0: nothing moves, or the shutter is closed

  RELUME_HD bool empty() const { return count == 0; }
};

/// The light of an emissive instance's triangle.
RELUME_HD inline LightId light_of(const Instance& instance, uint32_t primitive) {
  return instance.first_light + (instance.paired_lights ? primitive / 2 : primitive);
}

struct SceneView {
  View<const Vertex> vertices;
  View<const UVec3> triangles;  ///< vertex indices into `vertices`
  View<const Vec2> uv1;
  View<const Vec4> colors;
  View<const Vec3> previous_positions;  ///< of the previous frame, for vertices of deforming meshes
  View<const MeshView> meshes;
  View<const Instance> instances;
  View<const MaterialData> materials;
  View<const LayerData> layers;  ///< of layered materials
  TexturesView textures;
  LightsView lights;
  MotionView motion;
  CameraView camera;  ///< at the middle of the shutter
  CameraView previous_camera;
  EnergyTables energy_tables;  ///< with the layers that materials have
  AccelView accel;
  bool absorbs = false;           ///< whether a material has an absorbing volume
  bool culls_back_faces = false;  ///< whether a material culls back faces
  bool disperses = false;         ///< whether a material disperses light: paths then have wavelengths
  Rgb camera_medium{0};           ///< absorption at the camera, per metre: the sum over all media around it
};

}  // namespace relume
