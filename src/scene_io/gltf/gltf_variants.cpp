#include "scene_io/gltf/gltf_variants.h"

#include <fmt/format.h>

#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

constexpr const char* kExtension = "KHR_materials_variants";

/// Elements of the extension's list at `key`; empty if it is not a list.
std::vector<tinygltf::Value> elements(const tinygltf::ExtensionMap& extensions, const char* key) {
  const auto extension = extensions.find(kExtension);
  if (extension == extensions.end() || !extension->second.IsObject() || !extension->second.Has(key)) return {};
  const tinygltf::Value& list = extension->second.Get(key);
  return list.IsArray() ? list.Get<tinygltf::Value::Array>() : std::vector<tinygltf::Value>();
}

}  // namespace

std::vector<std::string> variant_names(const Document& document) {
  std::vector<std::string> names;
  for (const tinygltf::Value& variant : elements(document.model.extensions, "variants")) {
    const std::string name = string_member(variant, "name");
    names.push_back(name.empty() ? fmt::format("variant {}", names.size()) : name);
  }
  return names;
}

std::vector<VariantMaterial> import_variants(Document& document, const tinygltf::Primitive& primitive,
                                             const std::string& mesh, size_t variant_count,
                                             MaterialImporter& materials) {
  std::vector<VariantMaterial> result;
  for (const tinygltf::Value& mapping : elements(primitive.extensions, "mappings")) {
    if (!mapping.IsObject() || !mapping.Has("variants") || !mapping.Get("variants").IsArray()) continue;
    const int number = integer_member(mapping, "material", -1);
    if (number < 0 || static_cast<size_t>(number) >= document.model.materials.size()) {
      document.warnings.add(fmt::format(
          "mesh '{}' has variants with material {}, which does not exist; they keep the default", mesh, number));
      continue;
    }
    const Index material = materials.import(number);
    for (const tinygltf::Value& variant : mapping.Get("variants").Get<tinygltf::Value::Array>()) {
      const int index = variant.IsInt() ? variant.GetNumberAsInt() : -1;
      if (index >= 0 && static_cast<size_t>(index) < variant_count) {
        result.push_back({index, material});
        continue;
      }
      document.warnings.add(fmt::format("mesh '{}' has a material for variant {}, but the file has {}; it is ignored",
                                        mesh, index, variant_count));
    }
  }
  return result;
}

}  // namespace relume::gltf
