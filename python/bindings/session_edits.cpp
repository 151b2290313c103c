// Changes of a session's scene between frames.
#include <pybind11/operators.h>

#include "properties.h"
#include "session.h"
#include "session_state.h"

namespace relume::python {
namespace {

/// Declares an opaque handle.
template <typename Part>
void define_handle(py::module_& module, const char* name) {
  py::class_<Handle<Part>>(module, name, "A part of a session's scene.")
      .def(py::init([](Index index) { return Handle<Part>(index); }))
      .def_readonly("index", &Handle<Part>::index, "In the scene's list of such parts.")
      .def(py::self == py::self)
      .def("__hash__", [](const Handle<Part>& handle) { return py::hash(py::make_tuple(handle.index, handle.session)); })
      .def("__repr__", [name](const Handle<Part>& handle) {
        return "<relume." + std::string(name) + " " + std::to_string(handle.index) + ">";
      });
  py::implicitly_convertible<Index, Handle<Part>>();
}

}  // namespace

void define_session_edits(py::module_& module) {
  define_handle<Node>(module, "NodeHandle");
  define_handle<Mesh>(module, "MeshHandle");
  define_handle<Material>(module, "MaterialHandle");
  define_handle<PunctualLight>(module, "LightHandle");
  auto type = py::reinterpret_borrow<SessionClass>(module.attr("SessionCore"));
  type.def("set_time", [](PythonSession& s, float time_s) { s.change().set_time(time_s); });
  type.def("set_camera", [](PythonSession& s, const CameraPose* camera) {
    s.change().set_camera(camera ? std::optional<CameraPose>(*camera) : std::nullopt);
  });
  type.def("camera", [](PythonSession& s) { return std::make_shared<CameraPose>(s.read().camera()); });
  type.def("set_transform", [](PythonSession& s, const NodeHandle& node, const Transform& transform) {
    s.change().set_transform(node, transform);
  });
  type.def("set_light", [](PythonSession& s, const LightHandle& light, const PunctualLight& value) {
    s.change().set_light(light, value);
  });
  type.def("set_environment",
           [](PythonSession& s, const Environment& environment) { s.change().set_environment(environment); });
  type.def("set_material", [](PythonSession& s, const MaterialHandle& material, const Material& value) {
    s.change().set_material(material, value);
  });
  type.def("add_material", [](PythonSession& s, const Material& part) { return s.change().add_material(part); });
  type.def("add_mesh", [](PythonSession& s, const Mesh& part) { return s.change().add_mesh(part); });
  type.def("add_light", [](PythonSession& s, const PunctualLight& part) { return s.change().add_light(part); });
  type.def("add_node", [](PythonSession& s, const Node& part) { return s.change().add_node(part); });
  // Without conversion: a number does not say which kind of part it names.
  const auto part = py::arg("part").noconvert();
  type.def("remove", [](PythonSession& s, const NodeHandle& node) { s.change().remove(node); }, part);
  type.def("remove", [](PythonSession& s, const MeshHandle& mesh) { s.change().remove(mesh); }, part);
  type.def("remove", [](PythonSession& s, const LightHandle& light) { s.change().remove(light); }, part);
  type.def("find_node", [](PythonSession& s, const std::string& name) { return s.read().find_node(name); });
}

}  // namespace relume::python
