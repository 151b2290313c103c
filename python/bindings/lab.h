// Metrics, comparisons and experiments.
#pragma once

#include "conversions.h"

namespace relume::python {

void define_lab(py::module_& module);

}  // namespace relume::python
