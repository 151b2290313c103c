// Scenes: Python lists of the structs of relume/scene.h.
#include "scene.h"

#include <array>
#include <tuple>

#include "names.h"
#include "properties.h"
#include "relume/builtin_scenes.h"
#include "relume/scene_io.h"

namespace relume::python {
namespace {

/// The elements as a Python list that shares none of them with `values`.
template <typename T>
py::list list_of(std::vector<T>&& values) {
  py::list list;
  for (T& value : values) list.append(std::make_shared<T>(std::move(value)));
  return list;
}

/// Copies the elements of scene attribute `name`. Throws Error for elements of another type.
template <typename T>
std::vector<T> elements(const py::object& scene, const char* name) {
  std::vector<T> values;
  for (const py::handle& element : scene.attr(name)) {
    if (!py::isinstance<T>(element)) {
      throw Error(std::string("scene.") + name + "[" + std::to_string(values.size()) + "] is of type " +
                  std::string(py::str(py::type::of(element).attr("__name__"))) + "; give a " +
                  std::string(py::str(py::type::of<T>().attr("__name__"))));
    }
    values.push_back(element.cast<const T&>());
  }
  return values;
}

std::vector<std::string> strings(const py::object& scene, const char* name) {
  std::vector<std::string> values;
  for (const py::handle& element : scene.attr(name)) values.push_back(element.cast<std::string>());
  return values;
}

/// A VisibleSet as Python's (low, high, visible).
using SetTuple = std::tuple<std::array<float, 3>, std::array<float, 3>, std::vector<uint32_t>>;

std::vector<SetTuple> tuples_of(const std::vector<VisibleSet>& sets) {
  std::vector<SetTuple> tuples;
  for (const VisibleSet& set : sets) {
    const auto& [low, high, visible] = set;
    tuples.emplace_back(std::array{low.x, low.y, low.z}, std::array{high.x, high.y, high.z}, visible);
  }
  return tuples;
}

std::vector<VisibleSet> sets_of(const std::vector<SetTuple>& tuples) {
  std::vector<VisibleSet> sets;
  for (const auto& [low, high, visible] : tuples)
    sets.push_back({{low[0], low[1], low[2]}, {high[0], high[1], high[2]}, visible});
  return sets;
}

/// Replaces bytes that are not UTF-8, which Python's strings cannot hold.
void make_valid(std::string& text) {
  const py::object decoded = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
  text = decoded.cast<std::string>();
}

void make_names_valid(Scene& scene) {
  const auto all = [](auto& parts) {
    for (auto& part : parts) make_valid(part.name);
  };
  all(scene.textures);
  all(scene.materials);
  all(scene.meshes);
  for (Mesh& mesh : scene.meshes) all(mesh.morph_targets);
  all(scene.lights);
  all(scene.cameras);
  all(scene.nodes);
  all(scene.skins);
  make_valid(scene.name);
  for (auto* texts : {&scene.clips, &scene.variants, &scene.warnings, &scene.notes}) {
    for (std::string& text : *texts) make_valid(text);
  }
}

}  // namespace

py::object scene_to_python(Scene&& scene) {
  make_names_valid(scene);
  py::object result = py::module_::import("relume._scene").attr("Scene")();
  result.attr("name") = scene.name;
  result.attr("textures") = list_of(std::move(scene.textures));
  result.attr("materials") = list_of(std::move(scene.materials));
  result.attr("meshes") = list_of(std::move(scene.meshes));
  result.attr("lights") = list_of(std::move(scene.lights));
  result.attr("cameras") = list_of(std::move(scene.cameras));
  result.attr("nodes") = list_of(std::move(scene.nodes));
  result.attr("skins") = list_of(std::move(scene.skins));
  result.attr("animation") = list_of(std::move(scene.animation));
  result.attr("parameter_animation") = list_of(std::move(scene.parameter_animation));
  result.attr("environment") = std::make_shared<Environment>(std::move(scene.environment));
  result.attr("clips") = scene.clips;
  result.attr("variants") = scene.variants;
  result.attr("visible_sets") = tuples_of(scene.visible_sets);
  result.attr("settings_json") = scene.settings_json;
  result.attr("crop") = py::make_tuple(scene.crop.left, scene.crop.top, scene.crop.right, scene.crop.bottom);
  result.attr("warnings") = scene.warnings;
  result.attr("notes") = scene.notes;
  py::list files;
  for (const std::filesystem::path& file : scene.source_files) files.append(py::cast(file));
  result.attr("source_files") = files;
  return result;
}

Scene scene_from_python(const py::object& source) {
  Scene scene;
  scene.name = source.attr("name").cast<std::string>();
  scene.textures = elements<Texture>(source, "textures");
  scene.materials = elements<Material>(source, "materials");
  scene.meshes = elements<Mesh>(source, "meshes");
  scene.lights = elements<PunctualLight>(source, "lights");
  scene.cameras = elements<Camera>(source, "cameras");
  scene.nodes = elements<Node>(source, "nodes");
  scene.skins = elements<Skin>(source, "skins");
  scene.animation = elements<AnimationChannel>(source, "animation");
  scene.parameter_animation = elements<ParameterChannel>(source, "parameter_animation");
  scene.environment = source.attr("environment").cast<const Environment&>();
  scene.clips = strings(source, "clips");
  scene.variants = strings(source, "variants");
  scene.visible_sets = sets_of(source.attr("visible_sets").cast<std::vector<SetTuple>>());
  scene.settings_json = source.attr("settings_json").cast<std::string>();
  const auto crop = source.attr("crop").cast<std::array<float, 4>>();
  scene.crop = {crop[0], crop[1], crop[2], crop[3]};
  for (const py::handle& file : source.attr("source_files"))
    scene.source_files.push_back(file.cast<std::filesystem::path>());
  return scene;
}

void define_scene_functions(py::module_& module) {
  module.def(
      "load_scene",
      [](const std::filesystem::path& file) {
        return scene_to_python(without_gil([&] { return load_scene(file); }));
      },
      py::arg("file"));
  module.def("builtin_scene", [](const std::string& name) { return scene_to_python(builtin_scene(name)); },
             py::arg("name"));
  module.def("builtin_scenes", [] {
    py::dict scenes;
    for (const BuiltinSceneInfo& scene : list_builtin_scenes()) scenes[py::str(scene.name)] = scene.summary;
    return scenes;
  });
  module.def(
      "write_scene",
      [](const std::filesystem::path& file, const py::object& scene) {
        const Scene written = scene_from_python(scene);
        return without_gil([&] { return write_scene(file, written); });
      },
      py::arg("file"), py::arg("scene"));
  module.def("validate", [](const py::object& scene) {
    const Scene checked = scene_from_python(scene);
    validate(checked, scene_place(checked));
  });
  module.def("load_environment_map", [](const std::filesystem::path& file) {
    auto environment = std::make_shared<Environment>();
    load_environment_map(file, *environment);
    return environment;
  });
  module.def("choose_variant", [](const py::object& scene, const std::string& name) {
    Scene changed = scene_from_python(scene);
    choose_variant(changed, name);
    for (size_t i = 0; i < changed.meshes.size(); ++i) {
      auto& mesh = scene.attr("meshes")[py::int_(i)].cast<Mesh&>();
      mesh.material = changed.meshes[i].material;
    }
  });
  module.def("world_matrices", [](const py::object& scene, float time_s) {
    return py::cast(world_matrices(scene_from_python(scene), time_s));
  });
  module.def("animation_end", [](const py::object& scene) { return animation_end(scene_from_python(scene)); });
  module.def("look_at", &look_at, py::arg("eye"), py::arg("target"));
}

}  // namespace relume::python
