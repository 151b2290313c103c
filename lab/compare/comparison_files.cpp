// JSON and CSV of a comparison.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/comparison.h"
#include "metrics/statistics.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

struct Quantity {
  const char* name;
  Figure value;
};

const Quantity kErrors[] = {
    {"mse", &Repetition::mse},
    {"rel_mse", &Repetition::rel_mse},
    {"mape", &Repetition::mape},
    {"flip", &Repetition::flip},
};
const Quantity kCosts[] = {
    {"frames", &Repetition::frames}, {"samples_per_pixel", &Repetition::samples},
    {"time_s", &Repetition::time_s}, {"ms_per_frame", frame_ms},
    {"rays", &Repetition::rays},
};
const Quantity kTemporal{"temporal_error", &Repetition::temporal_error};

/// Median over the repetitions with its interval.
Json quantity(const ContenderResult& contender, const Quantity& q) {
  const std::vector<double> values = values_of(contender, q.value);
  const Interval interval = median_interval(values);
  return {
      {"median", median(values)}, {"low", interval.low}, {"high", interval.high}, {"confidence", interval.confidence}};
}

Json passes_per_frame(const ContenderResult& contender) {
  Json passes = Json::array();
  for (const auto& [name, ms] : median_pass_ms(contender)) passes.push_back({{"name", name}, {"ms_per_frame", ms}});
  return passes;
}

Json curve(const Repetition& repetition) {
  Json json = Json::array();
  for (const ErrorPoint& p : repetition.curve) {
    json.push_back({{"frames", p.frames},
                    {"samples_per_pixel", p.samples},
                    {"time_s", p.time_s},
                    {"mse", p.mse},
                    {"rel_mse", p.rel_mse},
                    {"mape", p.mape}});
  }
  return json;
}

Json to_json(const ContenderResult& contender, bool has_motion) {
  Json json = {{"name", contender.name}, {"kind", contender.is_image ? "image" : "technique"}};
  for (const Quantity& q : kErrors) json[q.name] = quantity(contender, q);
  json["nonfinite_pixels"] = most_nonfinite(contender);
  if (contender.is_image) {
    json["file"] = contender.settings;
    return json;
  }
  if (has_motion) json[kTemporal.name] = quantity(contender, kTemporal);
  for (const Quantity& q : kCosts) json[q.name] = quantity(contender, q);
  json["bias2"] = contender.split ? Json(contender.split->bias2) : Json();
  const bool is_known = contender.split && contender.split->bias2_error;
  json["bias2_error"] = is_known ? Json(*contender.split->bias2_error) : Json();
  json["variance"] = contender.split ? Json(contender.split->variance) : Json();
  json["passes"] = passes_per_frame(contender);
  Json curves = Json::array();
  for (const Repetition& repetition : contender.repetitions)
    curves.push_back({{"seed", repetition.seed}, {"points", curve(repetition)}});
  json["repetitions"] = std::move(curves);
  json["settings"] = Json::parse(contender.settings);
  return json;
}

Json json_of(const SettingTexts& settings) {
  Json json = Json::object();
  for (const auto& [name, text] : settings) json[name] = text;
  return json;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_number(double x) { return std::isfinite(x) ? fmt::format(",{:.9g}", x) : ","; }

}  // namespace

std::string to_json(const Comparison& c, const std::vector<std::pair<std::string, std::string>>& machine) {
  const bool rendered = c.threads > 0;
  AllSettings reference_settings = c.reference_settings;
  Json json = {{"scene", c.options.scene_name},
               {"scene_hash", fmt::format("{:016x}", c.scene_hash)},
               {"triangles", c.triangles},
               {"width", c.reference.image.width},
               {"height", c.reference.image.height},
               {"mode", !rendered                ? "images"
                        : c.options.budget_s > 0 ? "equal-time"
                                                 : "equal-samples"},
               {"spp", !rendered || c.options.budget_s > 0 ? Json() : Json(c.options.spp)},
               {"budget_s", c.options.budget_s > 0 ? Json(c.options.budget_s) : Json()},
               {"animation_times_s", c.options.times_s},
               {"repetitions", rendered ? Json(c.options.repetitions) : Json()}};
  json["machine"] = Json::object();
  for (const auto& [name, value] : machine) json["machine"][name] = value;
  if (rendered) json["machine"]["threads"] = c.threads;
  if (c.ranks > 1) json["machine"]["ranks"] = c.ranks;
  const bool known = c.reference.spp > 0;
  const bool moves = is_animation(c.options);
  json["reference"] = {{"samples_per_pixel", known ? Json(c.reference.spp) : Json()},
                       {"mse", known ? Json(c.reference_noise.mse) : Json()},
                       {"rel_mse", known ? Json(c.reference_noise.rel_mse) : Json()},
                       {"temporal_error", known && moves ? Json(c.reference_noise.temporal_error) : Json()},
                       {"nonfinite_pixels", c.reference_nonfinite},
                       {"cached", c.reference.cached},
                       {"file", c.options.reference_file.string()},
                       {"flags_left_out", json_of(c.reference_left_out)},
                       {"settings", Json::parse(settings_to_json(describe(reference_settings)))}};
  json["contenders"] = Json::array();
  for (const ContenderResult& contender : c.contenders) json["contenders"].push_back(to_json(contender, moves));
  json["notes"] = c.notes;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_csv(const Comparison& c) {
  std::string text = "name";
  for (const Quantity& q : kErrors) text += fmt::format(",{}", q.name);
  text += ",temporal_error,bias2,bias2_error,variance";
  for (const Quantity& q : kCosts) text += fmt::format(",{}", q.name);
  text += ",nonfinite_pixels\n";
  for (const ContenderResult& contender : c.contenders) {
    text += csv_text(contender.name);
    const auto add = [&](const Quantity& q) { text += csv_number(median_of(contender, q.value)); };
    for (const Quantity& q : kErrors) add(q);
    is_animation(c.options) && !contender.is_image ? add(kTemporal) : void(text += ",");
    const double none = std::nan("");
    text += csv_number(contender.split ? contender.split->bias2 : none);
    text += csv_number(contender.split ? contender.split->bias2_error.value_or(none) : none);
    text += csv_number(contender.split ? contender.split->variance : none);
    for (const Quantity& q : kCosts) contender.is_image ? void(text += ",") : add(q);
    text += fmt::format(",{}\n", most_nonfinite(contender));
  }
  return text;
}

}  // namespace relume
