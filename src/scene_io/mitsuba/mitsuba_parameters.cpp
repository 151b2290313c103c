#include "scene_io/mitsuba/mitsuba_parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::mitsuba {

const Property* Parameters::find(const std::string& name) const {
  for (const Property& property : object_.properties) {
    if (property.name != name) continue;
    property.used = true;
    return &property;
  }
  return nullptr;
}

const Value* Parameters::value(const std::string& name) const {
  const Property* property = find(name);
  return property ? &property->value : nullptr;
}

void Parameters::fail(const std::string& problem) const {
  throw Error(fmt::format("{}: {}: {}", import_.document.place_of(object_), name_of(object_), problem));
}

double Parameters::number(const std::string& name, double fallback) const {
  const Value* value = this->value(name);
  if (!value) return fallback;
  if (const auto* number = std::get_if<double>(value)) return *number;
  if (const auto* integer = std::get_if<int64_t>(value)) return static_cast<double>(*integer);
  fail(fmt::format("'{}' is not a number; write <float name=\"{}\" value=\"…\"/>", name, name));
}

int64_t Parameters::integer(const std::string& name, int64_t fallback) const {
  const Value* value = this->value(name);
  if (!value) return fallback;
  if (const auto* integer = std::get_if<int64_t>(value)) return *integer;
  fail(fmt::format("'{}' is not an integer; write <integer name=\"{}\" value=\"…\"/>", name, name));
}

bool Parameters::boolean(const std::string& name, bool fallback) const {
  const Value* value = this->value(name);
  if (!value) return fallback;
  if (const auto* boolean = std::get_if<bool>(value)) return *boolean;
  fail(fmt::format("'{}' is neither true nor false; write <boolean name=\"{}\" value=\"…\"/>", name, name));
}

std::string Parameters::text(const std::string& name, const std::string& fallback) const {
  const Value* value = this->value(name);
  if (!value) return fallback;
  if (const auto* text = std::get_if<std::string>(value)) return *text;
  fail(fmt::format("'{}' is not a text; write <string name=\"{}\" value=\"…\"/>", name, name));
}

std::optional<glm::dvec3> Parameters::vector(const std::string& name) const {
  const Value* value = this->value(name);
  if (!value) return std::nullopt;
  if (const auto* vector = std::get_if<glm::dvec3>(value)) return *vector;
  fail(fmt::format("'{}' is not a vector; write <vector name=\"{}\" value=\"x, y, z\"/>", name, name));
}

std::optional<glm::dmat4> Parameters::transform(const std::string& name) const {
  const Value* value = this->value(name);
  if (!value) return std::nullopt;
  if (const auto* matrix = std::get_if<glm::dmat4>(value)) return *matrix;
  fail(fmt::format("'{}' is not a transform; write <transform name=\"{}\">", name, name));
}

const Object* Parameters::child(const std::string& name) const {
  for (const Child& child : object_.children) {
    if (child.name != name) continue;
    child.used = true;
    return child.object;
  }
  return nullptr;
}

std::vector<const Object*> Parameters::children(std::initializer_list<std::string_view> tags) const {
  std::vector<const Object*> found;
  for (const Child& child : object_.children) {
    if (std::find(tags.begin(), tags.end(), child.object->tag) == tags.end()) continue;
    child.used = true;
    found.push_back(child.object);
  }
  return found;
}

void Parameters::ignore(std::initializer_list<std::string_view> names) const {
  for (const Property& property : object_.properties) {
    if (std::find(names.begin(), names.end(), property.name) != names.end()) property.used = true;
  }
}

std::string name_of(const Object& object) { return fmt::format("{} '{}'", object.tag, object.type); }

void warn_about_unused(const Import& import) {
  for (const Object& object : import.document.objects) {
    if (!object.read) continue;
    for (const Property& property : object.properties) {
      if (!property.used)
        import.warnings.add(fmt::format("{}: its parameter '{}' is ignored", name_of(object), property.name));
    }
    for (const Child& child : object.children) {
      if (!child.used)
        import.warnings.add(
            fmt::format("{}: its {} is ignored", name_of(object),
                        child.name.empty() ? name_of(*child.object) : fmt::format("parameter '{}'", child.name)));
    }
  }
}

}  // namespace relume::mitsuba
