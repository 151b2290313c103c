#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene/animated_parameters.h"
#include "scene/animation.h"
#include "scene/light_parameters.h"
#include "scene/material_parameters.h"
#include "scene/mixtures.h"
#include "scene/placement.h"
#include "scene/scene.h"

namespace relume {
namespace {

template <typename... Args>
[[noreturn]] void fail(const std::string& place, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(place + ": " + fmt::format(format, std::forward<Args>(args)...));
}

/// Finite, if the range is; otherwise not NaN.
bool is_usable(float x, const ParameterRange& range) { return is_finite(range.high) ? is_finite(x) : !std::isnan(x); }
bool is_usable(const Rgb& color, const ParameterRange&) { return is_finite(color); }
template <typename T>
bool is_usable(const T&, const ParameterRange&) {
  return true;
}

bool in_range(float x, float low, float high) { return x >= low && x <= high; }
bool is_radiance(const Rgb& c) { return max_component(c) <= kMaxRadiance && min_component(c) >= 0.0f; }

class Validator {
 public:
  Validator(const Scene& scene, const std::string& place) : scene_(scene), place_(place) {}

  void run() const {
    for (size_t i = 0; i < scene_.textures.size(); ++i) check_texture(i);
    for (size_t i = 0; i < scene_.materials.size(); ++i) check_material(i);
    const auto parts_of = [&](size_t i) {
      return std::pair(scene_.materials[i].mix_first, scene_.materials[i].mix_second);
    };
    check_mixtures(scene_.materials.size(), parts_of, place_);
    for (size_t i = 0; i < scene_.meshes.size(); ++i) check_mesh(i);
    for (const PunctualLight& light : scene_.lights) validate(light, place_);
    for (const Camera& camera : scene_.cameras) validate(camera, place_);
    validate(scene_.environment, place_);
    for (size_t i = 0; i < scene_.skins.size(); ++i) check_skin(i);
    for (size_t i = 0; i < scene_.nodes.size(); ++i) check_node(i);
    for (size_t i = 0; i < scene_.animation.size(); ++i) check_channel(i);
    for (size_t i = 0; i < scene_.parameter_animation.size(); ++i) check_parameter_channel(i);
    check_crop();
    check_visible_sets();
    check_cycles();
    check_placement(scene_, world_matrices(scene_, 0), place_);
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw Error(place_ + ": " + fmt::format(format, std::forward<Args>(args)...) +
                "; the scene is damaged, repair it or export it again");
  }

  static bool in_range(Index i, size_t count) { return i >= 0 && static_cast<size_t>(i) < count; }
  static bool in_range_or_none(Index i, size_t count) { return i == kNone || in_range(i, count); }

  void check_texture(size_t i) const {
    const Texture& t = scene_.textures[i];
    const size_t texel_size = t.format == PixelFormat::rgba32_float ? 16 : 4;
    if (t.width <= 0 || t.height <= 0) fail("texture {} '{}' has no pixels", i, t.name);
    if (t.texels.size() != static_cast<size_t>(t.width) * static_cast<size_t>(t.height) * texel_size)
      fail("texture {} '{}' has {} bytes, which does not match its size {}x{}", i, t.name, t.texels.size(), t.width,
           t.height);
  }

  void check_material(size_t i) const {
    const Material& m = scene_.materials[i];
    const size_t count = scene_.textures.size();
    for (const TextureRef* ref : texture_refs(m)) {
      if (!in_range_or_none(ref->texture, count))
        fail("material {} '{}' refers to missing texture {}", i, m.name, ref->texture);
      if (ref->uv_set < 0 || ref->uv_set > 1)
        fail("material {} '{}' uses texture coordinate set {}; only 0 and 1 exist", i, m.name, ref->uv_set);
    }
    validate(m, place_);
  }

  void check_mesh(size_t i) const {
    const Mesh& m = scene_.meshes[i];
    const size_t count = m.positions.size();
    const auto agrees = [&](size_t n) { return n == 0 || n == count; };
    if (!agrees(m.normals.size()) || !agrees(m.tangents.size()) || !agrees(m.uv0.size()) || !agrees(m.uv1.size()) ||
        !agrees(m.colors.size()))
      fail("mesh {} '{}' has attribute arrays of different lengths", i, m.name);
    if (!in_range_or_none(m.material, scene_.materials.size()))
      fail("mesh {} '{}' refers to missing material {}", i, m.name, m.material);
    if (m.default_material && !in_range_or_none(*m.default_material, scene_.materials.size()))
      fail("mesh {} '{}' refers to missing default material {}", i, m.name, *m.default_material);
    for (const VariantMaterial& choice : m.variants) {
      if (!in_range(choice.variant, scene_.variants.size()) || !in_range(choice.material, scene_.materials.size()))
        fail("mesh {} '{}' refers to missing variant {} or material {}", i, m.name, choice.variant, choice.material);
    }
    for (const UVec3& t : m.triangles) {
      if (t.x >= count || t.y >= count || t.z >= count)
        fail("mesh {} '{}' has a vertex index out of range ({} vertices)", i, m.name, count);
    }
    for (const Vec3& p : m.positions) {
      if (!(max_component(abs(p)) <= kMaxCoordinate))
        fail("mesh {} '{}' has a vertex that is not finite or beyond {:g} m", i, m.name, kMaxCoordinate);
    }
    for (const MorphTarget& target : m.morph_targets) check_morph_target(i, target);
    check_influences(i);
  }

  void check_morph_target(size_t mesh, const MorphTarget& t) const {
    const Mesh& m = scene_.meshes[mesh];
    for (const std::vector<Vec3>* array : {&t.positions, &t.normals, &t.tangents}) {
      if (!array->empty() && array->size() != m.positions.size())
        fail("mesh {} '{}' has {} vertices, but its morph target '{}' has {}", mesh, m.name, m.positions.size(), t.name,
             array->size());
      for (const Vec3& displacement : *array) {
        if (!(max_component(abs(displacement)) <= kMaxCoordinate))
          fail("mesh {} '{}' has a morph target '{}' that is not finite or beyond {:g} m", mesh, m.name, t.name,
               kMaxCoordinate);
      }
    }
  }

  void check_influences(size_t mesh) const {
    const Mesh& m = scene_.meshes[mesh];
    if (m.influences_per_vertex < 0 ||
        m.influences.size() != m.positions.size() * static_cast<size_t>(m.influences_per_vertex))
      fail("mesh {} '{}' has {} joint influences, but {} vertices with {} each", mesh, m.name, m.influences.size(),
           m.positions.size(), m.influences_per_vertex);
    for (const JointInfluence& influence : m.influences) {
      if (!(influence.weight >= 0 && is_finite(influence.weight)))
        fail("mesh {} '{}' has a joint weight of {}, which is negative or not finite", mesh, m.name, influence.weight);
    }
    const auto per_vertex = static_cast<size_t>(m.influences_per_vertex);
    for (size_t first = 0; per_vertex > 0 && first < m.influences.size(); first += per_vertex) {
      float sum = 0;
      for (size_t k = first; k < first + per_vertex; ++k) sum += m.influences[k].weight;
      if (!(std::fabs(sum - 1) <= 1e-3f))
        fail("mesh {} '{}' has a vertex whose joint weights sum to {}, not 1", mesh, m.name, sum);
    }
  }

  void check_skin(size_t i) const {
    const Skin& s = scene_.skins[i];
    if (s.joints.empty()) fail("skin {} '{}' has no joints", i, s.name);
    if (s.inverse_bind.size() != s.joints.size())
      fail("skin {} '{}' has {} joints but {} inverse bind matrices", i, s.name, s.joints.size(),
           s.inverse_bind.size());
    for (const Index joint : s.joints) {
      if (!in_range(joint, scene_.nodes.size())) fail("skin {} '{}' refers to missing joint {}", i, s.name, joint);
    }
    for (const Mat4& m : s.inverse_bind) {
      if (!within_reach(m))
        fail("skin {} '{}' has an inverse bind matrix that is not finite or beyond {:g} m", i, s.name, kMaxCoordinate);
    }
  }

  void check_skinned_node(const Node& n) const {
    if (!n.instances.empty()) fail("node '{}' has a skin and instances, which would coincide", n.name);
    const size_t joints = scene_.skins[static_cast<size_t>(n.skin)].joints.size();
    for (const Index mesh : n.meshes) {
      const Mesh& m = scene_.meshes[static_cast<size_t>(mesh)];
      const bool outside = std::any_of(m.influences.begin(), m.influences.end(),
                                       [&](const JointInfluence& influence) { return influence.joint >= joints; });
      if (outside) fail("mesh {} '{}' follows a joint that the skin of node '{}' lacks", mesh, m.name, n.name);
    }
  }

  void check_node(size_t i) const {
    const Node& n = scene_.nodes[i];
    if (!in_range_or_none(n.parent, scene_.nodes.size()))
      fail("node {} '{}' refers to missing parent {}", i, n.name, n.parent);
    for (const Index mesh : n.meshes) {
      if (!in_range(mesh, scene_.meshes.size())) fail("node {} '{}' refers to missing mesh {}", i, n.name, mesh);
    }
    if (!in_range_or_none(n.light, scene_.lights.size()))
      fail("node {} '{}' refers to missing light {}", i, n.name, n.light);
    if (!in_range_or_none(n.camera, scene_.cameras.size()))
      fail("node {} '{}' refers to missing camera {}", i, n.name, n.camera);
    if (!in_range_or_none(n.skin, scene_.skins.size()))
      fail("node {} '{}' refers to missing skin {}", i, n.name, n.skin);
    if (n.skin != kNone) check_skinned_node(n);
    for (const float weight : n.morph_weights) {
      if (!(std::fabs(weight) <= kMaxCoordinate))
        fail("node {} '{}' has a morph weight that is not finite or beyond {:g}", i, n.name, kMaxCoordinate);
    }
  }

  template <typename Channel>
  void check_keys(size_t i, const Channel& c) const {
    const size_t per_key = c.interpolation == Interpolation::cubic_spline ? 3 : 1;
    if (c.times.empty() || c.values.size() != per_key * c.times.size())
      fail("animation channel {} has {} times but {} values", i, c.times.size(), c.values.size());
    for (const Vec4& value : c.values) {
      if (!is_finite(Vec3(value)) || !is_finite(value.w))
        fail("animation channel {} has a value that is not finite", i);
    }
    for (size_t k = 0; k < c.times.size(); ++k) {
      if (!is_finite(c.times[k]) || (k > 0 && c.times[k] <= c.times[k - 1]))
        fail("animation channel {} has times that do not increase", i);
    }
  }

  void check_parameter_channel(size_t i) const {
    const ParameterChannel& c = scene_.parameter_animation[i];
    if (!has_parameter(scene_, c))
      fail("animation channel {} drives '{}' of part {}, which does not exist", i, c.parameter, c.index);
    if (!in_range_or_none(c.clip, scene_.clips.size()))
      fail("animation channel {} belongs to missing clip {}", i, c.clip);
    check_keys(i, c);
  }

  void check_channel(size_t i) const {
    const AnimationChannel& c = scene_.animation[i];
    if (!in_range(c.node, scene_.nodes.size())) fail("animation channel {} moves missing node {}", i, c.node);
    if (!in_range_or_none(c.clip, scene_.clips.size()))
      fail("animation channel {} belongs to missing clip {}", i, c.clip);
    if (c.property == AnimatedProperty::morph_weight && !has_morph_target(c))
      fail("animation channel {} moves the missing morph target {} of node {}", i, c.morph_target, c.node);
    if (c.property == AnimatedProperty::visible && c.interpolation != Interpolation::step)
      fail("animation channel {} interpolates visibility, which can only step", i);
    check_keys(i, c);
    if (c.property != AnimatedProperty::morph_weight) return;
    const ValueRange range = value_range(c);
    if (!(std::max(std::fabs(range.low), std::fabs(range.high)) <= kMaxCoordinate))
      fail("animation channel {} has a morph weight above {:g}", i, kMaxCoordinate);
  }

  bool has_morph_target(const AnimationChannel& c) const {
    const std::vector<Index>& meshes = scene_.nodes[static_cast<size_t>(c.node)].meshes;
    return std::any_of(meshes.begin(), meshes.end(), [&](Index mesh) {
      return in_range(c.morph_target, scene_.meshes[static_cast<size_t>(mesh)].morph_targets.size());
    });
  }

  void check_crop() const {
    const ImagePart& c = scene_.crop;
    const bool is_part =
        c.left >= 0 && c.left < c.right && c.right <= 1 && c.top >= 0 && c.top < c.bottom && c.bottom <= 1;
    if (!is_part)
      fail("the crop from ({}, {}) to ({}, {}) is not a part of the image [0, 1] x [0, 1]", c.left, c.top, c.right,
           c.bottom);
  }

  void check_visible_sets() const {
    for (size_t i = 0; i < scene_.visible_sets.size(); ++i) {
      const VisibleSet& set = scene_.visible_sets[i];
      const bool is_box = is_finite(set.low) && is_finite(set.high) && min_component(set.high - set.low) > 0;
      if (!is_box) fail("the box of visible set {} is empty or not finite", i);
      for (const uint32_t other : set.visible) {
        if (other >= scene_.visible_sets.size()) fail("visible set {} refers to the missing set {}", i, other);
      }
    }
  }

  /// Walks up from every node. A walk longer than the number of nodes is in a cycle.
  void check_cycles() const {
    std::vector<char> safe(scene_.nodes.size(), 0);
    for (size_t i = 0; i < scene_.nodes.size(); ++i) {
      std::vector<size_t> walked;
      for (Index n = static_cast<Index>(i); n != kNone && !safe[static_cast<size_t>(n)];
           n = scene_.nodes[static_cast<size_t>(n)].parent) {
        walked.push_back(static_cast<size_t>(n));
        if (walked.size() > scene_.nodes.size()) fail("node {} '{}' is its own ancestor", i, scene_.nodes[i].name);
      }
      for (const size_t n : walked) safe[n] = 1;
    }
  }

  const Scene& scene_;
  const std::string& place_;
};

}  // namespace

void validate(const Material& m, const std::string& place) {
  for_each_parameter(m, [&](const MaterialParameter& p, const auto& value) {
    if (!is_usable(value, p.range))
      fail(place, "material '{}': {} is not finite; give it a finite value", m.name, p.name);
  });
  if (!is_radiance(m.emission))
    fail(place, "material '{}' has an emission of ({}, {}, {}); give it values from 0 to {:g}", m.name, m.emission.r,
         m.emission.g, m.emission.b, kMaxRadiance);
}

void validate(const PunctualLight& l, const std::string& place) {
  if (!is_radiance(l.intensity))
    fail(place, "light '{}' has an intensity of ({}, {}, {}); give it values from 0 to {:g}", l.name, l.intensity.r,
         l.intensity.g, l.intensity.b, kMaxRadiance);
  for (const LightParameter& p : light_parameters()) {
    if (!in_range(l.*p.member, 0, upper_limit(p, l)))
      fail(place, "light '{}': {} is {} radians; give it a value between 0 and {}", l.name, p.name, l.*p.member,
           upper_limit(p, l));
  }
}

void validate(const Camera& c, const std::string& place) {
  constexpr float kSmallest = 1e-6f;
  if (!in_range(c.fov_y_rad, kSmallest, kPi - kSmallest))
    fail(place, "camera '{}' has a field of view of {} radians; give it a value between 0 and pi", c.name, c.fov_y_rad);
  if (!in_range(c.half_height, kSmallest, kMaxCoordinate))
    fail(place, "camera '{}' has a half height of {} m; give it a value between {:g} and {:g}", c.name, c.half_height,
         kSmallest, kMaxCoordinate);
  if (c.aspect_ratio != 0 && !in_range(c.aspect_ratio, 0.01f, 100))
    fail(place, "camera '{}' has an aspect ratio of {}; give it a value between 0.01 and 100, or 0", c.name,
         c.aspect_ratio);
  if (!in_range(c.lens_radius, 0, kMaxCoordinate) || !in_range(c.focus_distance, kSmallest, kMaxCoordinate))
    fail(place, "camera '{}' has a lens radius of {} m and focuses at {} m; give it positive values up to {:g}", c.name,
         c.lens_radius, c.focus_distance, kMaxCoordinate);
}

void validate(const Environment& e, const std::string& place) {
  const bool is_map = e.kind == EnvironmentKind::map;
  if (is_map &&
      (e.width <= 0 || e.height <= 0 || e.map.size() != static_cast<size_t>(e.width) * static_cast<size_t>(e.height)))
    fail(place, "the environment map has {} pixels, which does not match its size {}x{}", e.map.size(), e.width,
         e.height);
  const SunSky& s = e.sun_sky;
  if (!is_radiance(e.color) || !is_radiance(s.ground_albedo))
    fail(place,
         "the environment has a colour of ({}, {}, {}) and a ground albedo of ({}, {}, {}); give them values from 0 to "
         "{:g}",
         e.color.r, e.color.g, e.color.b, s.ground_albedo.r, s.ground_albedo.g, s.ground_albedo.b, kMaxRadiance);
  if (!(is_finite(s.sky_scale) && s.sky_scale >= 0) || !(is_finite(s.sun_scale) && s.sun_scale >= 0))
    fail(place,
         "the environment has a sky scale of {} and a sun scale of {}; give them finite values that are not negative",
         s.sky_scale, s.sun_scale);
  // Limits: sky radiance below 1e4 kcd/m², or that of a disk of 128 klx over its solid angle. Suns without extent are
  // invisible.
  const float half_sine = std::sin(0.25f * s.sun_angular_diameter_rad);
  const float disk = 2.0f * half_sine * half_sine;
  const float sun = 128.0f * s.sun_scale / (disk > 0.0f ? 2 * kPi * disk : 1.0f);
  const bool is_sky = e.kind == EnvironmentKind::sun_sky;
  if (is_sky && !(max(1e4f * s.sky_scale, sun) * max_component(e.color) <= kMaxRadiance))
    fail(place, "the sun or the sky is brighter than {:g}; give it a smaller scale", kMaxRadiance);
  if (!is_finite(e.rotation_rad) || !is_finite(s.sun_elevation_rad) || !is_finite(s.sun_azimuth_rad) ||
      !is_finite(s.turbidity) || !in_range(s.sun_angular_diameter_rad, 0, kPi))
    fail(place,
         "the environment has an angle or turbidity that is not finite, or a sun diameter of {} radians; give finite "
         "values, and a diameter from 0 to pi",
         s.sun_angular_diameter_rad);
}

void validate(const Scene& scene, const std::string& place) { Validator(scene, place).run(); }

}  // namespace relume
