// A scene at one moment, for programs and file formats without animation, skins or morph targets.
#pragma once

#include "scene/scene.h"

namespace relume {

/// The scene at `time_s` of its first clip: nodes, parameters and visibility have their values then, and meshes that
/// skins or morph targets deform have their shapes. Without channels, clips, skins and morph targets. Meshes with a
/// skin move to nodes of their own, whose space is the world. Throws Error if a joint is out of reach.
Scene still_scene(Scene scene, float time_s);

}  // namespace relume
