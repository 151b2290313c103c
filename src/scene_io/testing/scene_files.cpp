#include "scene_io/testing/scene_files.h"

#include <atomic>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <stb_image_write.h>
#include <unistd.h>

#include "scene_io/gltf/gltf_loader.h"

namespace relume::testing {
namespace {

const char* type_name(int components) {
  switch (components) {
    case 1: return "SCALAR";
    case 2: return "VEC2";
    case 3: return "VEC3";
    case 4: return "VEC4";
    case 16: return "MAT4";
    default: throw std::invalid_argument(fmt::format("no accessor has {} components", components));
  }
}

void append_u32(Bytes& bytes, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::byte>((value >> shift) & 0xffu));
}

void append_chunk(Bytes& glb, uint32_t type, Bytes payload, std::byte padding) {
  while (payload.size() % 4 != 0) payload.push_back(padding);
  append_u32(glb, static_cast<uint32_t>(payload.size()));
  append_u32(glb, type);
  glb.insert(glb.end(), payload.begin(), payload.end());
}

}  // namespace

SceneFolder::SceneFolder() {
  static std::atomic<int> counter{0};
  path_ = std::filesystem::temp_directory_path() /
          ("relume_scene_test_" + std::to_string(getpid()) + "_" + std::to_string(counter++));
  std::filesystem::create_directories(path_);
}

SceneFolder::~SceneFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path SceneFolder::write(const std::string& name, std::string_view content) const {
  const std::filesystem::path file = path_ / name;
  std::ofstream(file, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
  return file;
}

std::filesystem::path SceneFolder::write(const std::string& name, const Bytes& content) const {
  return write(name, std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
}

std::string encode_base64(const Bytes& bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = (bits << 8) | (i + k < bytes.size() ? std::to_integer<uint32_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kAlphabet[(bits >> (18 - 6 * k)) & 63u];
  }
  return text;
}

Bytes to_bytes(std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::string data_uri(const Bytes& bytes) { return "data:application/octet-stream;base64," + encode_base64(bytes); }

Bytes png(int width, int height, const std::vector<uint8_t>& rgba) {
  Bytes file;
  const auto append = [](void* context, void* data, int size) {
    const auto* first = static_cast<const std::byte*>(data);
    static_cast<Bytes*>(context)->insert(static_cast<Bytes*>(context)->end(), first, first + size);
  };
  stbi_write_png_to_func(append, &file, width, height, 4, rgba.data(), 4 * width);
  return file;
}

Bytes solid_png(int width, int height, uint8_t r, uint8_t g, uint8_t b, uint8_t a) {
  std::vector<uint8_t> texels;
  for (int i = 0; i < width * height; ++i) texels.insert(texels.end(), {r, g, b, a});
  return png(width, height, texels);
}

int GltfBuilder::add_view(const Bytes& bytes) {
  while (bin_.size() % 4 != 0) bin_.push_back(std::byte{0});
  const size_t offset = bin_.size();
  bin_.insert(bin_.end(), bytes.begin(), bytes.end());
  return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
}

int GltfBuilder::add_accessor(int view, size_t count, int components, int component_type, bool normalized) {
  json accessor = {
      {"bufferView", view}, {"count", count}, {"type", type_name(components)}, {"componentType", component_type}};
  if (normalized) accessor["normalized"] = true;
  return add("accessors", std::move(accessor));
}

int GltfBuilder::add(const char* list, json object) {
  if (!doc.contains(list)) doc[list] = json::array();
  doc[list].push_back(std::move(object));
  return static_cast<int>(doc[list].size()) - 1;
}

int GltfBuilder::add_root(json node) {
  const int index = add("nodes", std::move(node));
  doc["scenes"][0]["nodes"].push_back(index);
  return index;
}

int GltfBuilder::add_triangle(const json& extra) {
  const int positions = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  json primitive = {{"attributes", {{"POSITION", positions}}}};
  primitive.merge_patch(extra);
  return add("meshes", {{"primitives", json::array({primitive})}});
}

int GltfBuilder::add_triangle_with_material(json material) {
  const int index = add("materials", std::move(material));
  add_root({{"mesh", add_triangle({{"material", index}})}});
  return index;
}

std::string GltfBuilder::text() const {
  json copy = doc;
  if (!bin_.empty()) copy["buffers"] = json::array({{{"uri", data_uri(bin_)}, {"byteLength", bin_.size()}}});
  return copy.dump();
}

Bytes GltfBuilder::glb() const {
  json copy = doc;
  if (!bin_.empty()) copy["buffers"] = json::array({{{"byteLength", bin_.size()}}});
  Bytes chunks;
  append_chunk(chunks, 0x4e4f534a, to_bytes(copy.dump()), std::byte{' '});
  if (!bin_.empty()) append_chunk(chunks, 0x004e4942, bin_, std::byte{0});
  Bytes glb = to_bytes("glTF");
  append_u32(glb, 2);
  append_u32(glb, static_cast<uint32_t>(12 + chunks.size()));
  glb.insert(glb.end(), chunks.begin(), chunks.end());
  return glb;
}

Scene GltfBuilder::load() const { return load_text(text()); }

Scene load_text(const std::string& text) { return load_gltf_from_memory(to_bytes(text), "/nonexistent", "test.gltf"); }

bool mentions(const std::vector<std::string>& sentences, std::string_view part) {
  for (const std::string& sentence : sentences) {
    if (sentence.find(part) != std::string::npos) return true;
  }
  return false;
}

}  // namespace relume::testing
