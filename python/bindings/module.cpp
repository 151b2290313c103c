// The extension module relume._core. The Python files of relume/ define the interface for users.
#include <cstring>

#include <pybind11/pybind11.h>

#include "images.h"
#include "interruptible.h"
#include "lab.h"
#include "relume/error.h"
#include "relume/version.h"
#include "scene.h"
#include "session.h"

namespace relume::python {
namespace {

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_input: return "invalid-input";
    case ErrorCode::invalid_handle: return "invalid-handle";
    case ErrorCode::not_found: return "not-found";
    case ErrorCode::not_supported: return "not-supported";
    case ErrorCode::io: return "io";
    case ErrorCode::device: return "device";
  }
  return "invalid-input";
}

/// Raises relume.Error for Error.
void translate(std::exception_ptr failure) {
  try {
    std::rethrow_exception(std::move(failure));
  } catch (const Error& error) {
    const py::object type = py::module_::import("relume._errors").attr("Error");
    const py::object message =
        py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(error.what(), static_cast<Py_ssize_t>(std::strlen(error.what())), "replace"));
    PyErr_SetObject(type.ptr(), type(message, name_of(error.code())).ptr());
  }
}

}  // namespace
}  // namespace relume::python

PYBIND11_MODULE(_core, module) {
  namespace python = relume::python;
  pybind11::register_exception_translator(&python::translate);
  module.def("end_workers", &python::end_workers);
  module.attr("__version__") = relume::version();
  python::define_materials(module);
  python::define_scene_parts(module);
  python::define_animation(module);
  python::define_scene_functions(module);
  python::define_images(module);
  python::define_settings(module);
  python::define_session(module);
  python::define_lab(module);
}
