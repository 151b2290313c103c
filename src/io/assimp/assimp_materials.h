// Materials of a scene that assimp read.
#pragma once

#include "io/assimp/assimp_textures.h"

namespace relume {

/// Appends all materials of `source` to `scene`, in its order. Physically based properties are taken as they are; of
/// the older model (diffuse Kd, specular Ks, exponent Ns), a dark Kd under a bright Ks is a metal of colour Ks, all
/// else is a dielectric over Kd. Ns gives microfacet α = √(2 / (Ns + 2)) (Walter et al. 2007, "Microfacet Models for
/// Refraction through Rough Surfaces", §5.2).
void import_assimp_materials(const aiScene& source, AssimpTextures& textures, Scene& scene, Warnings& warnings);

/// After AssimpTextures::finish(): materials that emit only by a texture, whose image is missing, are dark.
void darken_missing_lamps(const aiScene& source, const AssimpTextures& textures, Scene& scene);

/// After AssimpTextures::finish(): materials whose colour texture has holes become alpha-masked, since these formats do
/// not say how they mean their alpha channel.
void mask_transparent_textures(const AssimpTextures& textures, Scene& scene);

}  // namespace relume
