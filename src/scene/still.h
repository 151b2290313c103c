// A scene at one moment, for programs and file formats without animation, skins or morph targets.
#pragma once

#include "scene/scene.h"

namespace relume {

/// The scene at `time_s` of its first clip, without channels, clips, skins and morph targets. Nodes, parameters and
/// visibility have their values at that time. So do the shapes of visible meshes that skins or morph targets deform;
/// hidden ones are at rest. Skinned meshes move to nodes of their own, whose space is the world. Throws Error if a
/// joint is out of reach.
Scene still_scene(Scene scene, float time_s);

}  // namespace relume
