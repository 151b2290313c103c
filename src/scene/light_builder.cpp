#include "scene/light_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "scene/emission_table.h"
#include "scene/light_parameters.h"
#include "scene/parallelogram.h"
#include "scene/placement.h"
#include "scene/studio.h"
#include "scene/sun_sky.h"
#include "scene/surface_point.h"

namespace relume {
namespace {

/// TriangleLight::error: the largest error of the vertices.
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

/// Bound on the factor by which an instance scales lengths.
float largest_stretch(const Instance& instance) {
  if (instance.in_world_space) return 1.0f;
  const Mat3& m = instance.to_world.linear;
  return glm::length(m[0]) + glm::length(m[1]) + glm::length(m[2]);
}

/// Geometry of the light at a triangle, or at that and the next if lights are paired.
TriangleLight placed_light(const SceneView& geometry, const Instance& instance, uint32_t triangle) {
  UVec3 index = geometry.triangles[triangle];
  TriangleLight light{};
  light.error = triangle_error(geometry, index, instance);
  if (instance.paired_lights) {
    const UVec3& other = geometry.triangles[triangle + 1];
    const Parallelogram sides = *find_parallelogram(geometry.vertices, index, other);
    light.error =
        std::max(light.error, triangle_error(geometry, other, instance)) + sides.deviation * largest_stretch(instance);
    light.is_parallelogram = true;
    index = {sides.corner, sides.first_end, sides.second_end};
  }
  const auto position = [&](uint32_t v) {
    const Vec3& p = geometry.vertices[v].position;
    return instance.in_world_space ? p : instance.to_world.point(p);
  };
  const Vec3 corner = position(index.x);
  set_corners(light, {corner, position(index.y) - corner, position(index.z) - corner}, instance.orientation);
  return light;
}

/// A view of the scene in which the instance and its mesh are posed at a key of the shutter.
struct PosedAtKey {
  SceneView scene;
  Instance instance;

  PosedAtKey(const SceneView& geometry, const Instance& at_middle, uint32_t key)
      : scene(geometry), instance(at_middle) {
    const MeshView& mesh = geometry.meshes[instance.mesh];
    const MotionView& motion = geometry.motion;
    if (instance.first_key != kNoKeys) instance.to_world = motion.instance_keys[instance.first_key + key];
    if (mesh.first_key != kNoKeys) {
      // Indices of vertices count from the start of the whole array.
      scene.vertices = {motion.vertex_keys.data + static_cast<ptrdiff_t>(static_cast<int32_t>(mesh.first_key)) +
                            static_cast<ptrdiff_t>(key) * mesh.key_stride,
                        geometry.vertices.size};
    }
  }
};

bool moves_in_shutter(const SceneView& geometry, const Instance& instance) {
  return instance.first_key != kNoKeys || geometry.meshes[instance.mesh].first_key != kNoKeys;
}

/// A punctual light of a node.
Light punctual_light(PunctualLight source, const Mat4& to_world) {
  const Vec3 position(to_world[3]);
  Vec3 axis = -direction_of(Vec3(to_world[2]));
  if (axis == Vec3(0) && type_of(source).has_direction) {  // collapsed: stays in the list without emission
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

}  // namespace

void LightBuilder::set_environment(const Environment& source) {
  environment_changed_ = true;
  has_sun_ = false;
  EnvironmentMap baked;
  if (source.kind == EnvironmentKind::sun_sky) {
    SunSkyModel model = make_sun_sky(source.sun_sky);
    baked = {model.width, model.height, std::move(model.sky)};
    sun_ = model.sun;
    sun_.irradiance *= source.color;
    has_sun_ = !is_black(sun_.irradiance);
  }
  if (source.kind == EnvironmentKind::studio) baked = make_studio();
  environment_ = {};
  if (source.kind == EnvironmentKind::none || source.kind == EnvironmentKind::automatic) return;
  environment_.scale = source.color;
  environment_.mean = source.color;
  environment_.cos_rotation = std::cos(source.rotation_rad);
  environment_.sin_rotation = std::sin(source.rotation_rad);
  sun_.to_light = environment_.direction_from_map(sun_.to_light);
  if (source.kind == EnvironmentKind::constant) return;

  if (source.kind == EnvironmentKind::map) {
    use_environment_map(source.map, source.width, source.height);
  } else {
    use_environment_map(baked.texels, baked.width, baked.height);
  }
}

void LightBuilder::use_environment_map(std::span<const Rgb> map, int w, int h) {
  environment_map_.assign(map);
  environment_.map = environment_map_.view();
  environment_.width = static_cast<uint32_t>(w);
  environment_.height = static_cast<uint32_t>(h);
  // The weight of a texel is its solid angle times the mean of the bilinear interpolation over it, (1 6 1)/8 along each
  // axis.
  std::vector<float> weights(map.size());
  const auto at = [&](int x, int y) {
    return map[static_cast<size_t>(std::clamp(y, 0, h - 1)) * static_cast<size_t>(w) +
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
  const Distribution2DStorage distribution = build_distribution_2d(weights, environment_.width, environment_.height);
  environment_marginal_.assign(distribution.marginal);
  environment_conditional_.assign(distribution.conditional);
  environment_.distribution = {environment_marginal_.view(), environment_conditional_.view(), distribution.width,
                               distribution.height};
}

void LightBuilder::clear() noexcept {
  collected_ = true;
  lights_.clear();
  changed_.clear();
  light_keys_.clear();
  first_light_keys_.clear();
  first_infinite_ = 0;
  environment_ = {};
  has_sun_ = false;
}

void LightBuilder::collect(const SceneView& geometry, std::span<Instance> instances, const Scene& scene,
                           const PlacedNodes& nodes, const SceneBounds& bounds) {
  collected_ = true;
  lights_.clear();
  keys_.clear();
  first_keys_.clear();
  key_count_ = geometry.motion.count;
  bounds_ = bounds;
  textures_ = geometry.textures;
  add_textured(geometry, instances);
  for (uint32_t i = 0; i < instances.size(); ++i) add_triangles(geometry, i, instances[i]);
  add_punctual_lights(scene, nodes, false);
  first_infinite_ = static_cast<uint32_t>(lights_.size());
  add_punctual_lights(scene, nodes, true);
  if (has_sun_) lights_.push_back(Light::of(sun_));
  if (!environment_.black()) lights_.push_back({});
  light_keys_.assign(keys_);
  if (!first_keys_.empty()) first_keys_.resize(lights_.size(), kNoKeys);
  first_light_keys_.assign(first_keys_);
  mark_changes();
}

void LightBuilder::add_triangles(const SceneView& geometry, uint32_t instance_index, Instance& instance) {
  const MeshView& mesh = geometry.meshes[instance.mesh];
  const MaterialData& material = geometry.materials[mesh.material];
  instance.first_light = kNoLight;
  if (!material.emissive()) return;
  instance.first_light = static_cast<LightId>(lights_.size());
  const bool textured = has_textured_emission(material);
  instance.paired_lights = !textured && !mesh.deforms && consists_of_parallelograms(geometry, mesh);
  for (uint32_t k = 0; k < mesh.triangle_count; k += instance.paired_lights ? 2 : 1) {
    TriangleLight light = placed_light(geometry, instance, mesh.first_triangle + k);
    light.radiance = light.area > 0.0f && instance.visible ? material.emission : Rgb(0);
    light.instance = instance_index;
    light.primitive = k;
    light.textured = -1;
    light.two_sided = material.double_sided;
    light.coat = material.clearcoat;
    if (light.area > 0.0f && textured) {
      light.textured = textured_indices_.at(mesh.first_triangle + k);
      if (light.textured == kBlackTexture) light.radiance = Rgb(0);
    }
    if (moves_in_shutter(geometry, instance)) add_keys(geometry, instance, mesh.first_triangle + k, light);
    lights_.push_back(Light::of(light));
  }
}

void LightBuilder::add_keys(const SceneView& geometry, const Instance& instance, uint32_t triangle,
                            TriangleLight& light) {
  first_keys_.resize(lights_.size(), kNoKeys);
  first_keys_.push_back(static_cast<uint32_t>(keys_.size()));
  for (uint32_t k = 0; k < geometry.motion.count; ++k) {
    const PosedAtKey posed(geometry, instance, k);
    const TriangleLight at_key = placed_light(posed.scene, posed.instance, triangle);
    keys_.push_back({at_key.v0, at_key.e1, at_key.e2});
    // The doubled error covers the rounding of interpolated corners.
    light.error = std::max(light.error, 2.0f * at_key.error);
  }
}

void LightBuilder::add_textured(const SceneView& geometry, std::span<const Instance> instances) {
  std::vector<EmissiveTriangle> missing;
  for (const Instance& instance : instances) {
    const MeshView& mesh = geometry.meshes[instance.mesh];
    if (!has_textured_emission(geometry.materials[mesh.material])) continue;
    for (uint32_t k = 0; k < mesh.triangle_count; ++k) {
      const bool is_new = textured_indices_.try_emplace(mesh.first_triangle + k, kBlackTexture).second;
      if (is_new) missing.push_back({&mesh, k});
    }
  }
  const std::vector<EmissionTable> tables = make_emission_tables(geometry, missing);
  for (size_t i = 0; i < missing.size(); ++i) {
    if (tables[i].entries.empty()) continue;
    textured_indices_[missing[i].mesh->first_triangle + missing[i].primitive] = static_cast<int32_t>(textured_.size());
    TexturedTriangle triangle = tables[i].triangle;
    triangle.first_entry = static_cast<uint32_t>(entries_.size());
    textured_.push_back(triangle);
    entries_.append(tables[i].entries);
  }
}

void LightBuilder::add_punctual_lights(const Scene& scene, const PlacedNodes& nodes, bool at_infinity) {
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    const Index light = scene.nodes[i].light;
    if (light == kNone) continue;
    PunctualLight source = scene.lights[static_cast<size_t>(light)];
    if (!nodes.visible[i]) source.intensity = Rgb(0);  // stays in the list without emission
    if (type_of(source).at_infinity == at_infinity) lights_.push_back(punctual_light(source, nodes.world[i]));
  }
}

bool LightBuilder::same(const Light& a, const Light& b) const {
  return a.kind == LightKind::environment && b.kind == LightKind::environment ? !environment_changed_
                                                                              : same_light(a, b);
}

void LightBuilder::mark_changes() {
  const bool same_count = previous_.size() == lights_.size();
  // Changes from earlier edits of this frame persist, even if `previous_` was replaced since.
  Array<LightId> changed_before(changed_.memory());
  if (same_count) changed_before.swap(changed_);
  changed_.clear();
  const std::span<const LightId> before = changed_before.read();
  const std::span<const Light> previous = previous_.read();
  const std::span<Light> lights = lights_.write();
  for (size_t i = 0; i < lights.size(); ++i) {
    const auto id = static_cast<LightId>(i);
    const bool differs = i >= previous.size() || !same(lights[i], previous[i]);
    lights[i].changed = has_previous_ && (differs || std::binary_search(before.begin(), before.end(), id));
    if (lights[i].changed) changed_.push_back(id);
  }
  if (!has_previous_ || !same_count) previous_ = lights_;
}

void LightBuilder::discard_texture_tables() {
  textured_indices_.clear();
  textured_.clear();
  entries_.clear();
  for (Light& light : previous_.write()) {
    if (light.kind == LightKind::triangle) light.triangle.textured = -1;  // its table no longer exists
  }
}

void LightBuilder::mark_unchanged() {
  if (!collected_) return;
  previous_.reserve(lights_.size());  // below, only a device that cannot move memory throws
  for (Light& light : lights_.write()) light.changed = false;
  changed_.clear();
  previous_ = lights_;
  has_previous_ = true;
  environment_changed_ = false;
  collected_ = false;
}

LightsView LightBuilder::view() const {
  LightsView v;
  v.lights = lights_.view();
  v.previous = previous_.view();
  v.changed = changed_.view();
  v.first_infinite = first_infinite_;
  v.textured = {textured_.view(), entries_.view(), textures_};
  v.environment = environment_;
  v.bounds = bounds_;
  v.keys = light_keys_.view();
  v.first_keys = first_light_keys_.view();
  v.key_count = key_count_;
  return v;
}

void LightBuilder::open_for_host() const {
  lights_.permit_reading();
  previous_.permit_reading();
  changed_.permit_reading();
  light_keys_.permit_reading();
  first_light_keys_.permit_reading();
  textured_.permit_reading();
  entries_.permit_reading();
  environment_map_.permit_reading();
  environment_marginal_.permit_reading();
  environment_conditional_.permit_reading();
}

size_t LightBuilder::memory_bytes() const {
  return light_keys_.memory_bytes() + first_light_keys_.memory_bytes() + lights_.memory_bytes() +
         previous_.memory_bytes() + changed_.memory_bytes() + textured_.memory_bytes() + entries_.memory_bytes() +
         environment_map_.memory_bytes() + environment_marginal_.memory_bytes() +
         environment_conditional_.memory_bytes();
}

}  // namespace relume
