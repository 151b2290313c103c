// Both directions share one list of fields per struct, so that they cannot differ.
#include "scene_io/assimp/imported_scene.h"

#include <concepts>
#include <cstring>
#include <optional>
#include <type_traits>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene/light_parameters.h"
#include "scene/material_parameters.h"

namespace relume {
namespace {

/// T or const T; the writer uses the latter.
template <typename T, typename U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

/// Types copied as bytes. Not for bool and enumerations, which do not allow every bit pattern.
template <typename T>
concept Plain = std::same_as<T, std::byte> ||
    (std::is_trivially_copyable_v<T> && !std::is_enum_v<T> && !std::same_as<T, bool>);

template <typename Archive>
void fields(Archive& archive, Is<Material> auto& m) {
  archive(m.name);
  for_each_parameter(m, [&](const MaterialParameter&, auto& value) { archive(value); });
}

template <typename Archive>
void fields(Archive& archive, Is<Mesh> auto& m) {
  archive(m.name, m.positions, m.normals, m.tangents, m.uv0, m.uv1, m.colors, m.triangles, m.material);
}

template <typename Archive>
void fields(Archive& archive, Is<PunctualLight> auto& l) {
  archive(l.name, l.type, l.intensity);
  for (const LightParameter& p : light_parameters()) archive(l.*p.member);
}

template <typename Archive>
void fields(Archive& archive, Is<Camera> auto& c) {
  archive(c.name, c.projection, c.fov_y_rad, c.half_height, c.aspect_ratio, c.lens_radius, c.focus_distance);
}

template <typename Archive>
void fields(Archive& archive, Is<Node> auto& n) {
  archive(n.name, n.parent, n.transform, n.matrix, n.meshes, n.instances, n.light, n.camera);
}

template <typename Archive>
void fields(Archive& archive, Is<TextureRequest> auto& t) {
  archive(t.recipe, t.wrap_u, t.wrap_v, t.first, t.second);
}

template <typename Archive>
void fields(Archive& archive, Is<EmbeddedImage> auto& image) {
  archive(image.width, image.height, image.bytes);
}

template <typename Archive>
void fields(Archive& archive, Is<ImportedScene> auto& i) {
  archive(i.problem, i.scene.name, i.scene.materials, i.scene.meshes, i.scene.lights, i.scene.cameras, i.scene.nodes,
          i.scene.warnings, i.textures, i.embedded, i.texture_lamps, i.files);
}

AlphaMode last_of(AlphaMode) { return AlphaMode::blend; }
WrapMode last_of(WrapMode) { return WrapMode::mirror; }
PunctualType last_of(PunctualType) { return light_types().back().type; }
Projection last_of(Projection) { return Projection::panoramic; }
MicrofacetModel last_of(MicrofacetModel) { return MicrofacetModel::beckmann; }
TextureRecipe last_of(TextureRecipe) { return TextureRecipe::normal; }

class Writer {
 public:
  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  void append(const void* data, size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  template <typename T>
  void put(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      append(&value, sizeof value);
    } else {
      fields(*this, value);
    }
  }
  void put(const std::string& text) {
    put(text.size());
    append(text.data(), text.size());
  }
  void put(const std::optional<Mat4>& matrix) {
    put(matrix.has_value());
    put(matrix.value_or(Mat4(1)));
  }
  template <typename T>
  void put(const std::vector<T>& list) {
    put(list.size());
    if constexpr (Plain<T>) {
      append(list.data(), list.size() * sizeof(T));
    } else {
      for (const T& value : list) put(value);
    }
  }
  void put(const std::map<std::string, EmbeddedImage>& images) {
    put(images.size());
    for (const auto& [path, image] : images) (*this)(path, image);
  }

  Bytes bytes_;
};

class Reader {
 public:
  Reader(std::span<const std::byte> bytes, const std::string& place) : bytes_(bytes), place_(place) {}

  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  void expect_end() const {
    if (!bytes_.empty()) fail();
  }
  [[noreturn]] void fail() const {
    throw Error(fmt::format(
        "{}: the process that reads the file returned damaged data; load the file again, or convert it to glTF",
        place_));
  }

 private:
  void extract(void* data, size_t size) {
    if (size > bytes_.size()) fail();
    if (size > 0) std::memcpy(data, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  /// Reads a number of elements that take at least `element_bytes` each.
  size_t get_count(size_t element_bytes) {
    size_t count = 0;
    get(count);
    if (count > bytes_.size() / element_bytes) fail();
    return count;
  }

  template <Plain T>
  void get(T& value) {
    extract(&value, sizeof value);
  }
  template <typename T>
  void get(T& value) {
    fields(*this, value);
  }
  template <typename T>
  requires std::is_enum_v<T>
  void get(T& value) {
    std::underlying_type_t<T> number;
    get(number);
    value = static_cast<T>(number);
    if (value > last_of(value)) fail();
  }
  void get(bool& value) {
    uint8_t byte;
    get(byte);
    value = byte != 0;
  }
  void get(std::string& text) {
    text.resize(get_count(1));
    extract(text.data(), text.size());
  }
  void get(std::optional<Mat4>& matrix) {
    bool has_value;
    Mat4 value;
    (*this)(has_value, value);
    matrix = has_value ? std::optional(value) : std::nullopt;
  }
  template <typename T>
  void get(std::vector<T>& list) {
    if constexpr (Plain<T>) {
      list.resize(get_count(sizeof(T)));
      extract(list.data(), list.size() * sizeof(T));
    } else {
      const size_t count = get_count(1);
      for (size_t i = 0; i < count; ++i) get(list.emplace_back());
    }
  }
  void get(std::map<std::string, EmbeddedImage>& images) {
    const size_t count = get_count(1);
    for (size_t i = 0; i < count; ++i) {
      std::string path;
      get(path);
      get(images[path]);
    }
  }

  std::span<const std::byte> bytes_;
  const std::string& place_;
};

/// Checks indices that are used before validate() runs on the finished scene.
bool refers_well(const ImportedScene& imported) {
  const auto in_range = [](Index i, size_t count) { return i >= 0 && static_cast<size_t>(i) < count; };
  const std::vector<Material>& materials = imported.scene.materials;
  for (const Material& material : materials) {
    for (const TextureRef* ref : texture_refs(material)) {
      if (ref->used() && !in_range(ref->texture, imported.textures.size())) return false;
    }
  }
  for (const Index lamp : imported.texture_lamps) {
    if (!in_range(lamp, materials.size()) || !materials[static_cast<size_t>(lamp)].emission_texture.used())
      return false;
  }
  return true;
}

}  // namespace

Bytes serialise(const ImportedScene& imported) {
  Writer writer;
  writer(imported);
  return writer.take();
}

ImportedScene deserialise(std::span<const std::byte> bytes, const std::string& place) {
  ImportedScene imported;
  Reader reader(bytes, place);
  reader(imported);
  reader.expect_end();
  if (!refers_well(imported)) reader.fail();
  return imported;
}

}  // namespace relume
