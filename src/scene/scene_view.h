// The compiled scene as kernels see it: flat arrays, indices instead of pointers.
#pragma once

#include "accel/accel.h"
#include "core/octahedral.h"
#include "core/view.h"
#include "lights/light.h"
#include "materials/energy_tables.h"
#include "materials/layers.h"
#include "materials/material.h"
#include "materials/texture.h"
#include "scene/camera_view.h"

namespace relume {

/// Affine map, column by column.
struct Affine {
  Mat3 linear{1};
  Vec3 translation{0};

  RELUME_HD Vec3 point(const Vec3& p) const { return linear * p + translation; }
  RELUME_HD Vec3 vector(const Vec3& v) const { return linear * v; }
};

/// Takes normals along: the transpose of the inverse times the determinant.
RELUME_HD inline Mat3 cofactors(const Mat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

/// Takes normals along, up to a positive factor, without overflow for any scale: only directions count.
RELUME_HD inline Mat3 normal_matrix(const Mat3& m) {
  const float largest = max(max_component(abs(m[0])), max(max_component(abs(m[1])), max_component(abs(m[2]))));
  return cofactors(largest > 0 ? m / largest : m);
}

/// A unit normal with 16 bits a component, so that three of them interpolate without a square root; the fourth number
/// is the handedness of the bitangent.
struct PackedNormal {
  int16_t x, y, z, sign;

  /// Of length 32767, to be interpolated and normalised.
  RELUME_HD Vec3 unpack() const { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
  RELUME_HD float handedness() const { return sign < 0 ? -1.0f : 1.0f; }
};

RELUME_HD inline PackedNormal pack_normal(const Vec3& n, float handedness) {
  const auto quantise = [](float c) { return static_cast<int16_t>(std::lround(clamp(c, -1.0f, 1.0f) * 32767.0f)); };
  return {quantise(n.x), quantise(n.y), quantise(n.z), static_cast<int16_t>(handedness < 0.0f ? -1 : 1)};
}

/// 32 bytes, so that a triangle touches three cache lines.
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
  uint32_t first_uv1 = 0;  ///< added to the vertex index
  uint32_t first_color = 0;
  uint32_t first_previous = 0;
  bool has_normals = false;
  bool has_uv = false;
  bool has_tangents = false;
  bool has_uv1 = false;
  bool has_colors = false;
  bool deforms = false;  ///< its vertices move from frame to frame: they have previous positions
};

/// One instance of a mesh.
struct Instance {
  Affine to_world;
  Mat3 normal_to_world{1};  ///< cofactors of to_world.linear up to a factor: takes normals along
  Affine previous_to_world;
  uint32_t mesh = 0;
  LightId first_light = kNoLight;  ///< of its triangles, if they emit
  bool in_world_space = true;      ///< stored transformed, because static or skinned: the matrices are the identity
  float orientation = 1;           ///< −1: to_world, or the skin, mirrors
  bool visible = true;             ///< false: rays do not meet it, and it emits nothing
};

struct SceneView {
  View<const Vertex> vertices;
  View<const UVec3> triangles;  ///< vertex indices into `vertices`
  View<const Vec2> uv1;
  View<const Vec4> colors;
  View<const Vec3> previous_positions;  ///< one frame ago, of the vertices of meshes that deform
  View<const MeshView> meshes;
  View<const Instance> instances;
  View<const MaterialData> materials;
  View<const LayerData> layers;  ///< of the materials that have some
  View<const TextureView> textures;
  LightsView lights;
  CameraView camera;
  CameraView previous_camera;
  const EnergyTables* energy_tables = nullptr;
  AccelView accel;
  bool absorbs = false;           ///< some material fills a body that absorbs
  bool culls_back_faces = false;  ///< some material does
  bool disperses = false;         ///< some material does: paths have wavelengths
  Rgb camera_medium{0};           ///< absorption at the camera, per metre: that of all bodies it stands in
};

}  // namespace relume
