// Reads relume's additions to glTF in `extras.relume` (docs/scenes.md), which gltf_writer.cpp writes.
#pragma once

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// "environment" and "settings" of the scene. Throws Error for invalid values.
void apply_scene_extras(const Document& document, Scene& scene);

/// "projection", "lens_radius" and "focus_distance"; values out of range are ignored.
void apply_camera_extras(const tinygltf::Value& extras, Camera& camera);
/// Parameters of the light's type that KHR_lights_punctual lacks.
void apply_light_extras(const tinygltf::Value& extras, PunctualLight& light);
/// "microfacet_model" and "cull_back_faces"; MaterialImporter reads "mix".
void apply_material_extras(const tinygltf::Value& extras, Material& material);
/// URI of the float image that replaces glTF's 8-bit image, whose precision or range is too low; empty: none.
std::string texture_image(const tinygltf::Value& extras);
/// Factor of alpha for images that are converted to roughness (gltf_specular_glossiness.h); negative: no conversion.
float texture_glossiness(const tinygltf::Value& extras);

}  // namespace relume::gltf
