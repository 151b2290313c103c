#include "cli/reports.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/scene_summary.h"
#include "relume/lab/metrics.h"

namespace relume::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Escapes the control character DEL, which JSON permits in strings: the text may be shown on a terminal.
std::string text_of(const Json& json) {
  std::string text;
  for (const char c : json.dump(2, ' ', false, Json::error_handler_t::replace)) {
    if (c == '\x7f') {
      text += "\\u007f";
    } else {
      text += c;
    }
  }
  return text + "\n";
}

/// null: the processor.
Json json_of(const std::optional<DeviceStatistics>& device) {
  if (!device) return {};
  return {{"name", device->name},
          {"driver", device->driver},
          {"memory_bytes", device->memory_bytes},
          {"memory_limit_bytes", device->memory_limit_bytes},
          {"memory_used_bytes", device->memory_used_bytes}};
}

}  // namespace

std::string format_samples(double samples) { return fmt::format("{}", std::round(samples * 100) / 100); }

std::string samples_text(double samples) {
  const std::string number = format_samples(samples);
  return fmt::format("{} sample{} per pixel", number, number == "1" ? "" : "s");
}

std::string to_json(const RunReport& report) {
  Json passes = Json::array();
  PassTime all{.name = {}, .seconds = report.render_s};
  double outside_s = report.render_s;  // on one thread: bookkeeping
  for (const PassTime& pass : report.passes) {
    passes.push_back({{"name", pass.name}, {"seconds", pass.seconds}, {"idle_share", pass.idle_share(report.threads)}});
    if (pass.name == "build" || pass.name == "scene") continue;  // before and between the frames
    all.idle_s += pass.idle_s;
    outside_s -= pass.seconds;
  }
  all.idle_s += std::max(outside_s, 0.0) * (report.threads - 1);
  Json figures = Json::object();
  for (const auto& [name, value] : report.figures) figures[name] = value;
  const PixelWindow& w = report.crop;
  const Json json = {
      {"version", report.version},
      {"scene", report.scene},
      {"width", report.width},
      {"height", report.height},
      {"crop", w.empty() ? Json() : Json::array({w.x, w.y, w.width, w.height})},
      {"samples_per_pixel", Json::parse(format_samples(report.samples_per_pixel))},
      {"stopped_by", report.stopped_by},
      {"estimated_error", report.estimated_error},
      {"load_s", report.load_s},
      {"build_s", report.build_s},
      {"accel_s", report.accel_s},
      {"render_s", report.render_s},
      {"write_s", report.write_s},
      {"samples", report.samples},
      {"paths", report.paths},
      {"rays", report.rays},
      {"nonfinite_samples", report.nonfinite_samples},
      {"device", json_of(report.device)},
      {"threads", report.threads},
      {"idle_share", all.idle_share(report.threads)},
      {"peak_memory_bytes", report.peak_memory_bytes},
      {"scene_bytes", report.scene_bytes},
      {"buffer_bytes", report.buffer_bytes},
      {"technique_bytes", report.technique_bytes},
      {"files", report.files},
      {"passes", passes},
      {"figures", figures},
  };
  return text_of(json);
}

std::string to_json(const Metrics& m, bool with_hdr_flip) {
  Json json = {{"mse", m.mse},
               {"rel_mse", m.rel_mse},
               {"mae", m.mae},
               {"mape", m.mape},
               {"flip", m.flip},
               {"mean_a", m.mean_a},
               {"mean_b", m.mean_b},
               {"pixels", m.pixels},
               {"nonfinite_a", m.nonfinite_a},
               {"nonfinite_b", m.nonfinite_b}};
  if (with_hdr_flip) json["hdr_flip"] = m.hdr_flip;
  return text_of(json);
}

ImageReport::Channel report_channel(const ExrChannel& channel) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  ImageReport::Channel report{channel.name, kInfinity, -kInfinity};
  for (const float value : channel.values) {
    report.min = std::isfinite(value) ? std::min(report.min, value) : report.min;
    report.max = std::isfinite(value) ? std::max(report.max, value) : report.max;
    report.nonfinite += std::isfinite(value) ? 0 : 1;
  }
  return report;
}

std::string to_json(const ImageReport& report) {
  Json channels = Json::array();
  for (const ImageReport::Channel& c : report.channels) {
    channels.push_back({{"name", c.name}, {"min", c.min}, {"max", c.max}, {"nonfinite", c.nonfinite}});
  }
  Json attributes = Json::object();
  for (const auto& [name, value] : report.attributes) attributes[name] = value;
  return text_of(
      {{"width", report.width}, {"height", report.height}, {"channels", channels}, {"attributes", attributes}});
}

std::string to_json(const SceneSummary& s) {
  const auto vector = [](const Vec3& v) { return Json::array({v.x, v.y, v.z}); };
  const bool placed = s.bounds_min.x <= s.bounds_max.x;
  return text_of({
      {"nodes", s.nodes},
      {"meshes", s.meshes},
      {"mesh_instances", s.mesh_instances},
      {"triangles", s.triangles},
      {"instanced_triangles", s.instanced_triangles},
      {"materials", s.materials},
      {"emissive_materials", s.emissive_materials},
      {"textures", s.textures},
      {"lights", s.lights},
      {"environment", s.environment},
      {"cameras", s.cameras},
      {"animation_s", s.animation_s},
      {"animations", s.clips},
      {"bounds_min", placed ? vector(s.bounds_min) : Json()},
      {"bounds_max", placed ? vector(s.bounds_max) : Json()},
      {"geometry_bytes", s.geometry_bytes},
      {"texture_bytes", s.texture_bytes},
      {"warnings", s.warnings},
  });
}

}  // namespace relume::cli
