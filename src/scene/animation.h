// Key frames of a scene: evaluation and choice of clips.
#pragma once

#include "scene/scene.h"

namespace relume {

/// Value of a channel at `time_s`, in the form of AnimationChannel::values; rotations are not normalised. Constant
/// before the first key and after the last.
Vec4 evaluate(const AnimationChannel& channel, float time_s);

Vec4 evaluate(const ParameterChannel& channel, float time_s);

/// Whether the property is part of a node's transform.
bool is_transform(AnimatedProperty property);

/// Sets the part of the transform that the channel animates.
void apply(const AnimationChannel& channel, float time_s, Transform& transform);

/// Minimum and maximum of component x of the channel over all times.
struct ValueRange {
  float low = 0;
  float high = 0;
};
ValueRange value_range(const AnimationChannel& channel);

}  // namespace relume
