// What relume adds to glTF in `extras.relume` (docs/scenes.md), read back: gltf_writer.cpp writes it.
#pragma once

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// "environment" and "settings" of the scene. Throws Error for values that make no sense.
void apply_scene_extras(const Document& document, Scene& scene);

/// "projection", "lens_radius" and "focus_distance"; what is out of range is ignored.
void apply_camera_extras(const tinygltf::Value& extras, Camera& camera);
/// The parameters of the light's type that KHR_lights_punctual does not have.
void apply_light_extras(const tinygltf::Value& extras, PunctualLight& light);
/// "microfacet_model" and "cull_back_faces".
void apply_material_extras(const tinygltf::Value& extras, Material& material);
/// URI of the image whose texels are too precise or too bright for glTF's own; empty: none.
std::string texture_image(const tinygltf::Value& extras);
/// Factor of the alpha of an image whose texels become roughness (gltf_specular_glossiness.h); negative: they do not.
float texture_glossiness(const tinygltf::Value& extras);

}  // namespace relume::gltf
