// Converts pbrt's camera, and the settings that it gives.
#pragma once

#include "scene_io/pbrt/pbrt_colors.h"
#include "scene_io/pbrt/pbrt_description.h"

namespace relume::pbrt {

/// From relume's camera space, which looks along -Z, to that of a camera of type `kind` in pbrt, which is left-handed
/// and looks along +Z. The centre of pbrt's spherical images is the direction -X, and their right side is to the left
/// of it.
Mat4 from_relume_camera(const std::string& kind);

/// From pbrt's world to relume's, orthogonal. Mirrors if the camera does not: pbrt's camera space is left-handed, and
/// images must not be mirrored. Turns the main axis of the camera's up direction to +Y.
Mat3 world_orientation(const Description& description);

/// Adds the camera with its node and keys, and the settings of film, sampler and integrator. Without a camera in the
/// file, adds pbrt's default one.
void add_camera(const Description& description, const Mat3& orientation, Scene& scene, Warnings& warnings);

/// Adds key frames of a node at the start and the end of the shutter interval. Matrices that a translation, a rotation
/// and a scale cannot give are approximated, with a warning.
void animate(const Mat4& start, const Mat4& end, const std::array<double, 2>& times, Index node, Scene& scene,
             Warnings& warnings);

}  // namespace relume::pbrt
