// Definitions of properties for the structs of relume's interface.
#pragma once

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "conversions.h"

namespace relume::python {

/// A struct that Python shares with lists: its address stays the same while any object refers to it.
template <typename T>
using Class = py::class_<T, std::shared_ptr<T>>;

/// Sets attributes from keyword arguments. Throws TypeError with the nearest name for unknown ones.
void set_attributes(const py::object& object, const py::kwargs& values);

/// Declares a struct with a constructor that takes its attributes as keyword arguments, copy() and repr().
template <typename T>
Class<T> keyword_class(py::module_& module, const char* name, const char* help) {
  Class<T> type(module, name, help);
  type.def(py::init([](const py::kwargs& values) {
    auto result = std::make_shared<T>();
    set_attributes(py::cast(result), values);
    return result;
  }));
  type.def("copy", [](const T& value) { return std::make_shared<T>(value); }, "An independent copy.");
  return type;
}

/// The value of an enum with that name. Throws Error that lists `names`.
template <typename Enum, size_t n>
Enum named(const std::array<std::string_view, n>& names, const std::string& text, const char* what, Enum) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<Enum>(found - names.begin());
  std::string known;
  for (const std::string_view name : names) known += (known.empty() ? "" : ", ") + std::string(name);
  throw Error(std::string(what) + " cannot be '" + text + "'; choose one of " + known);
}

/// A property whose values are the names of an enum's values, in order.
template <typename T, typename Enum, size_t n>
void choice(Class<T>& type, const char* name, Enum T::*member, const std::array<std::string_view, n>& names,
            const char* help) {
  type.def_property(
      name, [member, names](const T& value) { return std::string(names[static_cast<size_t>(value.*member)]); },
      [member, names, name](T& value, const std::string& text) { value.*member = named(names, text, name, Enum{}); },
      help);
}

/// A property that is an array of vectors or numbers. Reading gives a read-only copy.
template <typename Scalar, typename T, typename Element>
void array_property(Class<T>& type, const char* name, std::vector<Element> T::*member, const char* help) {
  type.def_property(
      name, [member](const T& value) { return copied_array<Scalar>(value.*member); },
      [member, name](T& value, const py::object& array) { value.*member = vector_from<Scalar, Element>(array, name); },
      help);
}

/// A property that is a list of numbers or strings. Reading gives a tuple.
template <typename T, typename Element>
void tuple_property(Class<T>& type, const char* name, std::vector<Element> T::*member, const char* help) {
  type.def_property(
      name,
      [member](const T& value) {
        py::tuple result((value.*member).size());
        for (size_t i = 0; i < result.size(); ++i) result[i] = py::cast((value.*member)[i]);
        return result;
      },
      [member](T& value, const py::iterable& elements) {
        std::vector<Element> result;
        for (const py::handle& element : elements) result.push_back(element.cast<Element>());
        value.*member = std::move(result);
      },
      help);
}

}  // namespace relume::python
