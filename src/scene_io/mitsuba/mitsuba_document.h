// Mitsuba's XML as plugins with typed properties: parameters, includes, aliases and references are resolved.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <glm/mat4x4.hpp>

#include "scene_io/mitsuba/mitsuba_files.h"
#include "scene_io/mitsuba/mitsuba_values.h"
#include "scene_io/warnings.h"

namespace relume::mitsuba {

struct Color {
  Rgb rgb{0};
};

using Value = std::variant<bool, int64_t, double, std::string, Color, SpectrumText, glm::dvec3, glm::dmat4>;

struct Property {
  std::string name;
  Value value;
  mutable bool used = false;  ///< whether the reader uses it or ignores it deliberately
};

struct Object;

/// A plugin inside another one, or a reference to one.
struct Child {
  std::string name;  ///< name of the parameter; empty: none
  std::string reference;
  const Object* object = nullptr;  ///< never null after read_document()
  mutable bool used = false;
};

/// A plugin. Children are not cyclic, and nest at most kMaxNesting levels deep.
struct Object {
  std::string tag;   ///< "bsdf", "shape", …
  std::string type;  ///< "diffuse", "sphere", …; "scene" for the root
  std::string id;
  size_t file = 0;      ///< index in Document::files
  size_t line = 1;      ///< of its element in the file
  bool is_old = false;  ///< of a file before version 2
  std::vector<Property> properties;
  std::vector<Child> children;
  mutable bool read = false;  ///< whether the reader has met it
};

inline constexpr int kMaxNesting = 32;

/// Largest size of all texts of a scene together: its file, included files and spectra.
inline constexpr uint64_t kMaxTextBytes = uint64_t{1} << 28;

struct Document {
  std::deque<Object> objects;
  const Object* root = nullptr;
  std::vector<std::string> files;  ///< names

  /// "scene.xml:12"
  std::string place_of(const Object& object) const;
};

/// Reads a scene and the files that it includes. Throws Error for malformed XML, undefined parameters and references,
/// cycles, and content beyond the limits of a real scene.
Document read_document(std::span<const std::byte> file, Files& files, const std::string& place, Warnings& warnings);

}  // namespace relume::mitsuba
