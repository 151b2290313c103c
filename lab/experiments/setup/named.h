// Finds list elements by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume {

/// First element with this `name`. Throws Error with the existing names if there is none; `kind` is the word for an
/// element in its message, such as "contender".
template <typename List>
auto& named(List& list, std::string_view kind, std::string_view name) {
  std::vector<std::string> names;
  for (auto& element : list) {
    if (element.name == name) return element;
    names.emplace_back(element.name);
  }
  throw Error("there is no " + std::string(kind) + " '" + std::string(name) + "'" + suggestion(name, names));
}

}  // namespace relume
