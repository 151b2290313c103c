#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/scene.h"

namespace relume {
namespace {

class Validator {
 public:
  Validator(const Scene& scene, const std::string& place) : scene_(scene), place_(place) {}

  void run() const {
    for (size_t i = 0; i < scene_.textures.size(); ++i) check_texture(i);
    for (size_t i = 0; i < scene_.materials.size(); ++i) check_material(i);
    for (size_t i = 0; i < scene_.meshes.size(); ++i) check_mesh(i);
    for (size_t i = 0; i < scene_.nodes.size(); ++i) check_node(i);
    for (size_t i = 0; i < scene_.animation.size(); ++i) check_channel(i);
    check_cycles();
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw Error(place_ + ": " + fmt::format(format, std::forward<Args>(args)...));
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
    for (const TextureRef* ref : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                                  &m.emission_texture, &m.specular_texture, &m.specular_color_texture,
                                  &m.transmission_texture, &m.clearcoat_texture, &m.clearcoat_roughness_texture}) {
      if (!in_range_or_none(ref->texture, count))
        fail("material {} '{}' refers to missing texture {}", i, m.name, ref->texture);
      if (ref->uv_set < 0 || ref->uv_set > 1)
        fail("material {} '{}' uses texture coordinate set {}; only 0 and 1 exist", i, m.name, ref->uv_set);
    }
    if (!is_finite(m.base_color) || !is_finite(m.emission) || !is_finite(m.specular_color) || !is_finite(m.roughness) ||
        !is_finite(m.metallic) || !is_finite(m.ior) || !is_finite(m.transmission))
      fail("material {} '{}' has a number that is not finite", i, m.name);
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
    for (const UVec3& t : m.triangles) {
      if (t.x >= count || t.y >= count || t.z >= count)
        fail("mesh {} '{}' has a vertex index out of range ({} vertices)", i, m.name, count);
    }
    for (const Vec3& p : m.positions) {
      if (!is_finite(p)) fail("mesh {} '{}' has a vertex that is not finite", i, m.name);
    }
  }

  void check_node(size_t i) const {
    const Node& n = scene_.nodes[i];
    if (!in_range_or_none(n.parent, scene_.nodes.size()))
      fail("node {} '{}' has a missing parent {}", i, n.name, n.parent);
    for (const Index mesh : n.meshes) {
      if (!in_range(mesh, scene_.meshes.size())) fail("node {} '{}' refers to missing mesh {}", i, n.name, mesh);
    }
    if (!in_range_or_none(n.light, scene_.lights.size()))
      fail("node {} '{}' refers to missing light {}", i, n.name, n.light);
    if (!in_range_or_none(n.camera, scene_.cameras.size()))
      fail("node {} '{}' refers to missing camera {}", i, n.name, n.camera);
  }

  void check_channel(size_t i) const {
    const AnimationChannel& c = scene_.animation[i];
    if (!in_range(c.node, scene_.nodes.size())) fail("animation channel {} moves missing node {}", i, c.node);
    const size_t per_key = c.interpolation == Interpolation::cubic_spline ? 3 : 1;
    if (c.times.empty() || c.values.size() != per_key * c.times.size())
      fail("animation channel {} has {} times but {} values", i, c.times.size(), c.values.size());
    for (size_t k = 0; k < c.times.size(); ++k) {
      if (!is_finite(c.times[k]) || (k > 0 && c.times[k] <= c.times[k - 1]))
        fail("animation channel {} has times that do not increase", i);
    }
  }

  /// Walks up from every node; a walk longer than the number of nodes has met a cycle.
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

void validate(const Scene& scene, const std::string& place) { Validator(scene, place).run(); }

}  // namespace relume
