// Imports KHR_materials_variants: named choices of materials.
#pragma once

#include <string>
#include <vector>

#include "scene_io/gltf/gltf_materials.h"

namespace relume::gltf {

/// Names of the file's variants; unnamed ones are numbered.
std::vector<std::string> variant_names(const Document& document);

/// Materials of a primitive of `mesh` in `variant_count` variants. Mappings with other variants or missing materials
/// are ignored with a warning.
std::vector<VariantMaterial> import_variants(Document& document, const tinygltf::Primitive& primitive,
                                             const std::string& mesh, size_t variant_count,
                                             MaterialImporter& materials);

}  // namespace relume::gltf
