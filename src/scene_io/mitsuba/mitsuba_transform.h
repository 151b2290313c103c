// Transforms in Mitsuba's XML.
#pragma once

#include <string>

#include <glm/mat4x4.hpp>

namespace pugi {
class xml_node;
}

namespace relume::mitsuba {

/// Matrix of a <translate>, <rotate>, <scale>, <lookat> or <matrix> element. Throws Error with the problem alone.
/// lookat maps +Z to the direction of view, +Y to `up` and +X to the left, as in Mitsuba.
glm::dmat4 transform_step(const pugi::xml_node& element);

/// Three numbers of an element's attribute `value` (one or three), or of its attributes x, y and z, where `fallback`
/// replaces missing ones. Throws Error with the problem alone.
glm::dvec3 vector_of(const pugi::xml_node& element, double fallback);

}  // namespace relume::mitsuba
