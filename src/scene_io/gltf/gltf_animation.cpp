#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "scene/animation.h"
#include "scene_io/decompose.h"
#include "scene_io/gltf/gltf_accessor.h"
#include "scene_io/gltf/gltf_keys.h"
#include "scene_io/gltf/gltf_nodes.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

/// Node property driven by a channel.
struct Target {
  int node = -1;
  AnimatedProperty property = AnimatedProperty::translation;
};

std::optional<AnimatedProperty> property_of(std::string_view path) {
  if (path == "translation") return AnimatedProperty::translation;
  if (path == "rotation") return AnimatedProperty::rotation;
  if (path == "scale") return AnimatedProperty::scale;
  if (path == "weights") return AnimatedProperty::morph_weight;
  if (path == "extensions/KHR_node_visibility/visible") return AnimatedProperty::visible;
  return std::nullopt;
}

/// KHR_animation_pointer's pointer; empty for channels of core glTF.
std::string pointer_of(const tinygltf::AnimationChannel& channel) {
  const auto extension = channel.target_extensions.find("KHR_animation_pointer");
  if (channel.target_path != "pointer" || extension == channel.target_extensions.end()) return {};
  return string_member(extension->second, "pointer");
}

/// Target of a KHR_animation_pointer such as "/nodes/3/translation"; nothing for properties that relume does not
/// animate.
std::optional<Target> target_of_pointer(std::string_view pointer) {
  constexpr std::string_view kNodes = "/nodes/";
  if (!pointer.starts_with(kNodes)) return std::nullopt;
  pointer.remove_prefix(kNodes.size());
  Target target;
  const auto parsed = std::from_chars(pointer.data(), pointer.data() + pointer.size(), target.node);
  if (parsed.ec != std::errc{} || parsed.ptr == pointer.data() + pointer.size() || *parsed.ptr != '/')
    return std::nullopt;
  const std::optional<AnimatedProperty> property =
      property_of(pointer.substr(static_cast<size_t>(parsed.ptr - pointer.data()) + 1));
  if (!property) return std::nullopt;
  target.property = *property;
  return target;
}

std::optional<Target> target_of(const tinygltf::AnimationChannel& channel, Warnings& warnings) {
  std::string path = channel.target_path;
  std::optional<Target> target;
  if (path == "pointer") {
    path = pointer_of(channel);
    target = target_of_pointer(path);
  } else if (const std::optional<AnimatedProperty> property = property_of(path)) {
    target = {channel.target_node, *property};
  }
  if (!target) warnings.add(fmt::format("animation of '{}' is not supported and is ignored", path));
  return target;
}

std::vector<Vec4> read_values(const Document& document, int accessor, AnimatedProperty property) {
  if (property == AnimatedProperty::rotation) return read_vec4(document, accessor);
  std::vector<Vec4> values;
  if (property == AnimatedProperty::morph_weight || property == AnimatedProperty::visible) {
    for (const float v : read_scalars(document, accessor)) values.emplace_back(v, 0.0f, 0.0f, 0.0f);
    return values;
  }
  for (const Vec3& v : read_vec3(document, accessor)) values.emplace_back(v, 0.0f);
  return values;
}

/// Replaces an animated node's matrix by its translation, rotation and scale.
void replace_matrix(Node& node, Warnings& warnings) {
  if (!node.matrix) return;
  warnings.add(fmt::format(
      "node '{}' is animated but has a matrix; the matrix is split into translation, rotation and scale", node.name));
  node.transform = decompose(*node.matrix);
  node.matrix.reset();
}

/// Splits a sampler's channel into one channel per morph target, at least one.
std::vector<AnimationChannel> split_by_target(AnimationChannel whole, size_t targets) {
  std::vector<AnimationChannel> channels;
  const std::vector<Vec4> values = std::exchange(whole.values, {});
  for (size_t k = 0; k < targets; ++k) {
    AnimationChannel& part = channels.emplace_back(whole);
    part.morph_target = static_cast<Index>(k);
    part.values.reserve(values.size() / targets);
    for (size_t i = k; i < values.size(); i += targets) part.values.push_back(values[i]);
  }
  return channels;
}

class AnimationImporter {
 public:
  AnimationImporter(Document& document, const SceneIndices& indices, Scene& scene)
      : document_(document), indices_(indices), node_of_(indices.nodes), scene_(scene) {}

  void import(const tinygltf::Animation& animation) {
    const auto clip = static_cast<Index>(scene_.clips.size());
    name_ = animation.name.empty() ? fmt::format("animation {}", clip) : animation.name;
    scene_.clips.push_back(name_);
    driven_.clear();
    for (const tinygltf::AnimationChannel& source : animation.channels) {
      if (const std::optional<ParameterPointer> pointer = parse_parameter_pointer(pointer_of(source))) {
        import_parameter(document_, indices_, animation, source.sampler, *pointer, clip, name_, scene_);
        continue;
      }
      const std::optional<Target> target = target_of(source, document_.warnings);
      if (!target || target->node < 0) continue;  // glTF 2.0: channels without a node are ignored
      if (static_cast<size_t>(target->node) >= node_of_.size())
        document_.damaged(fmt::format("animation '{}' moves node {}, which does not exist", name_, target->node));
      AnimationChannel channel;
      channel.node = node_of_[static_cast<size_t>(target->node)];
      channel.property = target->property;
      channel.clip = clip;
      if (channel.node == kNone) continue;
      if (!driven_.emplace(channel.node, channel.property).second) {
        document_.warnings.add(
            fmt::format("animation '{}' has several channels for a property of node '{}'; the first one is used", name_,
                        scene_.nodes[static_cast<size_t>(channel.node)].name));
        continue;
      }
      read(animation, source, std::move(channel), target_count(target->node));
    }
  }

 private:
  /// Number of morph targets of a glTF node.
  size_t target_count(int node) const {
    const int mesh = document_.model.nodes[static_cast<size_t>(node)].mesh;
    if (mesh < 0 || static_cast<size_t>(mesh) >= document_.model.meshes.size()) return 0;
    size_t most = 0;
    for (const tinygltf::Primitive& primitive : document_.model.meshes[static_cast<size_t>(mesh)].primitives)
      most = std::max(most, primitive.targets.size());
    return most;
  }

  void read(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source, AnimationChannel channel,
            size_t morph_targets) {
    if (source.sampler < 0 || static_cast<size_t>(source.sampler) >= animation.samplers.size())
      document_.damaged(
          fmt::format("animation '{}' refers to sampler {}, which does not exist", name_, source.sampler));
    const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(source.sampler)];
    channel.interpolation = interpolation_of(sampler.interpolation);
    if (channel.property == AnimatedProperty::visible) {
      if (channel.interpolation == Interpolation::cubic_spline) {
        document_.warnings.add(
            fmt::format("animation '{}' interpolates the visibility of a node by a spline; that channel is ignored, as "
                        "glTF requires steps",
                        name_));
        return;
      }
      channel.interpolation = Interpolation::step;  // also for files with the default, linear
    }
    channel.times = read_scalars(document_, sampler.input);
    channel.values = read_values(document_, sampler.output, channel.property);
    const size_t per_key = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const size_t targets = channel.property == AnimatedProperty::morph_weight ? morph_targets : 1;
    if (targets == 0) {
      document_.warnings.add(
          fmt::format("animation '{}' moves morph targets that do not exist; that channel is ignored", name_));
      return;
    }
    if (channel.values.size() != per_key * channel.times.size() * targets)
      document_.damaged(
          fmt::format("animation '{}' has {} times but {} values", name_, channel.times.size(), channel.values.size()));
    for (AnimationChannel& part : split_by_target(std::move(channel), targets)) {
      repair_keys(part, name_, document_.warnings);
      if (part.times.empty()) continue;
      if (is_transform(part.property)) replace_matrix(scene_.nodes[static_cast<size_t>(part.node)], document_.warnings);
      scene_.animation.push_back(std::move(part));
    }
  }

  Document& document_;
  const SceneIndices& indices_;
  const std::vector<Index>& node_of_;
  Scene& scene_;
  std::string name_;
  std::set<std::pair<Index, AnimatedProperty>> driven_;
};

}  // namespace

void import_animation(Document& document, const SceneIndices& indices, Scene& scene) {
  AnimationImporter importer(document, indices, scene);
  for (const tinygltf::Animation& animation : document.model.animations) importer.import(animation);
}

void drop_missing_targets(Document& document, Scene& scene) {
  const auto exists = [&](const AnimationChannel& channel) {
    const std::vector<Index>& meshes = scene.nodes[static_cast<size_t>(channel.node)].meshes;
    return std::any_of(meshes.begin(), meshes.end(), [&](Index mesh) {
      return static_cast<size_t>(channel.morph_target) < scene.meshes[static_cast<size_t>(mesh)].morph_targets.size();
    });
  };
  const size_t dropped = std::erase_if(scene.animation, [&](const AnimationChannel& channel) {
    return channel.property == AnimatedProperty::morph_weight && !exists(channel);
  });
  if (dropped > 0)
    document.warnings.add(fmt::format("{} animations of morph targets that do not exist are dropped", dropped));
}

void drop_empty_clips(Scene& scene) {
  std::vector<Index> kept(scene.clips.size(), kNone);
  for (const AnimationChannel& channel : scene.animation) kept[static_cast<size_t>(channel.clip)] = 0;
  for (const ParameterChannel& channel : scene.parameter_animation) kept[static_cast<size_t>(channel.clip)] = 0;
  std::vector<std::string> clips;
  for (size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == kNone) continue;
    kept[i] = static_cast<Index>(clips.size());
    clips.push_back(std::move(scene.clips[i]));
  }
  scene.clips = std::move(clips);
  for (AnimationChannel& channel : scene.animation) channel.clip = kept[static_cast<size_t>(channel.clip)];
  for (ParameterChannel& channel : scene.parameter_animation) channel.clip = kept[static_cast<size_t>(channel.clip)];
}

}  // namespace relume::gltf
