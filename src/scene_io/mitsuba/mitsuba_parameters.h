// Typed access to the parameters of Mitsuba's plugins.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "scene_io/mitsuba/mitsuba_document.h"

namespace relume::mitsuba {

/// What a reader shares between plugins.
struct Import {
  Document document;
  Files& files;
  Scene& scene;
  Warnings& warnings;
  glm::dmat4 turn{1};  ///< from the file's world to relume's; all nodes are below a node with this matrix
};

/// Use of a spectrum, which decides its colour as in Mitsuba's RGB modes.
enum class SpectrumUse {
  reflectance,  ///< below D65, clamped to [0, 1]
  light,        ///< clamped at 0
};

/// Parameters of one plugin, which must outlive this object. Parameters that are never read are reported at the end,
/// by warn_about_unused().
class Parameters {
 public:
  Parameters(const Import& import, const Object& object) : import_(import), object_(object) { object.read = true; }

  const Object& object() const { return object_; }
  bool has(const std::string& name) const { return find(name) != nullptr || child(name) != nullptr; }

  /// Value of a parameter, or `fallback`. Throw Error if its type is wrong.
  double number(const std::string& name, double fallback) const;
  int64_t integer(const std::string& name, int64_t fallback) const;
  bool boolean(const std::string& name, bool fallback) const;
  std::string text(const std::string& name, const std::string& fallback) const;
  std::optional<glm::dvec3> vector(const std::string& name) const;
  std::optional<glm::dmat4> transform(const std::string& name) const;

  /// Value of a parameter, whatever its type; nullptr if it is absent or a plugin.
  const Value* value(const std::string& name) const;
  /// Plugin given as a parameter; nullptr if none.
  const Object* child(const std::string& name) const;
  /// All plugins with one of these tags, in the order of the file.
  std::vector<const Object*> children(std::initializer_list<std::string_view> tags) const;

  /// Marks parameters as known although they have no effect on images.
  void ignore(std::initializer_list<std::string_view> names) const;

  /// Throws Error with the plugin's place.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  const Property* find(const std::string& name) const;

  const Import& import_;
  const Object& object_;
};

/// "bsdf 'plastic'"
std::string name_of(const Object& object);

/// Colour of a value; std::nullopt for values that are no spectra.
std::optional<Rgb> color_of(const Value& value, SpectrumUse use);
/// Colour of a plugin with a spectrum that is constant over surfaces (uniform, d65, blackbody, …); std::nullopt for
/// other plugins.
std::optional<Rgb> color_of(const Import& import, const Object& object, SpectrumUse use);

/// Colour of a parameter that is constant over surfaces, or `fallback`. A texture gives a warning and `fallback`.
Rgb color_parameter(const Import& import, const Parameters& parameters, const std::string& name, const Rgb& fallback,
                    SpectrumUse use);

/// Warns about parameters and plugins that no code has read.
void warn_about_unused(const Import& import);

}  // namespace relume::mitsuba
