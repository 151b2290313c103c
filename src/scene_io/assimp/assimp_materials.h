// Converts materials of an assimp scene.
#pragma once

#include "scene_io/assimp/imported_scene.h"
#include "scene_io/warnings.h"

struct aiScene;

namespace relume {

/// Appends all materials of `source` in order and requests their textures. Physically based properties are copied. In
/// the older model (diffuse Kd, specular Ks, exponent Ns), a dark Kd under a bright Ks becomes a metal of colour Ks,
/// all else a dielectric over Kd. Ns gives microfacet α = √(2 / (Ns + 2)) ([Walter07, §5.2]).
void import_assimp_materials(const aiScene& source, ImportedScene& imported, Warnings& warnings);

}  // namespace relume
