// Animation of a scene into a glTF file.
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

  /// Writes an animation for each clip, with the channels that play with every clip; one of these alone if there is no
  /// clip. glTF node i must be node i of the scene.
  void write();

 private:
  void write_clip(Index clip, const std::string& name);
  /// Of two that drive the same property, the first.
  std::vector<const AnimationChannel*> channels_of(Index clip) const;
  /// Accessor of the channel's values.
  int values_of(const AnimationChannel& channel);
  void add_channel(OutputJson target, const std::vector<float>& times, Interpolation interpolation, int values);
  /// The key frames of a material, light or camera, as KHR_animation_pointer has them.
  void add_parameter(const ParameterChannel& channel, Index clip);
  /// The strength beside the colour that the channel drives, as it is written.
  float written_strength(const ParameterChannel& channel) const;
  /// Key frames of the alpha that the file keeps with those of the base colour; nullptr: none.
  const ParameterChannel* alpha_of(const ParameterChannel& base_color, Index clip);
  OutputJson target_of(const AnimationChannel& channel);
  /// The weights of all morph targets of the channel's node, which glTF keeps in one channel.
  void add_morph_weights(const std::vector<const AnimationChannel*>& channels, const AnimationChannel& first);

  const Scene& scene_;
  Output& output_;
  OutputJson samplers_;
  OutputJson channels_;
  std::map<std::vector<float>, int> inputs_;  ///< channels that move together share their times
};

}  // namespace relume::gltf
