// Implementation of surface_point.h, in a header for compilation on the device.
#pragma once

#include "core/math.h"
#include "scene/surface_point.h"

namespace relume {
namespace surface_detail {

/// Copies by component. A whole copy reads just-written components in larger pieces, which stalls processors.
RELUME_HD_INLINE Vec3 copy_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Data of one triangle at a hit. Its functions give what moves in an open shutter; MovedTriangleAt replaces them.
struct TriangleAt {
  const Vertex* v[3];
  UVec3 index;
  Vec3 weights;

  RELUME_HD_INLINE const Vec3& position(int k) const { return v[k]->position; }
  RELUME_HD_INLINE Vec3 normal(int k) const { return v[k]->normal.unpack(); }
  RELUME_HD_INLINE Vec3 tangent(int k) const { return unpack_direction(v[k]->tangent); }
  RELUME_HD_INLINE const Affine& to_world(const Instance& i) const { return i.to_world; }
  RELUME_HD_INLINE Vec3 vector_to_world(const Instance& i, const Vec3& d) const { return i.to_world.vector(d); }
  RELUME_HD_INLINE Vec3 normal_to_world(const Instance& i, const Vec3& n) const { return i.normal_to_world * n; }
};

RELUME_HD inline TriangleAt triangle_at(const SceneView& scene, const MeshView& mesh, uint32_t primitive, float u,
                                        float v) {
  TriangleAt t;
  t.index = scene.triangles[mesh.first_triangle + primitive];
  t.v[0] = &scene.vertices[t.index.x];
  t.v[1] = &scene.vertices[t.index.y];
  t.v[2] = &scene.vertices[t.index.z];
  t.weights = Vec3(1.0f - u - v, u, v);
  return t;
}

template <typename T>
RELUME_HD inline T interpolate(const T& a, const T& b, const T& c, const Vec3& w) {
  return a * w.x + b * w.y + c * w.z;
}

/// One set of texture coordinates on a triangle.
struct UvSet {
  Vec2 origin{0};  ///< at the first vertex
  Vec2 d1{0};      ///< from the first to the second
  Vec2 d2{0};      ///< from the first to the third

  RELUME_HD UvSet() = default;
  RELUME_HD UvSet(const Vec2& a, const Vec2& b, const Vec2& c) : origin(a), d1(b - a), d2(c - a) {}
  RELUME_HD Vec2 at(const Vec3& weights) const { return origin + d1 * weights.y + d2 * weights.z; }
  RELUME_HD float determinant() const { return d1.x * d2.y - d1.y * d2.x; }
};

RELUME_HD inline UvSet uv_set(const SceneView& scene, const MeshView& mesh, const TriangleAt& t, uint32_t set) {
  if (set == 0 && mesh.has_uv) return {t.v[0]->uv, t.v[1]->uv, t.v[2]->uv};
  if (set == 0 || !mesh.has_uv1) return {};
  const uint32_t first = mesh.first_uv1;
  return {scene.uv1[first + t.index.x], scene.uv1[first + t.index.y], scene.uv1[first + t.index.z]};
}

/// Texture coordinates at the hit, and texture-space area per square metre, per set.
struct Uv {
  Vec2 uv[2] = {Vec2(0), Vec2(0)};
  float density[2] = {0, 0};  ///< uv area per m²
};

RELUME_HD inline Uv uv_at(const SceneView& scene, const MeshView& mesh, const TriangleAt& t, float twice_area) {
  Uv result;
  for (uint32_t set = 0; set < 2; ++set) {
    if (set == 0 ? !mesh.has_uv : !mesh.has_uv1) continue;
    const UvSet corners = uv_set(scene, mesh, t, set);
    result.uv[set] = corners.at(t.weights);
    result.density[set] = std::fabs(corners.determinant()) / twice_area;
  }
  return result;
}

/// Texture look-up at the level for a footprint of `area` m².
RELUME_HD inline Vec4 fetch(const SceneView& scene, const TextureUse& use, const Uv& uv, float area) {
  const auto texture = static_cast<uint32_t>(use.texture);
  const TextureRecord& record = scene.textures.records[texture];
  const float texels = uv.density[use.uv_set] * use.transform.area_scale() * area * static_cast<float>(record.width) *
                       static_cast<float>(record.height);
  const float lod = texels > 1.0f ? 0.5f * math::log2(texels) : 0.0f;
  return scene.textures.sample(texture, use.transform(uv.uv[use.uv_set]), lod);
}

/// Texture look-up without a filter.
RELUME_HD inline Vec4 fetch_unfiltered(const SceneView& scene, const TextureUse& use, const Uv& uv) {
  return scene.textures.sample_level(static_cast<uint32_t>(use.texture), use.transform(uv.uv[use.uv_set]), 0);
}

/// The part of a mixture that a hit shows, and the material whose normal map it has.
struct MixturePart {
  uint32_t material;
  uint32_t mapped;
};

/// The part that a hit of `material` shows: always the same one, whatever the footprint. It has its own normal map, or
/// else that of the innermost mixture around it that has one.
RELUME_HD inline MixturePart part_at(const SceneView& scene, uint32_t material, const Hit& hit, const Uv& uv) {
  MixturePart part{material, material};
  if (!scene.materials[material].is_mixture() || scene.materials[material].unlit) return part;
  uint32_t coin = hash(hash(hit.instance, hit.primitive), hash(float_bits(hit.u), float_bits(hit.v)));
  while (scene.materials[part.material].is_mixture()) {
    const MaterialData& m = scene.materials[part.material];
    float share = m.mix_share;
    if (m.mix_texture.used()) share *= fetch_unfiltered(scene, m.mix_texture, uv).x;
    part.material = static_cast<uint32_t>(to_unit_float(coin) < share ? m.mix_second : m.mix_first);
    if (scene.materials[part.material].normal_texture.used()) part.mapped = part.material;
    coin = hash(coin, part.material);
  }
  return part;
}

/// Position, error bound, previous position and geometric normal (front, not normalised) of a hit.
struct Geometry {
  Vec3 position;
  float error;
  Vec3 previous_position;
  Vec3 e1;
  Vec3 e2;
  Vec3 front;
};

/// Bound on the rounding error of world-space hit positions, metres, from that in mesh space, the space of `position`.
/// Embree intersects in mesh space and rounds the transformed ray. The bound therefore includes the transform in both
/// directions.
RELUME_HD_INLINE float world_error(const Affine& to_world, const Vec3& position, float error) {
  const Mat3 magnitude(abs(to_world.linear[0]), abs(to_world.linear[1]), abs(to_world.linear[2]));
  return 2.0f * max_component(gamma_bound(3) * (magnitude * abs(position) + abs(to_world.translation)) +
                              (1.0f + gamma_bound(3)) * (magnitude * Vec3(error)));
}

/// Position of the hit's point in the previous frame, for a deforming mesh, in mesh space.
RELUME_HD inline Vec3 position_before(const SceneView& scene, const MeshView& mesh, const TriangleAt& t) {
  const uint32_t first = mesh.first_previous;
  return interpolate(scene.previous_positions[first + t.index.x], scene.previous_positions[first + t.index.y],
                     scene.previous_positions[first + t.index.z], t.weights);
}

template <typename Triangle>
RELUME_HD_INLINE Geometry geometry_at(const SceneView& scene, const MeshView& mesh, const Instance& instance,
                                      const Triangle& t) {
  const Vec3& p0 = t.position(0);
  const Vec3& p1 = t.position(1);
  const Vec3& p2 = t.position(2);
  Geometry g;
  g.position = interpolate(p0, p1, p2, t.weights);
  // One bound for all components, since Embree's rounding follows the largest.
  g.error = gamma_bound(7) * max_component(abs(p0 * t.weights.x) + abs(p1 * t.weights.y) + abs(p2 * t.weights.z));
  g.previous_position = mesh.deforms ? position_before(scene, mesh, t) : copy_of(g.position);
  g.e1 = p1 - p0;
  g.e2 = p2 - p0;
  if (!instance.in_world_space) {
    const Affine& m = t.to_world(instance);
    g.error = world_error(m, g.position, g.error);
    g.previous_position = instance.previous_to_world.point(g.previous_position);
    g.position = m.point(g.position);
    g.e1 = m.vector(g.e1);
    g.e2 = m.vector(g.e2);
  }
  g.front = glm::cross(g.e1, g.e2) * instance.orientation;
  return g;
}

/// Edges of a triangle from its first corner, and its unit normal.
RELUME_HD inline Mat3 triangle_axes(const Vec3& p0, const Vec3& p1, const Vec3& p2) {
  const Vec3 e1 = p1 - p0;
  const Vec3 e2 = p2 - p0;
  const Vec3 n = glm::cross(e1, e2);
  const float length = glm::length(n);
  return {e1, e2, length > 0.0f ? n / length : Vec3(0)};
}

/// glTF's tangent and bitangent, along which texture coordinates grow: unit, orthogonal to the normal.
struct TangentFrame {
  Vec3 tangent;
  Vec3 bitangent;
  bool valid = false;  ///< false for degenerate texture coordinates
};

/// Tangent frame around `ns`, from the tangents of the mesh or from texture coordinates.
template <typename Triangle>
RELUME_HD inline TangentFrame tangent_frame(const SceneView& scene, const MeshView& mesh, const TextureUse& use,
                                            const Instance& instance, const Triangle& t, const Geometry& g,
                                            const Vec3& ns) {
  Vec3 tangent;
  float handedness = 1.0f;
  if (mesh.has_tangents) {
    tangent = interpolate(t.tangent(0), t.tangent(1), t.tangent(2), t.weights);
    if (!instance.in_world_space) tangent = t.vector_to_world(instance, tangent);
    handedness = t.v[0]->normal.handedness() * instance.orientation;
  } else {
    UvSet uvs = uv_set(scene, mesh, t, use.uv_set);
    uvs.d1 = use.transform.vector(uvs.d1);
    uvs.d2 = use.transform.vector(uvs.d2);
    const float determinant = uvs.determinant();
    if (determinant == 0.0f) return {};
    tangent = (g.e1 * uvs.d2.y - g.e2 * uvs.d1.y) / determinant;
    // glTF's bitangent points towards decreasing v.
    const Vec3 bitangent = (g.e1 * uvs.d2.x - g.e2 * uvs.d1.x) / determinant;
    handedness = glm::dot(glm::cross(ns, tangent), bitangent) < 0.0f ? -1.0f : 1.0f;
  }
  tangent -= ns * glm::dot(ns, tangent);
  const float length = glm::length(tangent);
  if (!(length > 0.0f && is_finite(length))) return {};
  tangent /= length;
  return {tangent, glm::cross(ns, tangent) * handedness, true};
}

/// World-space normal from a normal map.
template <typename Triangle>
RELUME_HD inline Vec3 mapped_normal(const SceneView& scene, const MeshView& mesh, const TextureUse& use, float scale,
                                    const Instance& instance, const Triangle& t, const Geometry& g, const Uv& uv,
                                    float area, const Vec3& ns) {
  const TangentFrame frame = tangent_frame(scene, mesh, use, instance, t, g, ns);
  if (!frame.valid) return ns;
  const Vec4 texel = fetch(scene, use, uv, area);
  const Vec3 n = Vec3(texel.x * 2.0f - 1.0f, texel.y * 2.0f - 1.0f, texel.z * 2.0f - 1.0f) * Vec3(scale, scale, 1.0f);
  return glm::normalize(n.x * frame.tangent + n.y * frame.bitangent + relume::max(n.z, 1e-3f) * ns);
}

/// Interpolated normal on the side of `front`, the unit geometric normal.
template <typename Triangle>
RELUME_HD_INLINE Vec3 interpolated_normal(const MeshView& mesh, const Instance& instance, const Triangle& t,
                                          const Vec3& front) {
  if (!mesh.has_normals) return front;
  Vec3 ns = interpolate(t.normal(0), t.normal(1), t.normal(2), t.weights);
  if (!instance.in_world_space) ns = t.normal_to_world(instance, ns) * instance.orientation;
  const float length = glm::length(ns);
  ns = length > 0.0f ? ns / length : front;
  return glm::dot(ns, front) < 0.0f ? -ns : ns;
}

/// Interpolated and normal-mapped normal on the side of `front`, the unit geometric normal.
template <typename Triangle>
RELUME_HD_INLINE Vec3 shading_normal(const SceneView& scene, const MeshView& mesh, const MaterialData& material,
                                     const Instance& instance, const Triangle& t, const Geometry& g, const Uv& uv,
                                     float footprint_area, const Vec3& front) {
  const Vec3 ns = interpolated_normal(mesh, instance, t, front);
  return material.normal_texture.used() ? mapped_normal(scene, mesh, material.normal_texture, material.normal_scale,
                                                        instance, t, g, uv, footprint_area, ns)
                                        : ns;
}

/// Parameters and directions of a material's layers. `side`: −1 for a viewer behind the surface.
template <typename Triangle>
RELUME_HD inline LayerSample layers_at(const SceneView& scene, const MeshView& mesh, const MaterialData& material,
                                       const Instance& instance, const Triangle& t, const Geometry& g, const Uv& uv,
                                       float footprint_area, const Vec3& front, float side, const Frame& shading) {
  const LayerData& data = scene.layers[static_cast<uint32_t>(material.layers)];
  LayerSample l = sample_layers(data, [&](const TextureUse& use) { return fetch(scene, use, uv, footprint_area); });
  const Vec3 ns = interpolated_normal(mesh, instance, t, front);
  if (l.anisotropy > 0.0f) {
    // Use the coordinates of the normal texture, if present (KHR_materials_anisotropy).
    const TextureUse& coordinates = material.normal_texture.used() ? material.normal_texture : data.anisotropy_texture;
    const TangentFrame frame = tangent_frame(scene, mesh, coordinates, instance, t, g, ns);
    const Vec3 along =
        shading.to_local(frame.tangent * l.anisotropy_direction.x + frame.bitangent * l.anisotropy_direction.y);
    const float length = std::sqrt(along.x * along.x + along.y * along.y);
    const bool usable = frame.valid && length > 0.0f;
    l.anisotropy = usable ? l.anisotropy : 0.0f;  // no direction
    if (usable) l.anisotropy_direction = {along.x / length, along.y / length};
  }
  l.coat_has_normal = data.coat_has_normal;
  if (data.coat_has_normal) {
    Vec3 coat = ns;
    if (data.clearcoat_normal_texture.used()) {
      coat = mapped_normal(scene, mesh, data.clearcoat_normal_texture, data.clearcoat_normal_scale, instance, t, g, uv,
                           footprint_area, ns);
    }
    l.coat_normal = shading.to_local(coat * side);
  }
  return l;
}

/// Radiance emitted at `cos_front` to the geometric normal.
RELUME_HD_INLINE Rgb emission_at(const SceneView& scene, const MaterialData& material, const Uv& uv, float cos_front) {
  // Unfiltered, as in light sampling: both strategies must weight the same function.
  Rgb emission = material.emission;
  if (material.emission_texture.used()) emission *= Rgb(fetch_unfiltered(scene, material.emission_texture, uv));
  if (material.clearcoat > 0.0f) {
    const float share =
        material.clearcoat_texture.used() ? fetch_unfiltered(scene, material.clearcoat_texture, uv).x : 1.0f;
    emission *= emission_below_coat(material.clearcoat * share, cos_front);
  }
  return emission;
}

/// Shading normal bent to keep the viewer above its horizon, which interpolation and normal maps can violate.
RELUME_HD inline Vec3 visible_shading_normal(const Vec3& ns, const Vec3& ng, const Vec3& wo) {
  const float cos_o = glm::dot(ns, wo);
  if (cos_o >= kMinShadingCosine) return ns;
  const Vec3 bent = glm::normalize(ns + (2.0f * kMinShadingCosine - cos_o) * wo);
  return glm::dot(bent, ng) > 0.0f && glm::dot(bent, wo) > 0.0f ? bent : ng;
}

/// make_surface_point() for the triangle of the hit, `t`.
template <typename Triangle>
RELUME_HD_INLINE void make_point_on(const SceneView& scene, const Instance& instance, const Triangle& t, const Ray& ray,
                                    const Hit& hit, float cone_width, SurfacePoint& sp, float wavelength_nm) {
  const MeshView& mesh = scene.meshes[instance.mesh];
  const MaterialData& outer = scene.materials[mesh.material];  // a mixture, or the material itself
  const Geometry g = geometry_at(scene, mesh, instance, t);

  sp.position = copy_of(g.position);
  sp.position_error = g.error;
  sp.previous_position = copy_of(g.previous_position);
  sp.wo = -ray.direction;
  sp.barycentric = {hit.u, hit.v};
  sp.footprint = cone_width;
  sp.time = ray.time;
  sp.instance = hit.instance;
  sp.primitive = hit.primitive;
  sp.light = kNoLight;

  const float twice_area = glm::length(g.front);
  const Vec3 front = twice_area > 0.0f ? g.front / twice_area : sp.wo;
  const float cos_front = glm::dot(front, sp.wo);
  sp.front_face = cos_front >= 0.0f;
  const float side = sp.front_face ? 1.0f : -1.0f;
  sp.ng = front * side;

  const float footprint_area = sqr(cone_width) / relume::max(std::fabs(cos_front), 0.05f);
  const Uv uv = outer.uses_uv ? uv_at(scene, mesh, t, twice_area) : Uv{};
  const MixturePart part = part_at(scene, mesh.material, hit, uv);
  sp.material = part.material;
  const MaterialData& material = scene.materials[part.material];
  sp.ns = shading_normal(scene, mesh, scene.materials[part.mapped], instance, t, g, uv, footprint_area, front) * side;
  sp.frame = make_frame(visible_shading_normal(sp.ns, sp.ng, sp.wo));
  sp.wo_local = sp.frame.to_local(sp.wo);

  MaterialSample parameters = sample_material(
      material, wavelength_nm, [&](const TextureUse& use) { return fetch(scene, use, uv, footprint_area); });
  if (mesh.has_colors) {
    const uint32_t first = mesh.first_color;
    parameters.base_color *= Rgb(interpolate(scene.colors[first + t.index.x], scene.colors[first + t.index.y],
                                             scene.colors[first + t.index.z], t.weights));
  }
  sp.emission = Rgb(0);
  if (outer.unlit) {
    sp.emission = parameters.base_color;
    clear(sp.bsdf);
    return;
  }
  if (outer.emissive() && (sp.front_face || outer.double_sided)) {
    sp.emission = emission_at(scene, outer, uv, cos_front);
    if (instance.first_light != kNoLight) sp.light = light_of(instance, hit.primitive);
  }
  if (material.layers >= 0) {
    const LayerSample layers =
        layers_at(scene, mesh, material, instance, t, g, uv, footprint_area, front, side, sp.frame);
    make_layered_bsdf(sp.bsdf, parameters, layers, material, scene.energy_tables, sp.wo_local.z, sp.front_face);
    return;
  }
  make_bsdf(sp.bsdf, parameters, material, scene.energy_tables, sp.wo_local.z, sp.front_face);
}

}  // namespace surface_detail

RELUME_HD inline void make_surface_point(const SceneView& scene, const Instance& instance, const Ray& ray,
                                         const Hit& hit, float cone_width, SurfacePoint& sp, float wavelength_nm) {
  const surface_detail::TriangleAt t =
      surface_detail::triangle_at(scene, scene.meshes[instance.mesh], hit.primitive, hit.u, hit.v);
  surface_detail::make_point_on(scene, instance, t, ray, hit, cone_width, sp, wavelength_nm);
}

RELUME_HD inline SurfacePosition surface_position(const SceneView& scene, const Hit& hit) {
  using namespace surface_detail;
  const Instance& instance = scene.instances[hit.instance];
  const MeshView& mesh = scene.meshes[instance.mesh];
  const TriangleAt t = triangle_at(scene, mesh, hit.primitive, hit.u, hit.v);
  const Geometry g = geometry_at(scene, mesh, instance, t);
  return {g.position, g.previous_position};
}

RELUME_HD inline Mat3 previous_to_current(const SceneView& scene, const Hit& hit) {
  const Instance& instance = scene.instances[hit.instance];
  const MeshView& mesh = scene.meshes[instance.mesh];
  Mat3 turn(1);
  if (mesh.deforms) {
    const surface_detail::TriangleAt t = surface_detail::triangle_at(scene, mesh, hit.primitive, hit.u, hit.v);
    const uint32_t first = mesh.first_previous;
    const Mat3 now = surface_detail::triangle_axes(t.v[0]->position, t.v[1]->position, t.v[2]->position);
    const Mat3 before = surface_detail::triangle_axes(scene.previous_positions[first + t.index.x],
                                                      scene.previous_positions[first + t.index.y],
                                                      scene.previous_positions[first + t.index.z]);
    if (now != before && glm::determinant(before) != 0.0f) turn = now * glm::inverse(before);
  }
  if (instance.to_world.linear == instance.previous_to_world.linear) return turn;
  return instance.to_world.linear * turn * glm::inverse(instance.previous_to_world.linear);
}

}  // namespace relume

#include "scene/moved_surface_point.h"
#include "scene/opacity.h"
