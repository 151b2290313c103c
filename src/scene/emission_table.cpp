#include "scene/emission_table.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/activity.h"
#include "core/parallel.h"
#include "scene/emission_mask.h"

namespace relume {
namespace {

/// Extent of a triangle in texels of the textures that modulate it.
struct TexelExtent {
  float area = 1;
  float longest_edge = 1;
};

TexelExtent texel_extent(const TexturedEmission& e, const TexturedTriangle& t) {
  TexelExtent extent;
  const auto count = [&](int32_t texture, const Vec2 uv[3]) {
    if (texture < 0) return;
    const TextureRecord& record = e.textures.records[static_cast<uint32_t>(texture)];
    const Vec2 size(static_cast<float>(record.width), static_cast<float>(record.height));
    const Vec2 d1 = (uv[1] - uv[0]) * size;
    const Vec2 d2 = (uv[2] - uv[0]) * size;
    extent.area = relume::max(0.5f * std::fabs(d1.x * d2.y - d1.y * d2.x), extent.area);
    for (const Vec2& edge : {d1, d2, d2 - d1})
      extent.longest_edge = relume::max(glm::length(edge), extent.longest_edge);
  };
  count(t.emission_texture, t.emission_uv);
  count(t.opacity_texture, t.opacity_uv);
  return extent;
}

/// Number of subdivisions per edge of a textured triangle: small triangles are about one texel large, within bounds.
uint32_t grid_size(const TexelExtent& extent) {
  constexpr float kMaxGrid = 256;
  return static_cast<uint32_t>(clamp(std::ceil(std::sqrt(2.0f * extent.area)), 1.0f, kMaxGrid));
}

/// Look-ups along a side of a small triangle: two per texel, so that none is missed. Falls back to few points if that
/// is too many.
struct Probing {
  int points = 4;
  bool sees_all = true;

  Probing(const TexelExtent& extent, uint32_t grid) {
    constexpr float kMostPoints = 32;
    const float wanted = std::ceil(2.0f * extent.longest_edge / static_cast<float>(grid));
    sees_all = wanted <= kMostPoints;
    if (sees_all) points = std::max(points, static_cast<int>(wanted));
  }
};

/// Mean of the texture over one small triangle.
Rgb mean_emission(const TexturedEmission& e, const TexturedTriangle& t, uint32_t index, int points) {
  const auto n = static_cast<float>(points);
  Rgb sum(0);
  for (int i = 0; i < points; ++i) {
    for (int j = 0; j < points; ++j) {
      const Vec2 u((static_cast<float>(i) + 0.5f) / n, (static_cast<float>(j) + 0.5f) / n);
      sum += textured_emission(e, t, barycentric_in_small_triangle(t.grid, index, triangle_from_square(u)));
    }
  }
  return sum / (n * n);
}

/// Gives every small triangle a minimum weight, because bright texels may have been missed.
void leave_none_out(std::vector<float>& weights, Rgb& mean) {
  constexpr float kLeastShare = 0.01f;  // of the mean weight
  constexpr float kLeastMean = 1e-3f;   // of the material's emission, if all look-ups are black
  double sum = 0;
  for (const float w : weights) sum += w;
  const auto least = static_cast<float>(kLeastShare * sum / static_cast<double>(weights.size()));
  for (float& w : weights) w = sum > 0 ? std::max(w, least) : 1.0f;
  if (!(sum > 0)) mean = Rgb(kLeastMean);
}

void transformed_uvs(const SceneView& scene, const MeshView& mesh, const UVec3& index, const TextureUse& use,
                     Vec2 uv[3]) {
  for (int k = 0; k < 3; ++k) {
    const uint32_t v = index[k];
    Vec2 raw(0);
    if (use.uv_set == 1 && mesh.has_uv1) raw = scene.uv1[mesh.first_uv1 + v];
    if (use.uv_set == 0 && mesh.has_uv) raw = scene.vertices[v].uv;
    uv[k] = use.transform(raw);
  }
}

/// A table before its size is determined.
struct Draft {
  TexturedTriangle triangle{};
  Rgb emission{0};  ///< of the material
  TexelExtent extent;
  bool emits = false;
  float weight = 0;       ///< mean luminance times area in texels, for textures that share entries
  bool filtered = false;  ///< the weights of the table come from mip levels

  bool can_share() const { return emits && triangle.emission_texture >= 0; }
};

Draft draft_of(const SceneView& geometry, const EmissiveTriangle& source,
               const std::map<int32_t, EmissionMask>& masks) {
  const MeshView& mesh = *source.mesh;
  const MaterialData& material = geometry.materials[mesh.material];
  const UVec3 index = geometry.triangles[mesh.first_triangle + source.primitive];
  Draft draft;
  draft.emission = material.emission;
  TexturedTriangle& t = draft.triangle;
  t.emission_texture = material.emission_texture.texture;
  transformed_uvs(geometry, mesh, index, material.emission_texture, t.emission_uv);
  if (t.emission_texture >= 0 && !masks.at(t.emission_texture).may_emit(t.emission_uv)) return draft;
  draft.emits = true;
  t.opacity_texture = material.has_alpha() ? material.base_color_texture.texture : -1;
  transformed_uvs(geometry, mesh, index, material.base_color_texture, t.opacity_uv);
  for (int k = 0; k < 3; ++k) {
    const float vertex_alpha = mesh.has_colors ? geometry.colors[mesh.first_color + index[k]].w : 1.0f;
    t.alpha_factor[k] = material.has_alpha() ? material.alpha * vertex_alpha : 1.0f;
  }
  t.coat_texture = material.clearcoat > 0.0f ? material.clearcoat_texture.texture : -1;
  transformed_uvs(geometry, mesh, index, material.clearcoat_texture, t.coat_uv);
  t.alpha_cutoff = material.alpha_cutoff;
  t.mask = material.mask;
  draft.extent = texel_extent({{}, {}, geometry.textures}, t);
  t.grid = grid_size(draft.extent);
  return draft;
}

/// Alpha of the texture at a point, from a mip level. A mask uses its coverage without the cutoff, because filtered
/// alpha does not locate it well enough.
float filtered_opacity(const TexturedEmission& e, const TexturedTriangle& t, const Vec2& b, int level) {
  if (t.opacity_texture < 0) return 1;
  const TextureSampler texture = e.textures[static_cast<uint32_t>(t.opacity_texture)];
  const float alpha =
      texture.sample_level(interpolate_corners(t.opacity_uv, b), std::min(level, texture.record().level_count - 1)).w;
  return saturate(alpha * interpolate_corners(t.alpha_factor, b));
}

/// Approximate mean_emission(), from the mip level whose texel size matches the spacing of the points.
Rgb filtered_emission(const TexturedEmission& e, const TexturedTriangle& t, uint32_t index, float longest_edge) {
  constexpr int kPoints = 3;
  const TextureSampler texture = e.textures[static_cast<uint32_t>(t.emission_texture)];
  const float spacing = longest_edge / static_cast<float>(t.grid * kPoints);
  const int level =
      std::clamp(static_cast<int>(std::log2(std::max(spacing, 1.0f))), 0, texture.record().level_count - 1);
  Rgb sum(0);
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      const Vec2 u((static_cast<float>(i) + 0.5f) / kPoints, (static_cast<float>(j) + 0.5f) / kPoints);
      const Vec2 b = barycentric_in_small_triangle(t.grid, index, triangle_from_square(u));
      sum += Rgb(texture.sample_level(interpolate_corners(t.emission_uv, b), level)) * filtered_opacity(e, t, b, level);
    }
  }
  return sum / static_cast<float>(kPoints * kPoints);
}

/// Total demand of the triangles of one texture.
struct Demand {
  double entries = 0;
  double weight = 0;
};

/// Limits the entries of textures that need too many: entries are proportional to mean luminance times area in texels.
void share_entries(const TexturedEmission& context, std::vector<Draft>& drafts) {
  std::map<int32_t, Demand> demands;
  for (const Draft& draft : drafts) {
    if (draft.can_share())
      demands[draft.triangle.emission_texture].entries += double{1} * draft.triangle.grid * draft.triangle.grid;
  }
  const auto is_short = [&](const Draft& draft) {
    return draft.can_share() && demands.at(draft.triangle.emission_texture).entries > kMostEmissionEntries;
  };
  parallel_for(drafts.size(), [&](size_t i) {
    if (!is_short(drafts[i])) return;
    TexturedTriangle whole = drafts[i].triangle;
    whole.grid = 1;
    const Rgb mean = filtered_emission(context, whole, 0, drafts[i].extent.longest_edge);
    drafts[i].weight = luminance(drafts[i].emission * mean) * drafts[i].extent.area;
  });
  for (const Draft& draft : drafts) {
    if (is_short(draft)) demands.at(draft.triangle.emission_texture).weight += static_cast<double>(draft.weight);
  }
  for (Draft& draft : drafts) {
    if (!is_short(draft)) continue;
    const double total = demands.at(draft.triangle.emission_texture).weight;
    const double entries = total > 0 ? kMostEmissionEntries * (static_cast<double>(draft.weight) / total) : 0;
    const auto grid = static_cast<uint32_t>(std::sqrt(std::max(entries, 1.0)));
    draft.filtered = grid < draft.triangle.grid;
    draft.triangle.grid = std::min(grid, draft.triangle.grid);
  }
}

EmissionTable table_of(const TexturedEmission& context, const Draft& draft) {
  EmissionTable result{draft.triangle, {}};
  if (!draft.emits) return result;
  TexturedTriangle& t = result.triangle;
  const Probing probing(draft.extent, t.grid);
  const uint32_t count = t.grid * t.grid;
  std::vector<Rgb> means(count);
  parallel_for(count, [&](uint32_t i) {
    means[i] = draft.filtered ? filtered_emission(context, t, i, draft.extent.longest_edge)
                              : mean_emission(context, t, i, probing.points);
  });
  std::vector<float> weights(count);
  Rgb sum(0);
  for (uint32_t i = 0; i < count; ++i) {
    weights[i] = luminance(draft.emission * means[i]);
    sum += means[i];
  }
  t.mean_emission = sum / static_cast<float>(count);
  if (draft.filtered || !probing.sees_all) leave_none_out(weights, t.mean_emission);
  result.entries = build_alias_table(weights);
  return result;
}

}  // namespace

bool has_textured_emission(const MaterialData& material) {
  const bool textured_coat = material.clearcoat > 0.0f && material.clearcoat_texture.used();
  return material.emissive() && (material.emission_texture.used() || material.has_alpha() || textured_coat);
}

std::vector<EmissionTable> make_emission_tables(const SceneView& geometry,
                                                std::span<const EmissiveTriangle> triangles) {
  if (triangles.empty()) return {};
  Activity activity("measuring emissive textures", triangles.size());
  std::map<int32_t, EmissionMask> masks;
  for (const EmissiveTriangle& triangle : triangles) {
    const int32_t texture = geometry.materials[triangle.mesh->material].emission_texture.texture;
    if (texture >= 0 && !masks.contains(texture))
      masks.try_emplace(texture, geometry.textures[static_cast<uint32_t>(texture)]);
  }
  std::vector<Draft> drafts(triangles.size());
  parallel_for(triangles.size(), [&](size_t i) { drafts[i] = draft_of(geometry, triangles[i], masks); });
  const TexturedEmission context{{}, {}, geometry.textures};
  share_entries(context, drafts);
  std::vector<EmissionTable> tables(triangles.size());
  parallel_for(triangles.size(), [&](size_t i) {
    tables[i] = table_of(context, drafts[i]);
    activity.part_done();
  });
  return tables;
}

}  // namespace relume
