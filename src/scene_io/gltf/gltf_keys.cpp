#include "scene_io/gltf/gltf_keys.h"

#include <algorithm>

#include <fmt/format.h>

#include "scene_io/gltf/gltf_accessor.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

bool usable(const Vec4& v) { return is_finite(Vec3(v)) && is_finite(v.w); }

std::vector<Vec4> read_values(const Document& document, int accessor, int components) {
  std::vector<Vec4> values;
  switch (components) {
    case 1:
      for (const float v : read_scalars(document, accessor)) values.emplace_back(v, 0.0f, 0.0f, 0.0f);
      return values;
    case 2:
      for (const Vec2& v : read_vec2(document, accessor)) values.emplace_back(v, 0.0f, 0.0f);
      return values;
    case 3:
      for (const Vec3& v : read_vec3(document, accessor)) values.emplace_back(v, 0.0f);
      return values;
    default: return read_vec4(document, accessor);
  }
}

/// Factor for a pointer's values: the file's strength for a colour, the file's colour for a strength.
Vec4 other_factor(const tinygltf::Model& model, const ParameterPointer& pointer) {
  const auto i = static_cast<size_t>(pointer.index);
  const bool color = pointer.parameter->components == 3;
  if (pointer.parameter->parameter == "emission") {
    const tinygltf::Material& m = model.materials[i];
    const auto extension = m.extensions.find("KHR_materials_emissive_strength");
    const float strength =
        extension == m.extensions.end() ? 1.0f : to_float(number_member(extension->second, "emissiveStrength", 1));
    return color ? Vec4(strength) : Vec4(to_vec3(m.emissiveFactor, Vec3(0)), 0);
  }
  if (pointer.parameter->parameter == "intensity") {
    const tinygltf::Light& l = model.lights[i];
    return color ? Vec4(to_float(l.intensity)) : Vec4(to_vec3(l.color, Vec3(1)), 0);
  }
  return Vec4(1);
}

/// Whether the value is a scalar strength of a colour.
bool is_strength(const PointerParameter& p) {
  return p.components == 1 && (p.parameter == "emission" || p.parameter == "intensity");
}

Index index_of(const SceneIndices& indices, const ParameterPointer& pointer) {
  switch (pointer.parameter->part) {
    case AnimatedPart::material: return indices.material(pointer.index);
    case AnimatedPart::light: return indices.light(pointer.index);
    case AnimatedPart::camera: return indices.camera(pointer.index);
  }
  return kNone;
}

}  // namespace

Interpolation interpolation_of(const std::string& name) {
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  return Interpolation::linear;
}

void repair_keys(AnimationChannel& channel, const std::string& name, Warnings& warnings) {
  const size_t per_key = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
  const size_t value_at = per_key == 3 ? 1 : 0;
  size_t kept = 0;
  for (size_t i = 0; i < channel.times.size(); ++i) {
    bool ok = is_finite(channel.times[i]) && (kept == 0 || channel.times[i] > channel.times[kept - 1]);
    for (size_t k = 0; k < per_key; ++k) ok = ok && usable(channel.values[per_key * i + k]);
    if (channel.property == AnimatedProperty::rotation)
      ok = ok && glm::length(channel.values[per_key * i + value_at]) > 0;
    if (!ok) continue;
    channel.times[kept] = channel.times[i];
    for (size_t k = 0; k < per_key; ++k) channel.values[per_key * kept + k] = channel.values[per_key * i + k];
    ++kept;
  }
  if (kept < channel.times.size())
    warnings.add(
        fmt::format("animation '{}': {} key frames whose times do not increase or that are not finite are dropped",
                    name, channel.times.size() - kept));
  channel.times.resize(kept);
  channel.values.resize(kept * per_key);
}

void import_parameter(Document& document, const SceneIndices& indices, const tinygltf::Animation& animation,
                      int sampler, const ParameterPointer& pointer, Index clip, const std::string& name, Scene& scene) {
  const PointerParameter& p = *pointer.parameter;
  const Index index = index_of(indices, pointer);
  if (index == kNone) return;  // unused in the scene
  if (sampler < 0 || static_cast<size_t>(sampler) >= animation.samplers.size())
    document.damaged(fmt::format("animation '{}' refers to sampler {}, which does not exist", name, sampler));
  const tinygltf::AnimationSampler& source = animation.samplers[static_cast<size_t>(sampler)];
  AnimationChannel keys;
  keys.interpolation = interpolation_of(source.interpolation);
  keys.times = read_scalars(document, source.input);
  keys.values = read_values(document, source.output, p.components);
  const size_t per_key = keys.interpolation == Interpolation::cubic_spline ? 3 : 1;
  if (keys.values.size() != per_key * keys.times.size())
    document.damaged(
        fmt::format("animation '{}' has {} times but {} values", name, keys.times.size(), keys.values.size()));
  repair_keys(keys, name, document.warnings);
  const Vec4 factor = other_factor(document.model, pointer);
  const auto add = [&](const std::string& parameter, const std::function<Vec4(const Vec4&)>& value_of) {
    const bool is_driven =
        std::any_of(scene.parameter_animation.begin(), scene.parameter_animation.end(), [&](const ParameterChannel& c) {
          return c.clip == clip && c.part == p.part && c.index == index && c.parameter == parameter;
        });
    if (is_driven) {
      document.warnings.add(fmt::format("animation '{}' has several channels for {}; the first one is used", name,
                                        pointer_to(p, pointer.index)));
      return;
    }
    ParameterChannel channel{p.part, index, parameter, keys.interpolation, keys.times, keys.values, clip};
    for (Vec4& value : channel.values) value = value_of(value);
    scene.parameter_animation.push_back(std::move(channel));
  };
  if (keys.times.empty()) return;
  if (is_strength(p)) return add(p.parameter, [&](const Vec4& v) { return v.x * factor; });
  add(p.parameter, [&](const Vec4& v) { return v * factor; });
  if (p.components == 4) add("alpha", [](const Vec4& v) { return Vec4(v.w, 0, 0, 0); });
}

}  // namespace relume::gltf
