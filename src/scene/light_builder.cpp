#include "scene/light_builder.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.h"
#include "scene/emission_mask.h"
#include "scene/light_parameters.h"
#include "scene/placement.h"
#include "scene/studio.h"
#include "scene/sun_sky.h"
#include "scene/surface_point.h"

namespace relume {
namespace {

/// TriangleLight::error: the largest of the vertices'.
float triangle_error(const SceneView& geometry, const UVec3& index, const Instance& instance) {
  float largest = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3& p = geometry.vertices[index[k]].position;
    const float error = gamma_bound(7) * max_component(abs(p));
    largest =
        std::max(largest, instance.in_world_space ? error : surface_detail::world_error(instance.to_world, p, error));
  }
  return largest;
}

/// Extent of a triangle in the texels of the textures that modulate it.
struct TexelExtent {
  float area = 1;
  float longest_edge = 1;
};

TexelExtent texel_extent(const TexturedEmission& e, const TexturedTriangle& t) {
  TexelExtent extent;
  const auto count = [&](int32_t texture, const Vec2 uv[3]) {
    if (texture < 0) return;
    const TextureView& view = e.textures[static_cast<uint32_t>(texture)];
    const Vec2 size(static_cast<float>(view.width), static_cast<float>(view.height));
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

/// Edge of the subdivision of a textured triangle that is about one texel, within bounds.
uint32_t grid_size(const TexelExtent& extent) {
  constexpr float kMaxGrid = 256;
  return static_cast<uint32_t>(clamp(std::ceil(std::sqrt(2.0f * extent.area)), 1.0f, kMaxGrid));
}

/// Points along a side of a small triangle at which the texture is looked up: two a texel, so that none is missed. If
/// those are too many, a few have to do.
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

/// Where bright texels may have been missed, every small triangle gets some samples.
void leave_none_out(std::vector<float>& weights, Rgb& mean) {
  constexpr float kLeastShare = 0.01f;  // of the mean weight
  constexpr float kLeastMean = 1e-3f;   // of the material's emission, if nothing at all was found
  double sum = 0;
  for (const float w : weights) sum += w;
  const auto least = static_cast<float>(kLeastShare * sum / static_cast<double>(weights.size()));
  for (float& w : weights) w = sum > 0 ? std::max(w, least) : 1.0f;
  if (!(sum > 0)) mean = Rgb(kLeastMean);
}

/// A punctual light of a node.
Light punctual_light(PunctualLight source, const Mat4& to_world) {
  const Vec3 position(to_world[3]);
  Vec3 axis = -direction_of(Vec3(to_world[2]));
  if (axis == Vec3(0) && type_of(source).has_direction) {  // collapsed: it keeps its place in the list, dark
    source.intensity = Rgb(0);
    axis = Vec3(0, 0, -1);
  }
  switch (source.type) {
    case PunctualType::point: return Light::of(PointLight{position, source.intensity});
    case PunctualType::spot:
      return Light::of(SpotLight{position, axis, source.intensity, std::cos(source.inner_cone_rad),
                                 std::cos(source.outer_cone_rad)});
    case PunctualType::directional: {
      const float half = 0.5f * source.angular_diameter_rad;
      return Light::of(DirectionalLight{-axis, source.intensity, 2.0f * sqr(std::sin(0.5f * half))});
    }
  }
  return {};
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

bool has_textured_emission(const MaterialData& material) {
  return material.emissive() && (material.emission_texture.used() || material.has_alpha());
}

/// A triangle and its sampling table; no entries: it emits nothing.
struct TexturedTable {
  TexturedTriangle triangle{};
  std::vector<AliasEntry> entries;
};

TexturedTable textured_table(const SceneView& geometry, const MeshView& mesh, uint32_t primitive,
                             const std::map<int32_t, EmissionMask>& masks) {
  const MaterialData& material = geometry.materials[mesh.material];
  const UVec3 index = geometry.triangles[mesh.first_triangle + primitive];
  TexturedTable result;
  TexturedTriangle& t = result.triangle;
  t.emission_texture = material.emission_texture.texture;
  transformed_uvs(geometry, mesh, index, material.emission_texture, t.emission_uv);
  if (t.emission_texture >= 0 && !masks.at(t.emission_texture).may_emit(t.emission_uv)) return result;
  t.opacity_texture = material.has_alpha() ? material.base_color_texture.texture : -1;
  transformed_uvs(geometry, mesh, index, material.base_color_texture, t.opacity_uv);
  for (int k = 0; k < 3; ++k) {
    const float vertex_alpha = mesh.has_colors ? geometry.colors[mesh.first_color + index[k]].w : 1.0f;
    t.alpha_factor[k] = material.has_alpha() ? material.alpha * vertex_alpha : 1.0f;
  }
  t.alpha_cutoff = material.alpha_cutoff;
  t.mask = material.mask;
  const TexturedEmission context{{}, {}, geometry.textures};
  const TexelExtent extent = texel_extent(context, t);
  t.grid = grid_size(extent);
  const Probing probing(extent, t.grid);

  const uint32_t count = t.grid * t.grid;
  std::vector<Rgb> means(count);
  parallel_for(count, [&](uint32_t i) { means[i] = mean_emission(context, t, i, probing.points); });
  std::vector<float> weights(count);
  Rgb sum(0);
  for (uint32_t i = 0; i < count; ++i) {
    weights[i] = luminance(material.emission * means[i]);
    sum += means[i];
  }
  t.mean_emission = sum / static_cast<float>(count);
  if (!probing.sees_all) leave_none_out(weights, t.mean_emission);
  result.entries = build_alias_table(weights);
  return result;
}

}  // namespace

void LightBuilder::set_environment(const Environment& source) {
  Environment baked = source;
  environment_changed_ = true;
  has_sun_ = false;
  if (source.kind == EnvironmentKind::sun_sky) {
    const SunSkyModel model = make_sun_sky(source.sun_sky);
    baked.map = model.sky;
    baked.width = model.width;
    baked.height = model.height;
    sun_ = model.sun;
    sun_.irradiance *= source.color;
    has_sun_ = !is_black(sun_.irradiance);
  }
  if (source.kind == EnvironmentKind::studio) {
    EnvironmentMap studio = make_studio();
    baked.map = std::move(studio.texels);
    baked.width = studio.width;
    baked.height = studio.height;
  }
  environment_ = {};
  if (source.kind == EnvironmentKind::none || source.kind == EnvironmentKind::automatic) return;
  environment_.scale = baked.color;
  environment_.mean = baked.color;
  environment_.cos_rotation = std::cos(source.rotation_rad);
  environment_.sin_rotation = std::sin(source.rotation_rad);
  sun_.to_light = environment_.direction_from_map(sun_.to_light);
  if (source.kind == EnvironmentKind::constant) return;

  environment_map_ = std::move(baked.map);
  environment_.map = view_of(environment_map_);
  environment_.width = static_cast<uint32_t>(baked.width);
  environment_.height = static_cast<uint32_t>(baked.height);
  build_environment_distribution();
}

void LightBuilder::build_environment_distribution() {
  const int w = static_cast<int>(environment_.width);
  const int h = static_cast<int>(environment_.height);
  // A texel's weight is the mean over it of the bilinear interpolation, (1 6 1)/8 along each axis, times its solid
  // angle.
  std::vector<float> weights(environment_map_.size());
  const auto at = [&](int x, int y) {
    return environment_map_[static_cast<size_t>(std::clamp(y, 0, h - 1)) * static_cast<size_t>(w) +
                            static_cast<size_t>((x + w) % w)];
  };
  Rgb sum(0);
  double solid_angle = 0;
  std::vector<Rgb> row_sums(static_cast<size_t>(h), Rgb(0));
  parallel_for(h, [&](int y) {
    const float sin_theta = std::sin((static_cast<float>(y) + 0.5f) / static_cast<float>(h) * kPi);
    for (int x = 0; x < w; ++x) {
      Rgb mean(0);
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) mean += at(x + dx, y + dy) * ((dx ? 0.125f : 0.75f) * (dy ? 0.125f : 0.75f));
      }
      weights[static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x)] =
          luminance(environment_.scale * mean) * sin_theta;
      row_sums[static_cast<size_t>(y)] += mean * sin_theta;
    }
  });
  for (int y = 0; y < h; ++y) {
    sum += row_sums[static_cast<size_t>(y)];
    solid_angle += std::sin((y + 0.5) / h * static_cast<double>(kPi)) * w;
  }
  environment_.mean = environment_.scale * sum / static_cast<float>(solid_angle);
  environment_distribution_ = build_distribution_2d(weights, environment_.width, environment_.height);
  environment_.distribution = environment_distribution_.view();
}

void LightBuilder::collect(const SceneView& geometry, std::vector<Instance>& instances, const Scene& scene,
                           const PlacedNodes& nodes, const SceneBounds& bounds) {
  lights_.clear();
  bounds_ = bounds;
  textures_ = geometry.textures;
  add_textured(geometry, instances);
  for (uint32_t i = 0; i < instances.size(); ++i) add_triangles(geometry, i, instances[i]);
  add_punctual_lights(scene, nodes, false);
  first_infinite_ = static_cast<uint32_t>(lights_.size());
  add_punctual_lights(scene, nodes, true);
  if (has_sun_) lights_.push_back(Light::of(sun_));
  if (!environment_.black()) lights_.emplace_back();
  mark_changes();
}

void LightBuilder::add_triangles(const SceneView& geometry, uint32_t instance_index, Instance& instance) {
  const MeshView& mesh = geometry.meshes[instance.mesh];
  const MaterialData& material = geometry.materials[mesh.material];
  instance.first_light = kNoLight;
  if (!material.emissive()) return;
  instance.first_light = static_cast<LightId>(lights_.size());
  for (uint32_t k = 0; k < mesh.triangle_count; ++k) {
    const UVec3 index = geometry.triangles[mesh.first_triangle + k];
    const auto position = [&](uint32_t v) {
      const Vec3& p = geometry.vertices[v].position;
      return instance.in_world_space ? p : instance.to_world.point(p);
    };
    TriangleLight light{};
    light.v0 = position(index.x);
    light.e1 = position(index.y) - light.v0;
    light.e2 = position(index.z) - light.v0;
    const Vec3 cross = glm::cross(light.e1, light.e2) * instance.orientation;
    const float twice_area = glm::length(cross);
    light.normal = twice_area > 0.0f ? cross / twice_area : Vec3(0);
    light.area = 0.5f * twice_area;
    light.radiance = light.area > 0.0f && instance.visible ? material.emission : Rgb(0);
    light.instance = instance_index;
    light.primitive = k;
    light.textured = -1;
    light.two_sided = material.double_sided;
    light.error = triangle_error(geometry, index, instance);
    if (light.area > 0.0f && has_textured_emission(material)) {
      light.textured = textured_indices_.at(mesh.first_triangle + k);
      if (light.textured == kBlackTexture) light.radiance = Rgb(0);
    }
    lights_.push_back(Light::of(light));
  }
}

void LightBuilder::add_textured(const SceneView& geometry, const std::vector<Instance>& instances) {
  struct Missing {
    const MeshView* mesh;
    uint32_t primitive;
  };
  std::vector<Missing> missing;
  std::map<int32_t, EmissionMask> masks;
  for (const Instance& instance : instances) {
    const MeshView& mesh = geometry.meshes[instance.mesh];
    const MaterialData& material = geometry.materials[mesh.material];
    if (!has_textured_emission(material)) continue;
    const size_t known = missing.size();
    for (uint32_t k = 0; k < mesh.triangle_count; ++k) {
      const bool is_new = textured_indices_.try_emplace(mesh.first_triangle + k, kBlackTexture).second;
      if (is_new) missing.push_back({&mesh, k});
    }
    const int32_t texture = material.emission_texture.texture;
    if (missing.size() > known && texture >= 0 && !masks.contains(texture))
      masks.try_emplace(texture, textures_[static_cast<uint32_t>(texture)]);
  }
  std::vector<TexturedTable> tables(missing.size());
  parallel_for(missing.size(),
               [&](size_t i) { tables[i] = textured_table(geometry, *missing[i].mesh, missing[i].primitive, masks); });
  for (size_t i = 0; i < missing.size(); ++i) {
    TexturedTable& made = tables[i];
    if (made.entries.empty()) continue;
    textured_indices_[missing[i].mesh->first_triangle + missing[i].primitive] = static_cast<int32_t>(textured_.size());
    made.triangle.first_entry = static_cast<uint32_t>(entries_.size());
    entries_.insert(entries_.end(), made.entries.begin(), made.entries.end());
    textured_.push_back(made.triangle);
  }
}

void LightBuilder::add_punctual_lights(const Scene& scene, const PlacedNodes& nodes, bool at_infinity) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    const Index light = scene.nodes[i].light;
    if (light == kNone) continue;
    PunctualLight source = scene.lights[static_cast<size_t>(light)];
    if (!nodes.visible[i]) source.intensity = Rgb(0);  // it keeps its place in the list, dark
    if (type_of(source).at_infinity == at_infinity) lights_.push_back(punctual_light(source, nodes.world[i]));
  }
}

bool LightBuilder::same(const Light& a, const Light& b) const {
  return a.kind == LightKind::environment && b.kind == LightKind::environment ? !environment_changed_
                                                                              : same_light(a, b);
}

void LightBuilder::mark_changes() {
  const bool same_count = previous_.size() == lights_.size();
  // What an earlier edit of this frame changed stays changed, though `previous_` may have been replaced since.
  const std::vector<LightId> before = same_count ? std::move(changed_) : std::vector<LightId>();
  changed_.clear();
  for (size_t i = 0; i < lights_.size(); ++i) {
    const auto id = static_cast<LightId>(i);
    const bool differs = i >= previous_.size() || !same(lights_[i], previous_[i]);
    lights_[i].changed = has_previous_ && (differs || std::binary_search(before.begin(), before.end(), id));
    if (lights_[i].changed) changed_.push_back(id);
  }
  if (!has_previous_ || !same_count) previous_ = lights_;
}

void LightBuilder::forget_textures() {
  textured_indices_.clear();
  textured_.clear();
  entries_.clear();
  for (Light& light : previous_) {
    if (light.kind == LightKind::triangle) light.triangle.textured = -1;  // its table is gone
  }
}

void LightBuilder::mark_unchanged() {
  for (Light& light : lights_) light.changed = false;
  changed_.clear();
  previous_ = lights_;
  has_previous_ = true;
  environment_changed_ = false;
}

LightsView LightBuilder::view() const {
  LightsView v;
  v.lights = view_of(lights_);
  v.previous = view_of(previous_);
  v.changed = view_of(changed_);
  v.first_infinite = first_infinite_;
  v.textured = {view_of(textured_), view_of(entries_), textures_};
  v.environment = environment_;
  v.bounds = bounds_;
  return v;
}

size_t LightBuilder::memory_bytes() const {
  return (lights_.size() + previous_.size()) * sizeof(Light) + textured_.size() * sizeof(TexturedTriangle) +
         entries_.size() * sizeof(AliasEntry) + environment_map_.size() * sizeof(Rgb) +
         (environment_distribution_.marginal.size() + environment_distribution_.conditional.size()) * sizeof(float);
}

}  // namespace relume
