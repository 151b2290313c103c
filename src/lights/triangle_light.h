// Emissive triangles, and parallelograms of two triangles. They are sampled uniformly in solid angle where they look
// large, else uniformly in area; with a texture, in proportion to the emission.
#pragma once

#include <cmath>

#include "core/view.h"
#include "lights/light_types.h"
#include "lights/solid_angle.h"
#include "materials/material.h"
#include "sampling/alias_table.h"

namespace relume {

struct TriangleLight {
  Vec3 v0;
  Vec3 e1;       ///< v1 − v0
  Vec3 e2;       ///< v2 − v0
  Vec3 normal;   ///< unit, of the front
  float area;    ///< m²
  float width2;  ///< squared length of the longest edge or diagonal, m²
  float error;   ///< bound on the rounding error of hits on it, metres
  Rgb radiance;  ///< emission below the coat where the texture is white
  float coat;    ///< weight of the clearcoat where its texture is white
  uint32_t instance;
  uint32_t primitive;  ///< a parallelogram: the first of two
  int32_t textured;    ///< index into TexturedEmission::triangles, or −1; never for a parallelogram
  bool two_sided;
  bool is_parallelogram;  ///< with the corner v0 + e1 + e2; barycentrics then lie in the unit square

  RELUME_HD Vec3 position(const Vec2& b) const { return v0 + b.x * e1 + b.y * e2; }
  RELUME_HD Vec2 centre() const { return Vec2(is_parallelogram ? 0.5f : 1.0f / 3.0f); }
  /// Cosine at the light towards a receiver; 0 on the side without emission.
  RELUME_HD float emission_cosine(const Vec3& away) const {
    const float c = glm::dot(normal, away);
    return two_sided ? std::fabs(c) : relume::max(c, 0.0f);
  }
};

/// TriangleLight::width2.
RELUME_HD inline float width_squared(const TriangleLight& light) {
  const float sides = relume::max(length_squared(light.e1), length_squared(light.e2));
  const float diagonal = length_squared(light.e1 - light.e2);
  return relume::max(sides,
                     light.is_parallelogram ? relume::max(diagonal, length_squared(light.e1 + light.e2)) : diagonal);
}

/// Corners of an emissive triangle at one key of the shutter.
struct LightKey {
  Vec3 v0;
  Vec3 e1;
  Vec3 e2;
};

/// Sets v0, e1 and e2, and what depends on them. `orientation`: −1 if the instance mirrors.
RELUME_HD inline void set_corners(TriangleLight& light, const LightKey& key, float orientation) {
  light.v0 = key.v0;
  light.e1 = key.e1;
  light.e2 = key.e2;
  const Vec3 cross = glm::cross(light.e1, light.e2) * orientation;
  const float length = glm::length(cross);
  light.normal = length > 0.0f ? cross / length : Vec3(0);
  light.area = light.is_parallelogram ? length : 0.5f * length;
  light.width2 = width_squared(light);
}

/// A light between two keys of the shutter. Its corners move along straight lines, as those of its surface.
RELUME_HD inline TriangleLight moved(const TriangleLight& light, const LightKey* keys, uint32_t count, float time) {
  const KeyTime at(time, count);
  const LightKey& a = keys[at.first];
  const LightKey& b = keys[at.first + 1];
  TriangleLight result = light;
  const bool mirrored = glm::dot(glm::cross(light.e1, light.e2), light.normal) < 0.0f;
  set_corners(result, {at.mix(a.v0, b.v0), at.mix(a.e1, b.e1), at.mix(a.e2, b.e2)}, mirrored ? -1.0f : 1.0f);
  return result;
}

/// The textures on one emissive triangle, and a table over its subdivision into grid² equal triangles weighted by mean
/// luminance.
struct TexturedTriangle {
  int32_t emission_texture;  ///< −1: none
  int32_t opacity_texture;   ///< alpha; −1: none
  Vec2 emission_uv[3];
  Vec2 opacity_uv[3];
  float alpha_factor[3];  ///< at the vertices; 1 for opaque materials
  float alpha_cutoff;
  bool mask;
  uint32_t grid;
  uint32_t first_entry;       ///< of grid² entries
  Rgb mean_emission;          ///< mean of the texture, without the light's radiance
  int32_t coat_texture = -1;  ///< weight of the clearcoat, in red; −1: none
  Vec2 coat_uv[3];
};

/// Data shared by all textured emitters.
struct TexturedEmission {
  View<const TexturedTriangle> triangles;
  View<const AliasEntry> entries;
  TexturesView textures;

  RELUME_HD AliasTable table(const TexturedTriangle& t) const {
    return {{entries.data + t.first_entry, t.grid * t.grid}};
  }
};

template <typename T>
RELUME_HD inline T interpolate_corners(const T v[3], const Vec2& b) {
  return v[0] * (1.0f - b.x - b.y) + v[1] * b.x + v[2] * b.y;
}

/// Emission times opacity of the textures at a point.
RELUME_HD inline Rgb textured_emission(const TexturedEmission& e, const TexturedTriangle& t, const Vec2& b) {
  Rgb value(1);
  if (t.emission_texture >= 0) {
    value = Rgb(
        e.textures.sample_level(static_cast<uint32_t>(t.emission_texture), interpolate_corners(t.emission_uv, b), 0));
  }
  float alpha = interpolate_corners(t.alpha_factor, b);
  if (t.opacity_texture >= 0) {
    alpha *=
        e.textures.sample_level(static_cast<uint32_t>(t.opacity_texture), interpolate_corners(t.opacity_uv, b), 0).w;
  }
  value *= t.mask ? (alpha >= t.alpha_cutoff ? 1.0f : 0.0f) : saturate(alpha);
  return value;
}

/// Weight of the clearcoat's texture at a point, relative to TriangleLight::coat.
RELUME_HD inline float textured_coat(const TexturedEmission& e, const TexturedTriangle& t, const Vec2& b) {
  if (t.coat_texture < 0) return 1.0f;
  return e.textures.sample_level(static_cast<uint32_t>(t.coat_texture), interpolate_corners(t.coat_uv, b), 0).x;
}

/// Index of the small triangle at `b`. Numbered row by row; row r has 2(grid − r) − 1, upright and inverted
/// alternately.
RELUME_HD inline uint32_t small_triangle_at(uint32_t grid, const Vec2& b) {
  const float s = b.x * static_cast<float>(grid);
  const float t = b.y * static_cast<float>(grid);
  uint32_t row = t > 0.0f ? static_cast<uint32_t>(t) : 0u;
  if (row >= grid) row = grid - 1;
  uint32_t column = s > 0.0f ? static_cast<uint32_t>(s) : 0u;
  const uint32_t last_column = grid - 1 - row;
  if (column > last_column) column = last_column;
  const bool inverted = (s - static_cast<float>(column)) + (t - static_cast<float>(row)) > 1.0f && column < last_column;
  return row * (2 * grid - row) + 2 * column + (inverted ? 1u : 0u);
}

/// Barycentrics of the whole triangle from those inside small triangle `index`.
RELUME_HD inline Vec2 barycentric_in_small_triangle(uint32_t grid, uint32_t index, const Vec2& inner) {
  uint32_t row = 0;
  uint32_t rest = index;
  // Row r starts at r(2·grid − r). Solves for r by the quadratic formula, then corrects for rounding.
  const float g = static_cast<float>(grid);
  row = static_cast<uint32_t>(g - std::sqrt(relume::max(g * g - static_cast<float>(index), 0.0f)));
  while (row > 0 && row * (2 * grid - row) > index) --row;
  while ((row + 1) * (2 * grid - row - 1) <= index) ++row;
  rest = index - row * (2 * grid - row);
  const uint32_t column = rest / 2;
  const Vec2 corner(static_cast<float>(column), static_cast<float>(row));
  return (rest % 2 == 0 ? corner + inner : corner + Vec2(1) - inner) / g;
}

struct TrianglePoint {
  Vec2 barycentric;
  float pdf_a;
};

RELUME_HD inline TrianglePoint sample_area(const TriangleLight& light, const TexturedEmission& e, const Vec2& u) {
  if (light.textured < 0) return {light.is_parallelogram ? u : triangle_from_square(u), 1.0f / light.area};
  const TexturedTriangle& t = e.triangles[static_cast<uint32_t>(light.textured)];
  const DiscreteSample chosen = e.table(t).sample({u.x, hash(float_bits(u.x), float_bits(u.y))});
  const float count = static_cast<float>(t.grid * t.grid);
  return {barycentric_in_small_triangle(t.grid, chosen.index, triangle_from_square({chosen.u, u.y})),
          chosen.pmf * count / light.area};
}

RELUME_HD inline float pdf_area(const TriangleLight& light, const TexturedEmission& e, const Vec2& b) {
  if (light.textured < 0) return 1.0f / light.area;
  const TexturedTriangle& t = e.triangles[static_cast<uint32_t>(light.textured)];
  const float count = static_cast<float>(t.grid * t.grid);
  return e.table(t).pmf(small_triangle_at(t.grid, b)) * count / light.area;
}

/// Radiance emitted at `b` in a direction with `cos_theta` to the normal.
RELUME_HD inline Rgb emitted_radiance(const TriangleLight& light, const TexturedEmission& e, const Vec2& b,
                                      float cos_theta) {
  Rgb radiance = light.radiance;
  if (light.coat > 0.0f) {
    const float share =
        light.textured < 0 ? 1.0f : textured_coat(e, e.triangles[static_cast<uint32_t>(light.textured)], b);
    radiance *= emission_below_coat(light.coat * share, cos_theta);
  }
  if (light.textured < 0) return radiance;
  return radiance * textured_emission(e, e.triangles[static_cast<uint32_t>(light.textured)], b);
}

/// Lights whose longest edge or diagonal exceeds this fraction of the distance to their centre are sampled by solid
/// angle. For smaller ones, sampling by area is nearly as good, and takes less time.
inline constexpr float kWideTriangle = 0.3f;

/// Closer to the light's plane than this fraction of the longest edge or diagonal, directions are too imprecise, and
/// lights are sampled by area. Rounding errors exceed 1 % below about a seventh of this distance.
inline constexpr float kLeastHeight = 2e-3f;

/// Whether the light at `corner`, v0 relative to the receiver, is sampled uniformly in solid angle. `wide`:
/// kWideTriangle, or infinity for none.
RELUME_HD inline bool is_wide(const TriangleLight& light, const Vec3& corner, float wide) {
  if (light.textured >= 0) return false;
  const Vec3 centre = corner + light.centre().x * (light.e1 + light.e2);
  return light.width2 > wide * wide * length_squared(centre) &&
         sqr(glm::dot(light.normal, corner)) > sqr(kLeastHeight) * light.width2;
}

/// The light with v0 at `corner` from the receiver.
RELUME_HD inline EmitterShape<float> shape_at(const TriangleLight& light, const Vec3& corner) {
  const float cross = light.is_parallelogram ? light.area : 2.0f * light.area;
  return {triple_of<float>(corner), triple_of<float>(light.e1), triple_of<float>(light.e2),
          cross * std::fabs(glm::dot(light.normal, corner)), light.is_parallelogram};
}

/// Light that arrives at `p` from a point of the light, whose density is `pdf` per m², or per steradian
/// (`by_solid_angle`).
RELUME_HD inline LightSample light_from(const TriangleLight& light, const TexturedEmission& e, const Vec3& p,
                                        const Vec2& barycentric, float pdf, bool by_solid_angle) {
  LightSample s;
  s.barycentric = barycentric;
  s.position = light.position(barycentric);
  const Vec3 d = s.position - p;
  const float distance_squared = length_squared(d);
  s.distance = std::sqrt(distance_squared);
  s.wi = d / s.distance;
  const float cos_light = light.emission_cosine(-s.wi);
  if (!(cos_light > 0.0f)) return s;
  s.pdf_w = by_solid_angle ? pdf : pdf_w_from_pdf_a(pdf, distance_squared, cos_light);
  s.clearance = light.error / cos_light;
  s.radiance = emitted_radiance(light, e, barycentric, cos_light);
  s.normal = light.normal;
  return s;
}

RELUME_HD inline LightSample sample_li(const TriangleLight& light, const TexturedEmission& e, const Vec3& p,
                                       const Vec2& u, float wide) {
  const Vec3 corner = light.v0 - p;
  if (!(light.emission_cosine(-corner) > 0.0f)) return {};
  if (!is_wide(light, corner, wide)) {
    const TrianglePoint point = sample_area(light, e, u);
    return light_from(light, e, p, point.barycentric, point.pdf_a, false);
  }
  Vec2 barycentric;
  const float pdf_w = sample_solid_angle(shape_at(light, corner), u.x, u.y, barycentric.x, barycentric.y);
  return light_from(light, e, p, barycentric, pdf_w, true);
}

RELUME_HD inline float pdf_li(const TriangleLight& light, const TexturedEmission& e, const Vec3& p, const Vec3& wi,
                              const EmitterPoint& on_light, float wide) {
  const float cos_light = light.emission_cosine(-wi);
  if (!(cos_light > 0.0f)) return 0.0f;
  const Vec3 corner = light.v0 - p;
  if (is_wide(light, corner, wide)) return pdf_solid_angle(shape_at(light, corner));
  return pdf_w_from_pdf_a(pdf_area(light, e, on_light.barycentric), length_squared(on_light.position - p), cos_light);
}

/// Samples an emitted ray. Two-sided triangles choose a side with the direction's first number.
RELUME_HD inline EmissionSample sample_le(const TriangleLight& light, const TexturedEmission& e, const Vec2& u_position,
                                          Vec2 u_direction) {
  const TrianglePoint point = sample_area(light, e, u_position);
  Vec3 normal = light.normal;
  if (light.two_sided) {
    const bool back = u_direction.x >= 0.5f;
    u_direction.x = clamp(2.0f * u_direction.x - (back ? 1.0f : 0.0f), 0.0f, kOneMinusEpsilon);
    if (back) normal = -normal;
  }
  const Vec3 local = cosine_hemisphere_from_square(u_direction);
  EmissionSample s;
  s.origin = light.position(point.barycentric);
  s.error = light.error;
  s.direction = make_frame(normal).to_world(local);
  s.normal = normal;
  s.le = emitted_radiance(light, e, point.barycentric, local.z);
  s.pdf_a = point.pdf_a;
  s.pdf_w = cosine_hemisphere_pdf(local.z) * (light.two_sided ? 0.5f : 1.0f);
  s.cos_theta = local.z;
  return s;
}

RELUME_HD inline EmissionPdf pdf_le(const TriangleLight& light, const TexturedEmission& e, const EmitterPoint& on_light,
                                    const Vec3& direction) {
  const float pdf_w = cosine_hemisphere_pdf(light.emission_cosine(direction)) * (light.two_sided ? 0.5f : 1.0f);
  return {pdf_area(light, e, on_light.barycentric), pdf_w};
}

/// Emitted power, watts; treats a coat's texture as white.
RELUME_HD inline Rgb power(const TriangleLight& light, const TexturedEmission& e) {
  const Rgb mean = light.textured < 0 ? Rgb(1) : e.triangles[static_cast<uint32_t>(light.textured)].mean_emission;
  const float below_coat = 1.0f - light.coat * (0.04f + 0.96f / 21.0f);  // the mean of emission_below_coat()
  return light.radiance * mean * (below_coat * kPi * light.area * (light.two_sided ? 2.0f : 1.0f));
}

inline LightExtent extent_of(const TriangleLight& light, double watts) {
  LightExtent extent{{}, light.normal, 0, M_PI / 2, light.two_sided, watts / (light.two_sided ? 2 * M_PI : M_PI)};
  for (const Vec3& p : {light.v0, light.v0 + light.e1, light.v0 + light.e2}) extent.box.add(p);
  if (light.is_parallelogram) extent.box.add(light.position(Vec2(1)));
  return extent;
}

/// Whether two lights have the same geometry and emission.
inline bool same_light(const TriangleLight& a, const TriangleLight& b) {
  return a.v0 == b.v0 && a.e1 == b.e1 && a.e2 == b.e2 && a.normal == b.normal && a.radiance == b.radiance &&
         a.two_sided == b.two_sided && a.coat == b.coat && a.textured == b.textured &&
         a.is_parallelogram == b.is_parallelogram;
}

}  // namespace relume
