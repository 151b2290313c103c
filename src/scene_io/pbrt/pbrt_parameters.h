// Parameter lists of pbrt's directives: "TYPE NAME" [ values ].
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/bytes.h"
#include "scene/scene.h"
#include "scene_io/pbrt/pbrt_tokens.h"
#include "scene_io/spectra/color_space.h"
#include "scene_io/warnings.h"

namespace relume::pbrt {

struct Parameter {
  std::string type;
  std::string name;
  Location where;
  ColorSpace space = ColorSpace::srgb;  ///< of "rgb" values
  std::vector<double> numbers;          ///< of all types but strings; booleans are 0 or 1
  std::vector<std::string> strings;
  mutable bool used = false;
};

using ParameterList = std::vector<Parameter>;
/// Shares its elements, so that a copy is cheap.
using DefaultList = std::vector<std::shared_ptr<const Parameter>>;

/// Reads parameters up to the next token that is not a quoted string. Throws Error.
ParameterList parse_parameters(Tokens& tokens, ColorSpace space);

/// A directive's parameters, before the defaults that Attribute directives set.
class Parameters {
 public:
  Parameters() = default;
  Parameters(Location where, ParameterList own, std::shared_ptr<const DefaultList> defaults = nullptr)
      : where_(where), own_(std::move(own)), defaults_(std::move(defaults)) {}

  const Location& where() const { return where_; }

  /// First parameter of that name and of one of the types; nullptr if there is none.
  const Parameter* find(std::string_view name, std::initializer_list<std::string_view> types) const;

  /// Values, or `otherwise` if there are none. Numbers beyond float's range become infinite.
  float number(std::string_view name, float otherwise) const;
  int integer(std::string_view name, int otherwise) const;
  bool boolean(std::string_view name, bool otherwise) const;
  std::string string(std::string_view name, const std::string& otherwise = {}) const;
  Vec3 point(std::string_view name, const Vec3& otherwise) const;
  /// All values of a list; empty if there are none.
  std::vector<double> numbers(std::string_view name) const;
  std::vector<std::string> strings(std::string_view name) const;
  /// Values in groups of 2 or 3. Throws Error if the last group is incomplete.
  std::vector<Vec2> vectors2(std::string_view name) const;
  std::vector<Vec3> vectors3(std::string_view name) const;

  /// Warns about own parameters that nothing has looked up. `owner` names the directive.
  void warn_of_unused(const std::string& owner, Warnings& warnings) const;

 private:
  template <typename V>
  std::vector<V> vectors(std::string_view name, std::initializer_list<std::string_view> types) const;

  Location where_;
  ParameterList own_;
  std::shared_ptr<const DefaultList> defaults_;
};

/// Bytes of a file that a directive refers to. Throws Error that begins with the directive's place.
Bytes read_reference(const std::filesystem::path& file, const Location& where);

/// As float; values beyond its range become infinite.
float narrow(double value);

}  // namespace relume::pbrt
