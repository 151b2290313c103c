#include "scene_io/gltf/gltf_write_animation.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "scene/animation.h"
#include "scene_io/gltf/gltf_pointers.h"

namespace relume::gltf {
namespace {

const char* path_name(AnimatedProperty property) {
  constexpr const char* names[] = {"translation", "rotation", "scale", "weights"};
  return names[static_cast<size_t>(property)];
}

const char* interpolation_name(Interpolation interpolation) {
  constexpr const char* names[] = {"STEP", "LINEAR", "CUBICSPLINE"};
  return names[static_cast<size_t>(interpolation)];
}

bool same_keys(const AnimationChannel& a, const AnimationChannel& b) {
  return a.interpolation == b.interpolation && a.times == b.times;
}

size_t values_a_key(const AnimationChannel& channel) {
  return channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
}

/// Linear keys at all times of `channels`, without values.
AnimationChannel at_all_times(const std::vector<const AnimationChannel*>& channels) {
  std::set<float> times;
  for (const AnimationChannel* channel : channels) times.insert(channel->times.begin(), channel->times.end());
  AnimationChannel keys;
  keys.times.assign(times.begin(), times.end());
  return keys;
}

}  // namespace

void AnimationWriter::write() {
  for (size_t i = 0; i < scene_.clips.size(); ++i) write_clip(static_cast<Index>(i), scene_.clips[i]);
  if (scene_.clips.empty()) write_clip(kNone, "animation");
}

std::vector<const AnimationChannel*> AnimationWriter::channels_of(Index clip) const {
  std::set<std::tuple<Index, AnimatedProperty, Index>> driven;
  std::vector<const AnimationChannel*> channels;
  for (const AnimationChannel& channel : scene_.animation) {
    if (channel.clip != clip && channel.clip != kNone) continue;
    if (driven.emplace(channel.node, channel.property, channel.morph_target).second) channels.push_back(&channel);
  }
  return channels;
}

void AnimationWriter::write_clip(Index clip, const std::string& name) {
  samplers_ = OutputJson::array();
  channels_ = OutputJson::array();
  const std::vector<const AnimationChannel*> channels = channels_of(clip);
  std::set<Index> morphed;
  for (const AnimationChannel* channel : channels) {
    if (channel->property == AnimatedProperty::morph_weight) {
      if (morphed.insert(channel->node).second) add_morph_weights(channels, *channel);
    } else {
      add_channel(target_of(*channel), channel->times, channel->interpolation, values_of(*channel));
    }
  }
  for (const ParameterChannel& channel : scene_.parameter_animation) {
    if (channel.clip == clip || channel.clip == kNone) add_parameter(channel, clip);
  }
  if (!channels_.empty()) {
    output_.add("animations", {{"name", name}, {"channels", std::move(channels_)}, {"samplers", std::move(samplers_)}});
  } else if (clip != kNone) {
    output_.warn(fmt::format("animation '{}' moves nothing and is not written", name));
  }
}

int AnimationWriter::values_of(const AnimationChannel& channel) {
  if (channel.property == AnimatedProperty::rotation)
    return output_.add_floats(flat<4>(channel.values), 4, BufferTarget::none);
  if (channel.property == AnimatedProperty::visible) {
    std::vector<uint8_t> shown;
    for (const Vec4& value : channel.values) shown.push_back(value.x != 0 ? 1 : 0);
    return output_.add_unsigned_bytes(shown);
  }
  const std::vector<Vec3> xyz(channel.values.begin(), channel.values.end());
  return output_.add_floats(flat<3>(xyz), 3, BufferTarget::none);
}

void AnimationWriter::add_channel(OutputJson target, const std::vector<float>& times, Interpolation interpolation,
                                  int values) {
  const auto [input, is_new] = inputs_.try_emplace(times, 0);
  if (is_new) input->second = output_.add_floats(times, 1, BufferTarget::none, true);
  channels_.push_back({{"sampler", samplers_.size()}, {"target", std::move(target)}});
  samplers_.push_back(
      {{"input", input->second}, {"output", values}, {"interpolation", interpolation_name(interpolation)}});
}

float AnimationWriter::written_strength(const ParameterChannel& channel) const {
  const auto i = static_cast<size_t>(channel.index);
  if (channel.parameter == "emission") return std::max(1.0f, max_component(scene_.materials[i].emission));
  if (channel.parameter != "intensity") return 1;
  const float intensity = max_component(scene_.lights[i].intensity);
  return intensity > 0 ? intensity : 1.0f;
}

void AnimationWriter::add_parameter(const ParameterChannel& channel, Index clip) {
  if (channel.part == AnimatedPart::material && channel.parameter == "alpha") return;  // written with the base colour
  const std::vector<PointerParameter>& known = pointer_parameters();
  const auto p = std::find_if(known.begin(), known.end(), [&](const PointerParameter& candidate) {
    return candidate.part == channel.part && candidate.parameter == channel.parameter;
  });
  if (p == known.end()) {
    output_.warn(fmt::format("glTF cannot animate '{}'; its key frames are not written", channel.parameter));
    return;
  }
  std::vector<float> values;
  const float strength = written_strength(channel);
  const ParameterChannel* alpha = p->components == 4 ? alpha_of(channel, clip) : nullptr;
  for (size_t row = 0; row < channel.values.size(); ++row) {
    for (int c = 0; c < std::min(p->components, 3); ++c) values.push_back(channel.values[row][c] / strength);
    if (p->components < 4) continue;
    const bool is_tangent = channel.interpolation == Interpolation::cubic_spline && row % 3 != 1;
    const float rest = is_tangent ? 0.0f : scene_.materials[static_cast<size_t>(channel.index)].alpha;
    values.push_back(alpha ? alpha->values[row].x : rest);
  }
  output_.use_extension("KHR_animation_pointer");
  add_channel(
      {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer_to(*p, channel.index)}}}}}},
      channel.times, channel.interpolation, output_.add_floats(values, p->components, BufferTarget::none));
}

const ParameterChannel* AnimationWriter::alpha_of(const ParameterChannel& base_color, Index clip) {
  for (const ParameterChannel& c : scene_.parameter_animation) {
    if (c.part != AnimatedPart::material || c.index != base_color.index || c.parameter != "alpha") continue;
    if (c.clip != clip && c.clip != kNone) continue;
    if (c.times == base_color.times && c.interpolation == base_color.interpolation) return &c;
    output_.warn(
        fmt::format("material '{}': alpha and base colour have different key frames; those of alpha are not written",
                    scene_.materials[static_cast<size_t>(c.index)].name));
  }
  return nullptr;
}

OutputJson AnimationWriter::target_of(const AnimationChannel& channel) {
  if (channel.property != AnimatedProperty::visible)
    return {{"node", channel.node}, {"path", path_name(channel.property)}};
  output_.use_extension("KHR_animation_pointer");
  output_.use_extension("KHR_node_visibility");
  const std::string pointer = fmt::format("/nodes/{}/extensions/KHR_node_visibility/visible", channel.node);
  return {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
}

void AnimationWriter::add_morph_weights(const std::vector<const AnimationChannel*>& channels,
                                        const AnimationChannel& first) {
  const Node& node = scene_.nodes[static_cast<size_t>(first.node)];
  size_t targets = 0;
  for (const Index mesh : node.meshes)
    targets = std::max(targets, scene_.meshes[static_cast<size_t>(mesh)].morph_targets.size());
  std::vector<const AnimationChannel*> by_target(targets, nullptr);
  std::vector<const AnimationChannel*> present;
  for (const AnimationChannel* channel : channels) {
    if (channel->property != AnimatedProperty::morph_weight || channel->node != first.node) continue;
    by_target[static_cast<size_t>(channel->morph_target)] = channel;
    present.push_back(channel);
  }
  const bool together = std::all_of(present.begin(), present.end(),
                                    [&](const AnimationChannel* channel) { return same_keys(*channel, first); });
  const AnimationChannel keys = together ? first : at_all_times(present);
  if (!together)
    output_.warn(
        fmt::format("node '{}': its morph targets have keys at different times; they are written as linear "
                    "keys at all of these",
                    node.name));
  const size_t per_key = values_a_key(keys);
  std::vector<float> values;
  for (size_t row = 0; row < per_key * keys.times.size(); ++row) {
    for (size_t k = 0; k < targets; ++k) {
      const float rest = k < node.morph_weights.size() && (per_key == 1 || row % 3 == 1) ? node.morph_weights[k] : 0.0f;
      const AnimationChannel* channel = by_target[k];
      values.push_back(!channel ? rest : together ? channel->values[row].x : evaluate(*channel, keys.times[row]).x);
    }
  }
  add_channel(target_of(first), keys.times, keys.interpolation, output_.add_floats(values, 1, BufferTarget::none));
}

}  // namespace relume::gltf
