// A session with its rendering thread.
#pragma once

#include "conversions.h"

namespace relume::python {

void define_settings(py::module_& module);
void define_session(py::module_& module);
void define_session_edits(py::module_& module);

}  // namespace relume::python
