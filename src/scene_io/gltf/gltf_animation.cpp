#include <set>
#include <utility>

#include <fmt/format.h>

#include "scene_io/decompose.h"
#include "scene_io/gltf/gltf_accessor.h"
#include "scene_io/gltf/gltf_nodes.h"

namespace relume::gltf {
namespace {

bool usable(const Vec4& v) { return is_finite(Vec3(v)) && is_finite(v.w); }

Interpolation interpolation_of(const std::string& name) {
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  return Interpolation::linear;
}

/// False: a path that is not animated here.
bool property_of(const std::string& path, AnimatedProperty& property) {
  if (path == "translation") property = AnimatedProperty::translation;
  if (path == "rotation") property = AnimatedProperty::rotation;
  if (path == "scale") property = AnimatedProperty::scale;
  return path == "translation" || path == "rotation" || path == "scale";
}

std::vector<Vec4> read_values(const Document& document, int accessor, AnimatedProperty property) {
  if (property == AnimatedProperty::rotation) return read_vec4(document, accessor);
  std::vector<Vec4> values;
  for (const Vec3& v : read_vec3(document, accessor)) values.emplace_back(v, 0.0f);
  return values;
}

/// Keeps the keys whose times increase and whose values are finite; a rotation's value must have a length.
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

void import_channel(Document& document, const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source,
                    AnimationChannel channel, Scene& scene) {
  if (source.sampler < 0 || static_cast<size_t>(source.sampler) >= animation.samplers.size())
    document.damaged(
        fmt::format("animation '{}' refers to sampler {}, which does not exist", animation.name, source.sampler));
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(source.sampler)];
  channel.interpolation = interpolation_of(sampler.interpolation);
  channel.times = read_scalars(document, sampler.input);
  channel.values = read_values(document, sampler.output, channel.property);
  const size_t per_key = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
  if (channel.values.size() != per_key * channel.times.size())
    document.damaged(fmt::format("animation '{}' has {} times but {} values", animation.name, channel.times.size(),
                                 channel.values.size()));
  repair_keys(channel, animation.name, document.warnings);
  if (channel.times.empty()) return;
  Node& node = scene.nodes[static_cast<size_t>(channel.node)];
  if (node.matrix) {
    document.warnings.add(fmt::format(
        "node '{}' is animated but has a matrix; its translation, rotation and scale take its place", node.name));
    node.transform = decompose(*node.matrix);
    node.matrix.reset();
  }
  scene.animation.push_back(std::move(channel));
}

}  // namespace

void import_animation(Document& document, const std::vector<Index>& node_of, Scene& scene) {
  std::set<std::pair<Index, AnimatedProperty>> driven;
  for (const tinygltf::Animation& animation : document.model.animations) {
    for (const tinygltf::AnimationChannel& source : animation.channels) {
      AnimationChannel channel;
      if (!property_of(source.target_path, channel.property)) {
        document.warnings.add(fmt::format("animation of '{}' is not supported and is ignored", source.target_path));
        continue;
      }
      if (source.target_node < 0) continue;  // glTF 2.0: channels without a node are to be ignored
      if (static_cast<size_t>(source.target_node) >= node_of.size())
        document.damaged(
            fmt::format("animation '{}' moves node {}, which does not exist", animation.name, source.target_node));
      channel.node = node_of[static_cast<size_t>(source.target_node)];
      if (channel.node == kNone) continue;
      if (!driven.emplace(channel.node, channel.property).second) {
        document.warnings.add(fmt::format("several animations move node '{}'; the first one counts",
                                          scene.nodes[static_cast<size_t>(channel.node)].name));
        continue;
      }
      import_channel(document, animation, source, std::move(channel), scene);
    }
  }
}

}  // namespace relume::gltf
