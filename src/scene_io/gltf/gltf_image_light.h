// EXT_lights_image_based: cube maps as the scene's environment.
#pragma once

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// Makes the image-based light of the scene that is loaded its environment, if it has one: the faces of level 0, turned
/// and resampled to an equirectangular map. Coarser levels and irradiance coefficients are for renderers that do not
/// integrate. A light that cannot be read gives a warning and leaves the environment as it is.
void import_image_light(Document& document, Scene& scene);

}  // namespace relume::gltf
