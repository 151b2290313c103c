// Scenes between Python and C++.
#pragma once

#include <string>

#include "conversions.h"
#include "relume/scene.h"

namespace relume::python {

/// A relume.Scene with the parts of `scene`.
py::object scene_to_python(Scene&& scene);
/// Copies a relume.Scene. Throws Error for parts of the wrong type.
Scene scene_from_python(const py::object& source);

/// Name of a scene in messages.
inline std::string scene_place(const Scene& scene) { return scene.name.empty() ? "scene" : scene.name; }

void define_scene_functions(py::module_& module);
void define_scene_parts(py::module_& module);
void define_materials(py::module_& module);
void define_animation(py::module_& module);

}  // namespace relume::python
