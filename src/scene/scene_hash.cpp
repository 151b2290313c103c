#include "scene/scene_hash.h"

#include <span>
#include <type_traits>

#include "scene/light_parameters.h"
#include "scene/material_parameters.h"

namespace relume {
namespace {

class Hasher {
 public:
  void bytes(const void* data, size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    // Eight bytes per step speed up large arrays; the tail is hashed byte by byte.
    size_t i = 0;
    for (; i + 8 <= size; i += 8) {
      uint64_t word = 0;
      for (int k = 0; k < 8; ++k) word |= static_cast<uint64_t>(p[i + static_cast<size_t>(k)]) << (8 * k);
      mix(word);
    }
    for (; i < size; ++i) mix(p[i]);
  }

  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) Hasher& operator<<(const T& value) {
    bytes(&value, sizeof(T));
    return *this;
  }
  template <int N, typename T>
  Hasher& operator<<(const glm::vec<N, T>& v) {
    bytes(&v, sizeof(v));
    return *this;
  }
  Hasher& operator<<(const glm::quat& q) {
    bytes(&q, sizeof(q));
    return *this;
  }
  Hasher& operator<<(const Mat4& m) {
    bytes(&m, sizeof(m));
    return *this;
  }
  template <typename T>
  Hasher& operator<<(const std::vector<T>& v) {
    *this << v.size();
    if constexpr (std::has_unique_object_representations_v<T> || std::is_same_v<T, float> || std::is_same_v<T, Vec2> ||
                  std::is_same_v<T, Vec3> || std::is_same_v<T, Vec4> || std::is_same_v<T, UVec3> ||
                  std::is_same_v<T, Mat4>) {
      bytes(v.data(), v.size() * sizeof(T));
    } else {
      for (const T& element : v) *this << element;
    }
    return *this;
  }

  Hasher& operator<<(const std::string& text) {
    *this << text.size();
    bytes(text.data(), text.size());
    return *this;
  }
  Hasher& operator<<(const TextureRef& r) {
    return *this << r.texture << r.uv_set << r.offset << r.scale << r.rotation_rad;
  }
  Hasher& operator<<(const Texture& t) {
    return *this << t.width << t.height << t.format << t.wrap_u << t.wrap_v << t.filter << t.texels;
  }
  Hasher& operator<<(const Material& m) {
    for_each_parameter(m, [&](const MaterialParameter&, const auto& value) { *this << value; });
    return *this << m.mix_first << m.mix_second;
  }
  Hasher& operator<<(const Mesh& m) {
    *this << m.positions << m.normals << m.tangents << m.uv0 << m.uv1 << m.colors << m.triangles << m.material;
    return *this << m.morph_targets << m.influences_per_vertex << m.influences;
  }
  Hasher& operator<<(const MorphTarget& t) { return *this << t.positions << t.normals << t.tangents; }
  Hasher& operator<<(const JointInfluence& i) { return *this << i.joint << i.weight; }
  Hasher& operator<<(const Skin& s) { return *this << s.joints << s.inverse_bind; }
  Hasher& operator<<(const PunctualLight& l) {
    *this << l.type << l.intensity;
    for (const LightParameter& p : light_parameters()) *this << l.*p.member;
    return *this;
  }
  Hasher& operator<<(const Camera& c) {
    return *this << c.projection << c.fov_y_rad << c.half_height << c.aspect_ratio << c.lens_radius << c.focus_distance;
  }
  Hasher& operator<<(const Node& n) {
    *this << n.parent << n.transform.translation << n.transform.rotation << n.transform.scale << n.matrix.has_value();
    if (n.matrix) *this << *n.matrix;
    return *this << n.meshes << n.instances << n.light << n.camera << n.skin << n.morph_weights << n.visible;
  }
  Hasher& operator<<(const AnimationChannel& c) {
    return *this << c.node << c.property << c.interpolation << c.times << c.values << c.morph_target << c.clip;
  }
  Hasher& operator<<(const ParameterChannel& c) {
    return *this << c.part << c.index << c.parameter << c.interpolation << c.times << c.values << c.clip;
  }
  Hasher& operator<<(const Environment& e) {
    const SunSky& s = e.sun_sky;
    *this << e.kind << e.color << e.width << e.height << e.map << e.rotation_rad << s.sun_elevation_rad
          << s.sun_azimuth_rad << s.turbidity;
    return *this << s.sky_scale << s.sun_scale << s.sun_angular_diameter_rad << s.ground_albedo;
  }

  Hasher& operator<<(const VisibleSet& s) { return *this << s.low << s.high << s.visible; }

  uint64_t value() const { return state_; }

 private:
  void mix(uint64_t word) {
    state_ = (state_ ^ word) * 0x100000001b3ull;
    state_ ^= state_ >> 29;
  }
  uint64_t state_ = 0xcbf29ce484222325ull;
};

}  // namespace

uint64_t scene_hash(const Scene& scene) {
  Hasher h;
  h << scene.textures << scene.materials << scene.meshes << scene.lights << scene.cameras << scene.nodes << scene.skins
    << scene.clips << scene.animation << scene.parameter_animation << scene.environment;
  if (!scene.visible_sets.empty()) h << scene.visible_sets;
  return h.value();
}

}  // namespace relume
