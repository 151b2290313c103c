// Reads the elements of Mitsuba's XML files into a Document. read_document() then links their references.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "scene_io/mitsuba/mitsuba_document.h"

namespace pugi {
class xml_node;
class xml_attribute;
}  // namespace pugi

namespace relume::mitsuba {

/// Values of `$name` in attributes.
class Substitution {
 public:
  /// <default>: sets a parameter that has no value yet. Throws Error with the problem alone, for names that are too
  /// long.
  void set_default(const std::string& name, std::string value);

  /// Replaces each `$name` of `text`, and `\$` by `$`. Throws Error with the problem alone, for undefined parameters
  /// and for texts that grow beyond the limits.
  std::string apply(const std::string& text);

 private:
  std::map<std::string, std::string> values_;
  size_t substituted_bytes_ = 0;
};

/// Line numbers of a text. Calls with growing offsets read the text once.
class LineCounter {
 public:
  explicit LineCounter(std::string_view text) : text_(text) {}

  size_t line_at(ptrdiff_t offset);

 private:
  std::string_view text_;
  size_t counted_ = 0;  ///< bytes
  size_t line_ = 1;     ///< after these bytes
};

class XmlReader {
 public:
  XmlReader(Document& document, Files& files, Warnings& warnings)
      : document_(document), files_(files), warnings_(warnings) {}

  /// Reads a file's elements. Children of <scene> become children of `parent`; nullptr: the file's root becomes the
  /// document's.
  void read_file(std::span<const std::byte> bytes, const std::filesystem::path& folder, const std::string& name,
                 Object* parent);

  /// Objects by id, aliases included.
  const std::map<std::string, Object*>& ids() const { return ids_; }

 private:
  struct Source {
    size_t file;
    std::filesystem::path folder;
    bool is_old;  ///< camelCase names, before version 2
    LineCounter* lines;
  };

  void check_size(std::span<const std::byte> bytes, const std::string& name);
  void count_part(const Object* parent);
  void read_element(pugi::xml_node& element, const Source& source, Object& parent, int depth);
  void read_children(pugi::xml_node& element, const Source& source, Object& parent, int depth);
  void read_object(pugi::xml_node& element, const Source& source, Object& parent, int depth);
  bool read_directive(pugi::xml_node& element, const Source& source, Object& parent);
  void include(const pugi::xml_node& element, const Source& source, Object& parent);
  Object& add_object(const pugi::xml_node& element, const Source& source, const Object* parent);
  void substitute(pugi::xml_node& element);
  Value value_of(const pugi::xml_node& element, const Source& source);
  glm::dmat4 transform_of(pugi::xml_node& element);
  SpectrumText spectrum_of(const pugi::xml_node& element, const Source& source);

  Document& document_;
  Files& files_;
  Warnings& warnings_;
  Substitution substitution_;
  std::map<std::string, Object*> ids_;
  int open_files_ = 0;
  uint64_t text_bytes_ = 0;  ///< of all files
  uint64_t markup_ = 0;      ///< elements and attributes of all files
  size_t parts_ = 0;         ///< objects, properties and references
};

}  // namespace relume::mitsuba
