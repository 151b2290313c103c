// Writes a scene's animation to a glTF file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_output.h"

namespace relume::gltf {

class AnimationWriter {
 public:
  AnimationWriter(const Scene& scene, Output& output) : scene_(scene), output_(output) {}

  /// Writes one animation per clip, including channels that play with every clip; without clips, one animation of
  /// those. glTF node i must be node i of the scene.
  void write();

 private:
  void write_clip(Index clip, const std::string& name);
  /// Channels of a clip. For each property, the first of several channels.
  std::vector<const AnimationChannel*> channels_of(Index clip) const;
  /// Accessor of the channel's values.
  int values_of(const AnimationChannel& channel);
  void add_channel(OutputJson target, const std::vector<float>& times, Interpolation interpolation, int values);
  /// Writes key frames of a material, light or camera with KHR_animation_pointer.
  void add_parameter(const ParameterChannel& channel, Index clip);
  /// Strength written beside the colour that the channel drives.
  float written_strength(const ParameterChannel& channel) const;
  /// Key frames of alpha, which the file stores with those of the base colour; nullptr: none.
  const ParameterChannel* alpha_of(const ParameterChannel& base_color, Index clip);
  OutputJson target_of(const AnimationChannel& channel);
  /// Writes the weights of all morph targets of the channel's node: glTF stores them in one channel.
  void add_morph_weights(const std::vector<const AnimationChannel*>& channels, const AnimationChannel& first);

  const Scene& scene_;
  Output& output_;
  OutputJson samplers_;
  OutputJson channels_;
  std::map<std::vector<float>, int> inputs_;  ///< channels with the same times share them
};

}  // namespace relume::gltf
