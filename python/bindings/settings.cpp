// Settings by name.

#include "relume/render.h"
#include "relume/session.h"
#include "session.h"

namespace relume::python {

void define_settings(py::module_& module) {
  py::class_<Settings> type(module, "SettingsCore");
  type.def(py::init<>());
  type.def(py::init<const Settings&>());
  // In this order: Python's bool is an int.
  type.def("set", [](Settings& s, const std::string& name, const py::bool_& value) { s.set(name, bool(value)); });
  type.def("set", [](Settings& s, const std::string& name, const std::string& text) { s.set(name, text); });
  type.def("set", [](Settings& s, const std::string& name, int value) { s.set(name, value); });
  type.def("set", [](Settings& s, const std::string& name, double value) { s.set(name, value); });
  type.def("get", [](const Settings& s, const std::string& name) { return s.get(name); });
  type.def("apply_preset", [](Settings& s, const std::string& name) { s.apply_preset(name); });
  type.def("apply_json", [](Settings& s, const std::string& json, const std::string& place) { s.apply_json(json, place); });
  type.def("provide_aovs", [](Settings& s, bool provided) { s.provide_aovs(provided); });
  type.def("set_crop", [](Settings& s, int x, int y, int width, int height) { s.set_crop({x, y, width, height}); });
  type.def("aov_names", [](const Settings& s) { return Session::aov_names(s); });
  type.def("limits", [](const Settings& s) {
    const RenderLimits limits = limits_of(s);
    return py::make_tuple(limits.samples, limits.time_s, limits.error);
  });
  type.def("to_json", &Settings::to_json);
  module.def("list_settings", [] {
    py::list list;
    for (const SettingInfo& setting : Settings::list())
      list.append(py::make_tuple(setting.name, setting.type, setting.default_value, setting.help));
    return list;
  });
  module.def("list_presets", &Settings::presets);
}

}  // namespace relume::python
