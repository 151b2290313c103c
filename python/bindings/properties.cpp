#include "properties.h"

namespace relume::python {

void set_attributes(const py::object& object, const py::kwargs& values) {
  for (const auto& [key, value] : values) {
    if (!py::hasattr(object, key)) {
      const std::string type = py::str(py::type::of(object).attr("__name__"));
      const py::object near = py::module_::import("relume._names").attr("suggestion")(key, object.attr("__dir__")());
      throw py::type_error(type + " has no attribute '" + std::string(py::str(key)) + "'" + std::string(py::str(near)));
    }
    try {
      py::setattr(object, key, value);
    } catch (py::error_already_set& failure) {
      // pybind11 raises these for unsuitable values; errors of relume derive from RuntimeError.
      if (!failure.type().is(py::handle(PyExc_TypeError)) && !failure.type().is(py::handle(PyExc_RuntimeError))) throw;
      throw py::type_error(std::string(py::str(py::type::of(object).attr("__name__"))) + "." + std::string(py::str(key)) +
                           " cannot be " + std::string(py::repr(value)));
    }
  }
}

}  // namespace relume::python
