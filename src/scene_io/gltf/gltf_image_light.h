// Imports cube maps of EXT_lights_image_based as the scene's environment.
#pragma once

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// Replaces the environment by the loaded scene's image-based light, if any. Level 0 is rotated and resampled to an
/// equirectangular map. Coarser levels and irradiance coefficients are ignored: they are for renderers without
/// integration. An unreadable light gives a warning and keeps the environment.
void import_image_light(Document& document, Scene& scene);

}  // namespace relume::gltf
