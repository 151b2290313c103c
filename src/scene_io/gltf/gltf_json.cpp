#include "scene_io/gltf/gltf_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/json_parse.h"
#include "relume/error.h"
#include "scene/material_parameters.h"
#include "scene_io/gltf/gltf_specular_glossiness.h"

namespace relume::gltf {
namespace {

using nlohmann::json;

/// Beside those of single material parameters.
constexpr std::string_view kOtherExtensions[] = {"KHR_materials_emissive_strength",
                                                 "KHR_materials_pbrSpecularGlossiness",
                                                 "KHR_materials_unlit",
                                                 "KHR_materials_variants",
                                                 "KHR_texture_transform",
                                                 "KHR_texture_basisu",
                                                 "EXT_texture_webp",
                                                 "KHR_lights_punctual",
                                                 "EXT_lights_image_based",
                                                 "KHR_mesh_quantization",
                                                 "KHR_draco_mesh_compression",
                                                 "KHR_node_visibility",
                                                 "KHR_animation_pointer",
                                                 "EXT_mesh_gpu_instancing",
                                                 "EXT_meshopt_compression"};

/// Without these a scene looks plainer but keeps its shape: files that require them are read, with a warning.
constexpr std::string_view kDecorativeExtensions[] = {"KHR_xmp", "KHR_xmp_json_ld"};

constexpr std::array<std::string_view, 13> kTopLevelLists = {
    "accessors", "animations", "buffers",  "bufferViews", "cameras", "images",  "materials",
    "meshes",    "nodes",      "samplers", "scenes",      "skins",   "textures"};

/// tinygltf wants integers without a fraction (3), but JSON lets writers say 3.0. Applications' own `extras` stay as
/// they are. In extensions tinygltf keeps 32 bits of an integer, so that larger numbers stay real.
void make_integers(json& value, double largest) {
  constexpr double kLargestInExtensions = std::numeric_limits<int32_t>::max();
  if (value.is_object()) {
    for (auto& [key, member] : value.items()) {
      if (key != "extras") make_integers(member, key == "extensions" ? kLargestInExtensions : largest);
    }
  } else if (value.is_array()) {
    for (json& element : value) make_integers(element, largest);
  } else if (value.is_number_float()) {
    const auto number = value.get<double>();
    const bool is_integer = std::abs(number) <= largest && number == std::floor(number);
    if (!is_integer || (number == 0 && std::signbit(number))) return;
    if (number < 0) {
      value = static_cast<int64_t>(number);
    } else {
      value = static_cast<uint64_t>(number);
    }
  }
}

void check_structure(const json& root, const std::string& place) {
  if (!root.is_object()) throw Error(fmt::format("{}: the JSON is not an object; this is not a glTF file", place));
  const auto asset = root.find("asset");
  if (asset == root.end() || !asset->is_object() || !asset->contains("version") || !(*asset)["version"].is_string())
    throw Error(fmt::format("{}: asset.version is missing; this is not a glTF 2.0 file", place));
  const auto version = (*asset)["version"].get<std::string>();
  if (!version.starts_with("2."))
    throw Error(fmt::format("{}: glTF version {} is not supported; convert the file to 2.0", place, version));
  for (const std::string_view name : kTopLevelLists) {
    const auto list = root.find(name);
    if (list == root.end()) continue;
    if (!list->is_array()) throw Error(fmt::format("{}: '{}' is not a list; the file is not valid glTF", place, name));
    for (size_t i = 0; i < list->size(); ++i) {
      if (!(*list)[i].is_object())
        throw Error(fmt::format("{}: {}[{}] is not an object; the file is not valid glTF", place, name, i));
    }
  }
}

void check_required_extensions(const json& root, const std::string& place) {
  const auto required = root.find("extensionsRequired");
  if (required == root.end() || !required->is_array()) return;
  for (const json& name : *required) {
    if (!name.is_string()) continue;
    const std::string_view* end = std::end(kDecorativeExtensions);
    const bool is_decorative = std::find(std::begin(kDecorativeExtensions), end, name.get<std::string>()) != end;
    if (!is_decorative && !is_supported_extension(name.get<std::string>()))
      throw Error(fmt::format("{}: the file requires the extension {}, which is not supported; export it without",
                              place, name.get<std::string>()));
  }
}

std::string string_member(const json& object, const char* key) {
  const auto it = object.find(key);
  return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
}

bool is_fallback(const json& buffer) {
  const json::json_pointer flag("/extensions/EXT_meshopt_compression/fallback");
  return buffer.contains(flag) && buffer[flag].is_boolean() && buffer[flag].get<bool>();
}

std::vector<BufferEntry> take_buffers(json& root, const std::string& place) {
  std::vector<BufferEntry> buffers;
  const auto list = root.find("buffers");
  if (list == root.end()) return buffers;
  for (const json& buffer : *list) {
    const auto length = buffer.find("byteLength");
    if (length == buffer.end() || !length->is_number_unsigned())
      throw Error(fmt::format("{}: buffers[{}].byteLength is missing or not a number; the file is not valid glTF",
                              place, buffers.size()));
    buffers.push_back({string_member(buffer, "uri"), length->get<uint64_t>(), is_fallback(buffer)});
  }
  root.erase(list);
  return buffers;
}

std::vector<ImageEntry> take_images(json& root) {
  std::vector<ImageEntry> images;
  const auto list = root.find("images");
  if (list == root.end()) return images;
  for (const json& image : *list) {
    ImageEntry entry{string_member(image, "name"), string_member(image, "uri"), -1};
    const auto view = image.find("bufferView");
    if (view != image.end() && view->is_number_unsigned())
      entry.buffer_view = static_cast<int>(std::min<uint64_t>(view->get<uint64_t>(), 0x7fffffff));
    images.push_back(std::move(entry));
  }
  root.erase(list);
  return images;
}

/// extras.relume of the default scene, or the first.
std::string scene_extras(const json& root) {
  const auto scenes = root.find("scenes");
  if (scenes == root.end() || !scenes->is_array()) return {};
  const auto chosen = root.find("scene");
  const size_t index = chosen != root.end() && chosen->is_number_unsigned() ? chosen->get<size_t>() : 0;
  if (index >= scenes->size() || !(*scenes)[index].is_object()) return {};
  const json& scene = (*scenes)[index];
  const auto extras = scene.find("extras");
  if (extras == scene.end() || !extras->is_object() || !extras->contains("relume")) return {};
  return extras->at("relume").dump();
}

/// tinygltf refuses index accessors without a buffer view, which Draco and sparse accessors have: they get an
/// additional one.
int add_placeholder_view(json& root) {
  json& views = root["bufferViews"];
  if (views.is_null()) views = json::array();
  const int placeholder = static_cast<int>(views.size());
  views.push_back({{"buffer", 0}, {"byteLength", 0}});
  const auto accessors = root.find("accessors");
  if (accessors != root.end()) {
    for (json& accessor : *accessors) {
      if (!accessor.contains("bufferView")) accessor["bufferView"] = placeholder;
    }
  }
  return placeholder;
}

/// tinygltf drops channels without a node, which those of KHR_animation_pointer have not: they get one that does not
/// exist.
void add_missing_nodes(json& root) {
  const auto animations = root.find("animations");
  if (animations == root.end()) return;
  for (json& animation : *animations) {
    const auto channels = animation.find("channels");
    if (channels == animation.end() || !channels->is_array()) continue;
    for (json& channel : *channels) {
      if (!channel.is_object() || !channel.contains("target") || !channel["target"].is_object()) continue;
      if (!channel["target"].contains("node")) channel["target"]["node"] = -1;
    }
  }
}

}  // namespace

std::vector<std::string_view> supported_extensions() {
  std::vector<std::string_view> names;
  for (const MaterialParameter& p : material_parameters()) {
    if (p.gltf.extension && std::find(names.begin(), names.end(), p.gltf.extension) == names.end())
      names.emplace_back(p.gltf.extension);
  }
  names.insert(names.end(), std::begin(kOtherExtensions), std::end(kOtherExtensions));
  return names;
}

bool is_supported_extension(std::string_view name) {
  const std::vector<std::string_view> names = supported_extensions();
  return std::find(names.begin(), names.end(), name) != names.end();
}

PreparedJson prepare_json(std::string_view json_text, const std::string& place) {
  json root = parse_json(json_text, place);
  constexpr double kLargestExact = 9007199254740992;  // 2^53
  make_integers(root, kLargestExact);
  check_structure(root, place);
  check_required_extensions(root, place);
  PreparedJson prepared;
  convert_specular_glossiness(root);
  prepared.buffers = take_buffers(root, place);
  prepared.images = take_images(root);
  prepared.scene_extras = scene_extras(root);
  prepared.no_buffer_view = add_placeholder_view(root);
  add_missing_nodes(root);
  root.erase("extras");
  prepared.text = root.dump();
  return prepared;
}

}  // namespace relume::gltf
