#include "scene_io/mitsuba/mitsuba_xml.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <pugixml.hpp>

#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/mitsuba/mitsuba_transform.h"

namespace relume::mitsuba {
namespace {

constexpr int kMaxOpenFiles = 15;  // as in Mitsuba
constexpr size_t kMaxFiles = 1000;
constexpr uint64_t kMaxMarkup = uint64_t{1} << 23;
constexpr size_t kMaxParts = size_t{1} << 21;
constexpr size_t kMaxPartsOfOne = 100;  // of an object that holds no others of its kind
constexpr size_t kMaxParameterName = 100;
constexpr size_t kMaxValueBytes = size_t{1} << 20;
constexpr size_t kMaxSubstitutedBytes = size_t{1} << 27;
constexpr int kMaxDepth = 64;

constexpr std::array<std::string_view, 13> kObjectTags = {"scene",  "bsdf",    "shape",      "emitter", "sensor",
                                                          "film",   "sampler", "integrator", "texture", "rfilter",
                                                          "medium", "phase",   "volume"};

/// An Error that names its place.
class Located : public Error {
 public:
  using Error::Error;
};

bool is_object(const pugi::xml_node& element) {
  const std::string_view name = element.name();
  return std::find(kObjectTags.begin(), kObjectTags.end(), name) != kObjectTags.end() ||
         (name == "spectrum" && element.attribute("type"));
}

std::string attribute_of(const pugi::xml_node& element, const char* name) { return element.attribute(name).value(); }

/// Version before 2, whose names are in camelCase. Throws Error if it is no version.
bool is_old_version(const std::string& version) {
  const std::optional<double> major = parse_number(std::string_view(version).substr(0, version.find('.')));
  if (!major) throw Error(fmt::format("its version '{}' is no version, such as 3.0.0; correct it", version));
  return *major < 2;
}

/// Changes parameters of Mitsuba 0.6 as Mitsuba 3 does.
void upgrade(Object& object) {
  glm::dvec3 offset(0);
  glm::dvec3 scale(1);
  const auto take = [&](const char* name, double& target) {
    const auto found = std::find_if(object.properties.begin(), object.properties.end(),
                                    [&](const Property& property) { return property.name == name; });
    if (found == object.properties.end() || !std::holds_alternative<double>(found->value)) return 0;
    target = std::get<double>(found->value);
    object.properties.erase(found);
    return 1;
  };
  const int taken =
      take("uoffset", offset.x) + take("voffset", offset.y) + take("uscale", scale.x) + take("vscale", scale.y);
  if (taken > 0) object.properties.push_back({"to_uv", glm::translate(glm::scale(glm::dmat4(1), scale), offset)});
  if (object.type != "diffuse") return;
  for (Property& property : object.properties) {
    if (property.name == "diffuse_reflectance") property.name = "reflectance";
  }
  for (Child& child : object.children) {
    if (child.name == "diffuse_reflectance") child.name = "reflectance";
  }
}

}  // namespace

void Substitution::set_default(const std::string& name, std::string value) {
  if (name.size() > kMaxParameterName)
    throw Error(fmt::format("the name of a <default> is longer than {} bytes; shorten it", kMaxParameterName));
  values_.try_emplace(name, std::move(value));
}

std::string Substitution::apply(const std::string& text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == '$') {
      result += '$';
      ++i;
    } else if (text[i] != '$') {
      result += text[i];
    } else {
      // As in Mitsuba, the longest known name that the text continues with.
      const auto is_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
      size_t end = i + 1;
      while (end < text.size() && is_name(text[end])) ++end;
      const std::string name = text.substr(i + 1, end - i - 1);
      size_t length = std::min(name.size(), kMaxParameterName);
      auto known = values_.find(name.substr(0, length));
      while (known == values_.end() && length > 1) known = values_.find(name.substr(0, --length));
      if (known == values_.end())
        throw Error(fmt::format("the parameter '${}' has no value; add <default name=\"{}\" value=\"…\"/> before it",
                                name.substr(0, 80), name.substr(0, 80)));
      result += known->second;
      i += length;
    }
    if (result.size() > kMaxValueBytes) throw Error("parameters make a value longer than 1 MiB; shorten it");
  }
  substituted_bytes_ += text.size() + result.size();
  if (substituted_bytes_ > kMaxSubstitutedBytes)
    throw Error("parameters make the scene longer than 128 MiB; write their values out");
  return result;
}

size_t LineCounter::line_at(ptrdiff_t offset) {
  const size_t end = std::min(static_cast<size_t>(std::max<ptrdiff_t>(offset, 0)), text_.size());
  if (end < counted_) *this = LineCounter(text_);
  const std::string_view next = text_.substr(counted_, end - counted_);
  line_ += static_cast<size_t>(std::count(next.begin(), next.end(), '\n'));
  counted_ = end;
  return line_;
}

/// Throws Error before the parser allocates more for a file than its share of the scene.
void XmlReader::check_size(std::span<const std::byte> bytes, const std::string& name) {
  text_bytes_ += bytes.size();
  if (text_bytes_ > kMaxTextBytes)
    throw Error(fmt::format("{}: the scene has more than {} MiB of text; split it", name, kMaxTextBytes >> 20));
  markup_ += static_cast<uint64_t>(std::count_if(
      bytes.begin(), bytes.end(), [](std::byte byte) { return byte == std::byte{'<'} || byte == std::byte{'='}; }));
  if (markup_ > kMaxMarkup)
    throw Error(fmt::format("{}: the scene has more than {} elements and attributes; join meshes, or use instances",
                            name, kMaxMarkup));
}

void XmlReader::count_part(const Object* parent) {
  if (++parts_ > kMaxParts)
    throw Error(
        fmt::format("the scene has more than {} objects and parameters; join meshes, or use instances", kMaxParts));
  if (parent == nullptr || parent->tag == "scene" || parent->type == "shapegroup" || parent->type == "merge") return;
  if (parent->properties.size() + parent->children.size() >= kMaxPartsOfOne)
    throw Error(fmt::format("<{}> has more than {} parameters; remove some", parent->tag, kMaxPartsOfOne));
}

void XmlReader::read_file(std::span<const std::byte> bytes, const std::filesystem::path& folder,
                          const std::string& name, Object* parent) {
  check_size(bytes, name);
  if (document_.files.size() >= kMaxFiles)
    throw Error(fmt::format("{}: the scene includes more than {} files; join them", name, kMaxFiles));
  document_.files.push_back(name);
  LineCounter lines({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  Source source{document_.files.size() - 1, folder, false, &lines};
  pugi::xml_document xml;
  const pugi::xml_parse_result parsed = xml.load_buffer(bytes.data(), bytes.size());
  if (!parsed)
    throw Error(fmt::format("{}:{}: the XML is malformed ({}); correct it", name, lines.line_at(parsed.offset),
                            parsed.description()));
  pugi::xml_node root = xml.document_element();
  if (!is_object(root) || (parent == nullptr && std::string_view(root.name()) != "scene"))
    throw Error(fmt::format("{}: its root element is <{}>, not <scene>; of .xml files, only scenes of Mitsuba are read",
                            name, std::string_view(root.name()).substr(0, 80)));
  if (!root.attribute("version"))
    throw Error(fmt::format("{}: its root element <{}> has no version; only scenes of Mitsuba are read, which have one",
                            name, root.name()));
  try {
    source.is_old = is_old_version(attribute_of(root, "version"));
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", name, error.what()));
  }
  ++open_files_;
  if (parent == nullptr) {
    Object& scene = add_object(root, source, nullptr);
    scene.type = "scene";
    document_.root = &scene;
    read_children(root, source, scene, 0);
  } else if (std::string_view(root.name()) == "scene") {
    read_children(root, source, *parent, 0);
  } else {
    read_element(root, source, *parent, 0);
  }
  --open_files_;
}

void XmlReader::read_children(pugi::xml_node& element, const Source& source, Object& parent, int depth) {
  if (depth > kMaxDepth) throw Error(fmt::format("its elements nest deeper than {} levels; flatten them", kMaxDepth));
  for (pugi::xml_node child : element.children()) {
    if (child.type() != pugi::node_element) continue;
    try {
      read_element(child, source, parent, depth);
    } catch (const Located&) {
      throw;
    } catch (const Error& error) {
      throw Located(fmt::format("{}:{}: {}", document_.files[source.file], source.lines->line_at(child.offset_debug()),
                                error.what()));
    }
  }
}

void XmlReader::substitute(pugi::xml_node& element) {
  for (pugi::xml_attribute attribute : element.attributes()) {
    const std::string value = attribute.value();
    if (value.find('$') != std::string::npos) attribute.set_value(substitution_.apply(value).c_str());
  }
}

void XmlReader::read_element(pugi::xml_node& element, const Source& source, Object& parent, int depth) {
  substitute(element);
  if (is_object(element)) {
    read_object(element, source, parent, depth);
  } else if (!read_directive(element, source, parent)) {
    std::string name = attribute_of(element, "name");
    if (name.empty()) throw Error(fmt::format("<{}> has no name; add one", element.name()));
    if (source.is_old) name = underscore_name(name);
    count_part(&parent);
    Value value = std::string_view(element.name()) == "transform" ? transform_of(element) : value_of(element, source);
    parent.properties.push_back({std::move(name), std::move(value)});
  }
}

Object& XmlReader::add_object(const pugi::xml_node& element, const Source& source, const Object* parent) {
  count_part(parent);
  Object& object = document_.objects.emplace_back();
  object.tag = element.name();
  object.file = source.file;
  object.is_old = source.is_old;
  object.line = source.lines->line_at(element.offset_debug());
  return object;
}

void XmlReader::read_object(pugi::xml_node& element, const Source& source, Object& parent, int depth) {
  Object& object = add_object(element, source, &parent);
  object.type = attribute_of(element, "type");
  if (object.type.empty()) throw Error(fmt::format("<{}> has no type; add one", element.name()));
  object.id = attribute_of(element, "id");
  if (!object.id.empty() && !ids_.try_emplace(object.id, &object).second)
    throw Error(fmt::format("the id '{}' is used twice; rename one", object.id));
  std::string name = attribute_of(element, "name");
  if (source.is_old) name = underscore_name(name);
  parent.children.push_back({std::move(name), "", &object});
  read_children(element, source, object, depth + 1);
  if (source.is_old) upgrade(object);
}

bool XmlReader::read_directive(pugi::xml_node& element, const Source& source, Object& parent) {
  const std::string_view tag = element.name();
  if (tag == "ref") {
    std::string name = attribute_of(element, "name");
    if (source.is_old) name = underscore_name(name);
    count_part(&parent);
    parent.children.push_back({std::move(name), attribute_of(element, "id"), nullptr});
  } else if (tag == "default") {
    substitution_.set_default(attribute_of(element, "name"), attribute_of(element, "value"));
  } else if (tag == "include") {
    include(element, source, parent);
  } else if (tag == "alias") {
    const std::string id = attribute_of(element, "id");
    const std::string as = attribute_of(element, "as");
    const auto known = ids_.find(id);
    if (known == ids_.end())
      throw Error(fmt::format("the id '{}' of an alias is not defined before it; define it", id));
    if (!ids_.try_emplace(as, known->second).second)
      throw Error(fmt::format("the alias '{}' exists already; rename it", as));
  } else if (tag == "path") {
    if (!files_.add_folder(source.folder, attribute_of(element, "value")))
      warnings_.add(fmt::format("the folder '{}' of <path> is not below the scene file's folder and is ignored",
                                attribute_of(element, "value")));
  } else {
    return false;
  }
  return true;
}

void XmlReader::include(const pugi::xml_node& element, const Source& source, Object& parent) {
  const std::string reference = attribute_of(element, "filename");
  const std::optional<std::filesystem::path> file = files_.find(source.folder, reference);
  if (!file) throw Error(fmt::format("<include> of '{}' names no file; correct the path", reference.substr(0, 80)));
  if (open_files_ >= kMaxOpenFiles)
    throw Error(fmt::format("files include each other more than {} levels deep; remove the cycle", kMaxOpenFiles));
  try {
    const size_t before = parent.children.size();
    read_file(read_file_bytes(*file, kMaxTextBytes), file->parent_path(), file->string(), &parent);
    const std::string name = attribute_of(element, "name");
    if (!name.empty() && parent.children.size() == before + 1) parent.children.back().name = name;
  } catch (const Error& error) {
    throw Located(error.what());  // names the included file
  }
}

glm::dmat4 XmlReader::transform_of(pugi::xml_node& element) {
  glm::dmat4 transform(1);
  for (pugi::xml_node step : element.children()) {
    if (step.type() != pugi::node_element) continue;
    substitute(step);
    transform = transform_step(step) * transform;
  }
  return transform;
}

SpectrumText XmlReader::spectrum_of(const pugi::xml_node& element, const Source& source) {
  const std::string reference = attribute_of(element, "filename");
  std::optional<SpectrumText> spectrum;
  if (reference.empty()) {
    spectrum = parse_spectrum(attribute_of(element, "value"));
  } else if (const std::optional<std::filesystem::path> file = files_.find(source.folder, reference)) {
    const Bytes bytes = read_file_bytes(*file, kMaxTextBytes);
    check_size(bytes, file->string());
    spectrum = parse_spd({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  if (!spectrum)
    throw Error(fmt::format("the spectrum '{}' is neither a number nor pairs of increasing wavelengths and values",
                            attribute_of(element, reference.empty() ? "value" : "filename").substr(0, 80)));
  return *spectrum;
}

Value XmlReader::value_of(const pugi::xml_node& element, const Source& source) {
  const std::string_view tag = element.name();
  const std::string text = attribute_of(element, "value");
  const auto wrong = [&](const char* wanted) {
    return Error(fmt::format("the value '{}' of {} '{}' is not {}; correct it", std::string_view(text).substr(0, 80),
                             tag, attribute_of(element, "name"), wanted));
  };
  if (tag == "float") {
    if (const std::optional<double> number = parse_number(text)) return *number;
    throw wrong("a finite number");
  }
  if (tag == "integer") {
    if (const std::optional<int64_t> number = parse_integer(text)) return *number;
    throw wrong("an integer");
  }
  if (tag == "boolean") {
    std::string lower = text;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (lower == "true" || lower == "false") return lower == "true";
    throw wrong("true or false");
  }
  if (tag == "string") return text;
  if (tag == "point" || tag == "vector") return vector_of(element, 0);
  if (tag == "rgb" || tag == "srgb") {
    if (const std::optional<Rgb> color = parse_color(text)) return Color{*color};
    throw wrong("a colour: one or three numbers, or #rrggbb");
  }
  if (tag == "spectrum") return spectrum_of(element, source);
  throw Error(fmt::format("<{}> is no element of Mitsuba scenes; remove it", tag.substr(0, 80)));
}

}  // namespace relume::mitsuba
