// Metrics, comparisons and experiments.
#include "lab.h"

#include <pybind11/functional.h>

#include "images.h"
#include "interruptible.h"
#include "relume/lab/lab.h"
#include "scene.h"

namespace relume::python {
namespace {

py::dict metrics_dict(const py::object& a, const py::object& b, bool flip) {
  const Image test = image_from(a, "a");
  const Image reference = image_from(b, "b");
  const Metrics m = without_gil([&] { return compute_metrics(test, reference, {.flip = flip}); });
  py::dict result;
  result["mse"] = m.mse;
  result["rel_mse"] = m.rel_mse;
  result["mae"] = m.mae;
  result["mape"] = m.mape;
  result["flip"] = m.flip;
  result["pixels"] = m.pixels;
  result["nonfinite_a"] = m.nonfinite_a;
  result["nonfinite_b"] = m.nonfinite_b;
  return result;
}

/// Calls a Python function, or nothing if it is None, from a thread without the GIL.
std::function<void(const std::string&, double)> progress_function(const py::object& function) {
  if (function.is_none()) return {};
  return [&function](const std::string& stage, double fraction) {
    const py::gil_scoped_acquire acquired;
    function(stage, fraction);
  };
}

py::dict score_dict(const lab::ContenderScore& score) {
  py::dict result;
  result["name"] = score.name;
  result["mse"] = score.mse;
  result["rel_mse"] = score.rel_mse;
  result["mape"] = score.mape;
  result["flip"] = score.flip;
  result["temporal_error"] = score.temporal_error;
  result["samples"] = score.samples;
  result["time_s"] = score.time_s;
  result["mses"] = score.mses;
  result["image"] = image_array(Image(score.image));
  return result;
}

lab::ComparisonRequest request_from(const py::dict& values) {
  lab::ComparisonRequest request;
  request.scene_name = values["scene_name"].cast<std::string>();
  request.spp = values["samples"].cast<int>();
  request.budget_s = values["budget_s"].cast<double>();
  request.repetitions = values["repetitions"].cast<int>();
  request.times_s = values["times_s"].cast<std::vector<float>>();
  request.reference_file = values["reference_file"].cast<std::string>();
  request.reference_spp = values["reference_samples"].cast<int>();
  request.cache_folder = values["cache_folder"].cast<std::string>();
  request.settings = values["settings"].cast<std::vector<std::pair<std::string, std::string>>>();
  for (const py::handle& contender : values["contenders"]) {
    const auto [name, preset, settings] =
        contender.cast<std::tuple<std::string, std::string, std::vector<std::pair<std::string, std::string>>>>();
    request.contenders.push_back({name, preset, settings});
  }
  return request;
}

py::object compare(const py::object& scene, const py::dict& values, const py::object& progress) {
  const Scene copy = scene_from_python(scene);
  const lab::ComparisonRequest request = request_from(values);
  std::optional<lab::ComparisonReport> report;
  Worker worker;
  worker.run(
      [&](const std::stop_token& stop) { report = lab::compare(copy, request, stop, progress_function(progress)); },
      py::none());
  if (!report) return py::none();
  py::dict result;
  py::list scores;
  for (const lab::ContenderScore& score : report->contenders()) scores.append(score_dict(score));
  result["scores"] = scores;
  result["reference"] = image_array(Image(report->reference()));
  result["reference_mse"] = report->reference_mse();
  result["notes"] = report->notes();
  result["json"] = report->to_json();
  result["csv"] = report->to_csv();
  result["html"] = report->to_html();
  return result;
}

py::object experiment(const std::string& name, bool quick, const std::filesystem::path& cache,
                      const std::filesystem::path& scenes, const std::string& device, const py::object& progress) {
  const lab::ExperimentRequest request{.quick = quick, .cache_folder = cache, .scene_folder = scenes, .device = device};
  std::optional<lab::ExperimentReport> report;
  Worker worker;
  worker.run(
      [&](const std::stop_token& stop) {
        report = lab::run_experiment(name, request, stop, progress_function(progress));
      },
      py::none());
  if (!report) return py::none();
  py::list claims;
  for (const lab::TestedClaim& claim : report->claims) {
    py::dict entry;
    entry["id"] = claim.id;
    entry["paper"] = claim.paper;
    entry["claim"] = claim.claim;
    entry["measured"] = claim.measured;
    entry["threshold"] = claim.threshold;
    entry["verdict"] = claim.verdict;
    claims.append(entry);
  }
  py::dict result;
  result["claims"] = claims;
  result["seconds"] = report->seconds;
  result["json"] = report->json;
  result["html"] = report->html;
  return result;
}

}  // namespace

void define_lab(py::module_& module) {
  module.def("metrics", &metrics_dict, py::arg("a"), py::arg("b"), py::arg("flip"));
  module.def("flip_map", [](const py::object& a, const py::object& b) {
    const Image test = image_from(a, "a");
    const Image reference = image_from(b, "b");
    return plane_array(without_gil([&] { return flip_map(test, reference); }), test.width, test.height);
  });
  module.def("compare", &compare, py::arg("scene"), py::arg("request"), py::arg("progress"));
  module.def("experiments", [] {
    py::dict list;
    for (const lab::ExperimentInfo& info : lab::list_experiments()) list[py::str(info.name)] = info.summary;
    return list;
  });
  module.def("experiment", &experiment);
}

}  // namespace relume::python
