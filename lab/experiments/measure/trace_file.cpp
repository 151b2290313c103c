#include "experiments/measure/trace_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/measure/parts.h"
#include "files/json_parse.h"
#include "relume/error.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kAttribute = "relume.traces";

nlohmann::json to_json(const TracePoint& p) { return {p.frames, p.samples, p.time_s, p.mse, p.spread, p.display_mse}; }

TracePoint point_from(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>(),
          json.at(3).get<double>(), json.at(4).get<double>(), json.at(5).get<double>()};
}

std::string layer_of(size_t i) { return fmt::format("trace{}", i); }
std::string map_of(size_t i) { return fmt::format("trace{}.map", i); }

std::vector<Trace> traces_from(const ExrFile& exr, const std::string& place) {
  std::vector<Trace> traces;
  for (const nlohmann::json& json : parse_json(exr.attributes.at(kAttribute), place)) {
    Trace trace{.name = json.at("name").get<std::string>(), .repetitions = {}};
    for (const nlohmann::json& points : json.at("repetitions")) {
      TracePoints& repetition = trace.repetitions.emplace_back();
      for (const nlohmann::json& point : points) repetition.push_back(point_from(point));
    }
    if (trace.repetitions.empty())
      throw Error(place + ": a trace has no repetitions; delete the file to measure it again");
    trace.points = median_points(trace.repetitions);
    trace.image_point = point_from(json.at("image_point"));
    trace.image = image_from_exr(exr, layer_of(traces.size()), place);
    if (const ExrChannel* map = exr.find(map_of(traces.size()))) trace.map = map->values;
    traces.push_back(std::move(trace));
  }
  return traces;
}

}  // namespace

std::filesystem::path trace_file(const ExperimentContext& context, const ExperimentScene& scene,
                                 const std::vector<TraceContender>& contenders, const TraceOptions& options) {
  std::string text = fmt::format("{} {} {} {} {} {}", options.turn.total_deg, options.turn.step_deg,
                                 options.turn.aside_m, options.frames, options.repetitions, options.image_frame);
  for (const TraceContender& c : contenders) {
    RenderSettings settings = c.settings;
    text += fmt::format(" {} {} {} {}", c.name, c.samples_per_step, c.map, settings_to_json(describe(settings)));
  }
  return part_file(context, scene, "traces", text);
}

void save_traces(const std::filesystem::path& file, const std::vector<Trace>& traces) {
  ExrFile exr{traces.front().image.width, traces.front().image.height, {}, {}};
  nlohmann::json list = nlohmann::json::array();
  for (size_t i = 0; i < traces.size(); ++i) {
    const Trace& trace = traces[i];
    nlohmann::json repetitions = nlohmann::json::array();
    for (const TracePoints& points : trace.repetitions) {
      nlohmann::json repetition = nlohmann::json::array();
      for (const TracePoint& p : points) repetition.push_back(to_json(p));
      repetitions.push_back(std::move(repetition));
    }
    list.push_back({{"name", trace.name}, {"repetitions", repetitions}, {"image_point", to_json(trace.image_point)}});
    for (ExrChannel& channel : exr_channels(trace.image, layer_of(i))) exr.channels.push_back(std::move(channel));
    if (!trace.map.empty()) exr.channels.push_back({map_of(i), trace.map});
  }
  exr.attributes[kAttribute] = list.dump();
  write_part(file, exr);
}

std::optional<std::vector<Trace>> load_traces(const std::filesystem::path& file) {
  return read_part(file, traces_from);
}

}  // namespace relume
