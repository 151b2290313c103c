#include "reports.h"

#include <nlohmann/json.hpp>

#include "metrics/metrics.h"

namespace relume::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string to_json(const RunReport& report) {
  Json passes = Json::array();
  for (const auto& [name, seconds] : report.passes) passes.push_back({{"name", name}, {"seconds", seconds}});
  const Json json = {
      {"version", report.version},
      {"scene", report.scene},
      {"width", report.width},
      {"height", report.height},
      {"samples_per_pixel", report.samples_per_pixel},
      {"stopped_by", report.stopped_by},
      {"estimated_error", report.estimated_error},
      {"load_s", report.load_s},
      {"build_s", report.build_s},
      {"render_s", report.render_s},
      {"write_s", report.write_s},
      {"samples", report.samples},
      {"paths", report.paths},
      {"rays", report.rays},
      {"nonfinite_samples", report.nonfinite_samples},
      {"threads", report.threads},
      {"peak_memory_bytes", report.peak_memory_bytes},
      {"files", report.files},
      {"passes", passes},
  };
  return text_of(json);
}

std::string to_json(const Metrics& m) {
  return text_of({{"mse", m.mse},
                  {"rel_mse", m.rel_mse},
                  {"mae", m.mae},
                  {"mape", m.mape},
                  {"flip", m.flip},
                  {"mean_a", m.mean_a},
                  {"mean_b", m.mean_b},
                  {"pixels", m.pixels},
                  {"nonfinite_a", m.nonfinite_a},
                  {"nonfinite_b", m.nonfinite_b}});
}

}  // namespace relume::cli
