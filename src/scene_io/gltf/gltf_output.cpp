#include "scene_io/gltf/gltf_output.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "files/extension.h"
#include "relume/error.h"

namespace relume::gltf {
namespace {

constexpr int kFloat = 5126;  // component types of glTF
constexpr int kUnsignedByte = 5121;
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;

bool is_binary(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".glb") return true;
  if (extension == ".gltf") return false;
  throw Error(fmt::format("{}: scenes are written as glTF; give the file the extension .gltf or .glb", file.string()));
}

bool is_flat(const OutputJson& json) {
  return std::none_of(json.begin(), json.end(), [](const OutputJson& item) { return item.is_structured(); });
}

/// JSON on one line. U+FFFD replaces invalid UTF-8, which names from other formats may contain.
std::string text_of(const OutputJson& json) { return json.dump(-1, ' ', false, OutputJson::error_handler_t::replace); }

/// Appends JSON indented by one space per level, with arrays of plain values on one line.
void print(const OutputJson& json, size_t level, std::string& text) {
  if (!json.is_structured() || json.empty() || (json.is_array() && is_flat(json))) {
    text += text_of(json);
    return;
  }
  const bool object = json.is_object();
  text += object ? "{" : "[";
  for (auto it = json.begin(); it != json.end(); ++it) {
    text += it == json.begin() ? "\n" : ",\n";
    text.append(level + 1, ' ');
    if (object) text += text_of(it.key()) + ": ";
    print(*it, level + 1, text);
  }
  text += '\n';
  text.append(level, ' ');
  text += object ? '}' : ']';
}

void append_word(std::string& out, uint32_t word) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>(word >> (8 * i));
}

const char* type_name(int components) {
  constexpr const char* names[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return names[components - 1];
}

}  // namespace

std::string uri_of(const std::string& name) {
  std::string uri;
  for (const char c : name) {
    const bool plain =
        (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || std::strchr("-._~", c);
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

OutputJson number(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text - 1, value).ptr;
  *end = '\0';
  return std::strtod(text, nullptr);
}

OutputJson numbers(std::span<const float> values) {
  OutputJson list = OutputJson::array();
  for (const float value : values) list.push_back(number(value));
  return list;
}

Output::Output(const std::filesystem::path& file, std::vector<std::filesystem::path> sources)
    : file_(file), staged_(std::move(sources)), binary_(is_binary(file)) {
  root["asset"] = {{"version", "2.0"}, {"generator", "relume"}};
}

OutputJson& Output::list(const char* key) {
  OutputJson& result = root[key];
  if (result.is_null()) result = OutputJson::array();
  return result;
}

int Output::add(const char* key, OutputJson item) {
  OutputJson& target = list(key);
  target.push_back(std::move(item));
  return static_cast<int>(target.size()) - 1;
}

int Output::add_bytes(std::span<const std::byte> bytes, BufferTarget target) {
  bytes_.resize((bytes_.size() + 3) / 4 * 4);
  OutputJson view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
  if (target != BufferTarget::none) view["target"] = static_cast<int>(target);
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return add("bufferViews", std::move(view));
}

int Output::add_floats(std::span<const float> values, int components, BufferTarget target, bool bounds) {
  const auto stride = static_cast<size_t>(components);
  OutputJson accessor = {{"bufferView", add_bytes(std::as_bytes(values), target)},
                         {"componentType", kFloat},
                         {"count", values.size() / stride},
                         {"type", type_name(components)}};
  if (bounds) {
    std::vector<float> low(values.begin(), values.begin() + components);
    std::vector<float> high = low;
    for (size_t i = 0; i < values.size(); ++i) {
      low[i % stride] = std::min(low[i % stride], values[i]);
      high[i % stride] = std::max(high[i % stride], values[i]);
    }
    accessor["min"] = numbers(low);
    accessor["max"] = numbers(high);
  }
  return add("accessors", std::move(accessor));
}

int Output::add_joints(const std::vector<uint16_t>& joints) {
  return add("accessors", {{"bufferView", add_bytes(std::as_bytes(std::span(joints)), BufferTarget::vertices)},
                           {"componentType", kUnsignedShort},
                           {"count", joints.size() / 4},
                           {"type", "VEC4"}});
}

int Output::add_unsigned_bytes(const std::vector<uint8_t>& values) {
  return add("accessors", {{"bufferView", add_bytes(std::as_bytes(std::span(values)))},
                           {"componentType", kUnsignedByte},
                           {"count", values.size()},
                           {"type", "SCALAR"}});
}

int Output::add_matrices(const std::vector<Mat4>& matrices) {
  return add("accessors", {{"bufferView", add_bytes(std::as_bytes(std::span(matrices)))},
                           {"componentType", kFloat},
                           {"count", matrices.size()},
                           {"type", "MAT4"}});
}

int Output::add_indices(const std::vector<UVec3>& triangles, size_t vertex_count) {
  const std::span<const uint32_t> wide(&triangles.data()->x, 3 * triangles.size());
  const bool narrow = vertex_count <= 0xffff;  // 0xffff itself is reserved
  int view;
  if (narrow) {
    const std::vector<uint16_t> values(wide.begin(), wide.end());
    view = add_bytes(std::as_bytes(std::span(values)), BufferTarget::indices);
  } else {
    view = add_bytes(std::as_bytes(wide), BufferTarget::indices);
  }
  return add("accessors", {{"bufferView", view},
                           {"componentType", narrow ? kUnsignedShort : kUnsignedInt},
                           {"count", wide.size()},
                           {"type", "SCALAR"}});
}

void Output::use_extension(const std::string& name, bool required) {
  used_.insert(name);
  if (required) required_.insert(name);
}

std::string Output::add_file(const std::string& suffix,
                             const std::function<void(const std::filesystem::path&)>& write) {
  const std::filesystem::path target = file_.parent_path() / (file_.stem().string() + "." + suffix);
  staged_.write(target, write);
  return target.filename().string();
}

std::vector<std::string> Output::finish() {
  if (!used_.empty()) root["extensionsUsed"] = used_;
  if (!required_.empty()) root["extensionsRequired"] = required_;
  std::string text;
  if (!bytes_.empty()) {
    root["buffers"] = OutputJson::array({{{"byteLength", bytes_.size()}}});
    if (!binary_) {
      root["buffers"][0]["uri"] = uri_of(add_file("bin", [&](const std::filesystem::path& file) {
        AtomicFile out(file);
        out.write(bytes_);
        out.commit();
      }));
    }
  }
  staged_.write(file_, [&](const std::filesystem::path& file) {
    if (binary_) return write_glb(file, text_of(root));
    print(root, 0, text);
    write_file(file, text + "\n");
  });
  staged_.commit();
  return std::move(warnings_);
}

/// glTF 2.0, §4: header, JSON chunk padded with spaces, binary chunk padded with zeros.
void Output::write_glb(const std::filesystem::path& file, const std::string& text) const {
  const size_t json_size = (text.size() + 3) / 4 * 4;
  const size_t binary_size = (bytes_.size() + 3) / 4 * 4;
  const size_t total = 12 + 8 + json_size + (bytes_.empty() ? 0 : 8 + binary_size);
  if (total > 0xffffffffu)
    throw Error(fmt::format("{}: {} bytes are more than a .glb can hold (4 GiB); write .gltf instead", place(), total));
  std::string head;
  append_word(head, 0x46546c67);  // "glTF"
  append_word(head, 2);
  append_word(head, static_cast<uint32_t>(total));
  append_word(head, static_cast<uint32_t>(json_size));
  append_word(head, 0x4e4f534a);  // "JSON"
  head += text;
  head.append(json_size - text.size(), ' ');
  AtomicFile out(file);
  if (!bytes_.empty()) {
    append_word(head, static_cast<uint32_t>(binary_size));
    append_word(head, 0x004e4942);  // "BIN\0"
  }
  out.write(std::as_bytes(std::span(head)));
  out.write(bytes_);
  out.write(std::vector<std::byte>(binary_size - bytes_.size()));
  out.commit();
}

}  // namespace relume::gltf
