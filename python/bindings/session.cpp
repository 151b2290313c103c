// Sessions: frames, images, buffers, records and checkpoints.
#include "session.h"

#include <pybind11/functional.h>

#include "relume/render.h"
#include "scene.h"
#include "session_state.h"

namespace relume::python {
namespace {

py::dtype scalar_type(ElementType type) {
  return type == ElementType::uint32 ? py::dtype::of<uint32_t>() : py::dtype::of<float>();
}

/// A copy of a buffer with the shape (height, width) or (height, width, channels).
py::array buffer_copy(const BufferData& data) {
  std::vector<py::ssize_t> shape{data.info.height, data.info.width};
  if (data.info.channels > 1) shape.push_back(data.info.channels);
  py::array array(scalar_type(data.info.type), shape);
  std::memcpy(array.mutable_data(), data.bytes.data(), data.bytes.size());
  return array;
}

void write_buffer(PythonSession& s, const std::string& name, const py::object& values) {
  const BufferData data = s.read().buffer(name);
  const py::array expected = buffer_copy(data);
  const py::object any = py::module_::import("numpy").attr("ascontiguousarray")(values, expected.dtype());
  const auto array = any.cast<py::array>();
  if (shape_text(array) != shape_text(expected)) {
    throw Error("buffer '" + name + "' has the shape " + shape_text(expected) + ", but the values have " +
                shape_text(array) + "; give an array of the buffer's shape");
  }
  const std::span<std::byte> bytes = s.edit().edit_buffer(name);
  std::memcpy(bytes.data(), array.data(), bytes.size());
}

/// NumPy's structured type of a table's records.
py::dtype record_type(const RecordTable& table) {
  py::list names;
  py::list formats;
  py::list offsets;
  for (const RecordField& field : table.fields) {
    names.append(field.name);
    const py::dtype scalar = scalar_type(field.type);
    if (field.count == 1) {
      formats.append(scalar);
    } else {
      formats.append(py::make_tuple(scalar, py::make_tuple(field.count)));
    }
    offsets.append(field.offset);
  }
  return {names, formats, offsets, static_cast<py::ssize_t>(table.stride)};
}

py::array record_array(const RecordData& data) {
  py::array array(record_type(data.table), static_cast<py::ssize_t>(data.size()));
  std::memcpy(array.mutable_data(), data.bytes.data(), data.bytes.size());
  return array;
}

/// Planes of a layer as one array of shape (height, width) or (height, width, channels).
py::array layer_array(const Session& session, const std::string& name) {
  const std::vector<ExrChannel> planes = session.aov(name);
  const BufferInfo size = session.buffers().front();  // all have the size of the image
  const auto channels = static_cast<py::ssize_t>(planes.size());
  std::vector<py::ssize_t> shape{size.height, size.width};
  if (channels > 1) shape.push_back(channels);
  py::array_t<float> array(shape);
  float* values = array.mutable_data();
  for (size_t c = 0; c < planes.size(); ++c) {
    for (size_t i = 0; i < planes[c].values.size(); ++i) values[i * planes.size() + c] = planes[c].values[i];
  }
  return array;
}

/// Renders up to `frames` frames. Returns the number of complete ones.
uint32_t render_frames(PythonSession& s, uint32_t frames, const py::object& wants_stop) {
  uint32_t done = 0;
  Session& session = s.change();
  s.run(
      [&](const std::stop_token& stop) {
        while (done < frames && session.render_frame(stop)) ++done;
      },
      wants_stop);
  return done;
}

/// Renders until a limit is met. Frames and samples count from the last change.
std::string render_to_limits(PythonSession& s, RenderLimits limits, const py::object& progress,
                             const py::object& wants_stop) {
  StopReason reason = StopReason::interrupted;
  Session& session = s.change();
  if (session.frames_since_change() == 0) session.begin_image();
  limits.completes_first_frame = false;
  s.run(
      [&](const std::stop_token& stop) {
        std::function<void(const RenderProgress&)> report;
        if (!progress.is_none()) {
          report = [&](const RenderProgress& state) {
            const py::gil_scoped_acquire acquired;
            progress(fraction_done(state, limits), remaining_s(state, limits), state.samples);
          };
        }
        reason = render_until(session, limits, stop, report);
      },
      wants_stop);
  return name_of(reason);
}

py::dict statistics_dict(const Statistics& s) {
  py::dict result;
  result["build_s"] = s.build_s;
  result["accel_s"] = s.accel_s;
  result["render_s"] = s.render_s;
  result["frames"] = s.frames;
  result["samples"] = s.samples;
  result["paths"] = s.paths;
  result["rays"] = s.rays;
  result["nonfinite_samples"] = s.nonfinite_samples;
  result["scene_bytes"] = s.scene_bytes;
  result["buffer_bytes"] = s.buffer_bytes;
  result["technique_bytes"] = s.technique_bytes;
  result["threads"] = s.threads;
  py::dict passes;
  py::dict idle;
  for (const PassTime& pass : s.passes) {
    passes[py::str(pass.name)] = pass.seconds;
    idle[py::str(pass.name)] = pass.idle_share(s.threads);
  }
  result["passes"] = passes;
  result["idle_shares"] = idle;
  py::dict figures;
  for (const PassStatistic& figure : s.pass_statistics) figures[py::str(figure.name)] = figure.value;
  result["pass_statistics"] = figures;
  result["device"] = py::none();
  if (s.device) {
    py::dict device;
    device["name"] = s.device->name;
    device["driver"] = s.device->driver;
    device["memory_bytes"] = s.device->memory_bytes;
    device["memory_limit_bytes"] = s.device->memory_limit_bytes;
    device["memory_used_bytes"] = s.device->memory_used_bytes;
    result["device"] = device;
  }
  return result;
}

/// Sets a Python function as the hook, or removes it if None.
void set_hook(PythonSession& s, const py::object& function) {
  if (function.is_none()) return s.edit().on_pass({});
  // Released with the GIL, because the session may be destroyed without it.
  const std::shared_ptr<py::object> shared(new py::object(function), [](py::object* object) {
    const py::gil_scoped_acquire acquired;
    delete object;
  });
  s.edit().on_pass([shared, &s](const std::string& pass) { s.call_hook(*shared, pass); });
}

/// Statistics, checkpoints and settings.
void define_state(SessionClass& type) {
  type.def("statistics", [](PythonSession& s) { return statistics_dict(s.read().statistics()); });
  type.def("frames", [](PythonSession& s) { return s.read().frames_since_change(); });
  type.def("samples", [](PythonSession& s) { return s.read().kept_samples(); });
  type.def("estimated_error", [](PythonSession& s) { return s.read().estimated_error(); });
  type.def("notes", [](PythonSession& s) { return s.read().notes(); });
  type.def("warnings", [](PythonSession& s) { return s.read().warnings(); });
  type.def("save_checkpoint", [](PythonSession& s, const std::filesystem::path& file) {
    const Session& session = s.read();
    s.run_here([&] { session.save_checkpoint(file); });
  });
  type.def("load_checkpoint", [](PythonSession& s, const std::filesystem::path& file) {
    Session& session = s.change();
    s.run_here([&] { session.load_checkpoint(file); });
  });
  type.def("restart", [](PythonSession& s, int seed) { s.change().restart(seed); });
  type.def("set_settings",
           [](PythonSession& s, const Settings& settings) { return s.change().set_settings(settings); });
}

}  // namespace

void define_session(py::module_& module) {
  SessionClass type(module, "SessionCore");
  type.def(py::init([](const py::object& scene, const Settings& settings, std::vector<Index> movable) {
             Scene copy = scene_from_python(scene);
             apply_to_scene(settings, copy);
             validate(copy, scene_place(copy));
             const py::gil_scoped_release released;
             return std::make_unique<PythonSession>(std::move(copy), settings, std::move(movable));
           }),
           py::arg("scene"), py::arg("settings"), py::arg("movable"));
  type.def("render", &render_frames, py::arg("frames"), py::arg("wants_stop"));
  type.def(
      "render_until",
      [](PythonSession& s, uint32_t samples, double time_s, double error, const py::object& progress,
         const py::object& wants_stop) {
        return render_to_limits(s, {samples, time_s, error}, progress, wants_stop);
      },
      py::arg("samples"), py::arg("time_s"), py::arg("error"), py::arg("progress"), py::arg("wants_stop"));
  type.def("image", [](PythonSession& s) { return image_array(s.image()); });
  type.def("aov", [](PythonSession& s, const std::string& name) { return layer_array(s.read(), name); });
  type.def("buffers", [](PythonSession& s) {
    py::dict help;
    for (const BufferInfo& info : s.read().buffers()) help[py::str(info.name)] = info.help;
    return help;
  });
  type.def("buffer", [](PythonSession& s, const std::string& name) { return buffer_copy(s.read().buffer(name)); });
  type.def("write_buffer", &write_buffer);
  type.def("replace_image", [](PythonSession& s, const py::object& image) {
    s.edit().replace_image(image_from(image, "image"));
  });
  type.def("record_tables", [](PythonSession& s) {
    py::dict help;
    for (const RecordTable& table : s.read().record_tables()) help[py::str(table.name)] = table.help;
    return help;
  });
  type.def("records", [](PythonSession& s, const std::string& name) { return record_array(s.read().records(name)); });
  type.def("passes", [](PythonSession& s) {
    py::list passes;
    for (const PassInfo& pass : s.read().passes()) passes.append(py::make_tuple(pass.name, pass.stage));
    return passes;
  });
  type.def("set_hook", &set_hook);
  define_state(type);
  define_session_edits(module);
}

}  // namespace relume::python
