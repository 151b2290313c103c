#include "scene_io/mitsuba/mitsuba_transform.h"

#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <pugixml.hpp>

#include "relume/error.h"
#include "scene_io/mitsuba/mitsuba_values.h"

namespace relume::mitsuba {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

double number_of(const pugi::xml_attribute& attribute, double fallback) {
  if (!attribute) return fallback;
  const std::optional<double> number = parse_number(attribute.value());
  if (!number) throw Error(fmt::format("'{}' is not a finite number", attribute.value()));
  return *number;
}

glm::dvec3 triple_of(const pugi::xml_attribute& attribute) {
  const std::optional<std::vector<double>> numbers = parse_numbers(attribute.value());
  if (!numbers || numbers->size() != 3)
    throw Error(fmt::format("'{}' is not a list of three numbers", attribute.value()));
  return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

glm::dmat4 rotation(const pugi::xml_node& element) {
  const glm::dvec3 axis = vector_of(element, 0);
  if (!(glm::length(axis) > 0)) throw Error("the axis of a rotation is zero");
  return glm::rotate(glm::dmat4(1), number_of(element.attribute("angle"), 0) * kRadiansPerDegree, axis);
}

/// Any direction that is not parallel to the unit vector `direction`.
glm::dvec3 some_up(const glm::dvec3& direction) {
  return std::fabs(direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
}

glm::dmat4 look_at(const pugi::xml_node& element) {
  const glm::dvec3 origin = triple_of(element.attribute("origin"));
  const glm::dvec3 to_target = triple_of(element.attribute("target")) - origin;
  if (!(glm::length(to_target) > 0)) throw Error("the origin and target of <lookat> are equal");
  const glm::dvec3 direction = glm::normalize(to_target);
  const pugi::xml_attribute given_up = element.attribute("up");
  glm::dvec3 up = given_up ? triple_of(given_up) : glm::dvec3(0);
  if (!(glm::length(up) > 0)) up = some_up(direction);
  glm::dvec3 left = glm::cross(up, direction);
  if (!(glm::length(left) > 1e-9 * glm::length(up))) throw Error("<lookat> looks along its up vector");
  left = glm::normalize(left);
  return {glm::dvec4(left, 0), glm::dvec4(glm::cross(direction, left), 0), glm::dvec4(direction, 0),
          glm::dvec4(origin, 1)};
}

/// Nine or sixteen numbers, row by row.
glm::dmat4 matrix_of(const pugi::xml_node& element) {
  const std::optional<std::vector<double>> numbers = parse_numbers(element.attribute("value").value());
  if (!numbers || (numbers->size() != 16 && numbers->size() != 9))
    throw Error("<matrix> needs a list of 9 or 16 numbers");
  const size_t side = numbers->size() == 16 ? 4 : 3;
  glm::dmat4 matrix(1);
  for (size_t row = 0; row < side; ++row) {
    for (size_t column = 0; column < side; ++column)
      matrix[static_cast<int>(column)][static_cast<int>(row)] = (*numbers)[row * side + column];
  }
  return matrix;
}

}  // namespace

glm::dvec3 vector_of(const pugi::xml_node& element, double fallback) {
  if (const pugi::xml_attribute value = element.attribute("value")) {
    const std::optional<std::vector<double>> numbers = parse_numbers(value.value());
    if (!numbers || (numbers->size() != 1 && numbers->size() != 3))
      throw Error(fmt::format("'{}' is neither one number nor three", value.value()));
    if (numbers->size() == 1) return glm::dvec3((*numbers)[0]);
    return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  }
  return {number_of(element.attribute("x"), fallback), number_of(element.attribute("y"), fallback),
          number_of(element.attribute("z"), fallback)};
}

glm::dmat4 transform_step(const pugi::xml_node& element) {
  const std::string_view name = element.name();
  if (name == "translate") return glm::translate(glm::dmat4(1), vector_of(element, 0));
  if (name == "scale") return glm::scale(glm::dmat4(1), vector_of(element, 1));
  if (name == "rotate") return rotation(element);
  if (name == "matrix") return matrix_of(element);
  if (name == "lookat" || name == "lookAt") return look_at(element);
  throw Error(fmt::format("<{}> is no transform; use translate, rotate, scale, lookat or matrix", name));
}

}  // namespace relume::mitsuba
