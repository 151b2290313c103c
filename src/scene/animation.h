// Key frames of a scene: their values at a time, and the choice of clips.
#pragma once

#include "scene/scene.h"

namespace relume {

/// Value of a channel at `time_s`, as AnimationChannel::values has them; rotations are not normalised. Held before the
/// first key and after the last.
Vec4 evaluate(const AnimationChannel& channel, float time_s);

Vec4 evaluate(const ParameterChannel& channel, float time_s);

/// Whether the property is part of a node's transform.
bool is_transform(AnimatedProperty property);

/// Sets the part of the transform that the channel drives.
void apply(const AnimationChannel& channel, float time_s, Transform& transform);

/// Least and largest value of x that the channel takes at any time.
struct ValueRange {
  float low = 0;
  float high = 0;
};
ValueRange value_range(const AnimationChannel& channel);

}  // namespace relume
