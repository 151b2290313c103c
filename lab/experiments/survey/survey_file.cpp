#include "experiments/survey/survey_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/fnv1a.h"
#include "experiments/setup/references.h"
#include "files/atomic_file.h"
#include "files/json_parse.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "relume/tone_map.h"
#include "report/images.h"

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

void create_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error(
        fmt::format("{}: the folder cannot be created ({}); choose another", folder.string(), failure.message()));
}

std::string image_of(std::string_view scene, std::string_view image) {
  return fmt::format("images/{}/{}.jpg", image_name(scene), image_name(image));
}

/// The value with five digits, which keeps the file small; null unless finite.
Json rounded(double value) { return std::isfinite(value) ? Json::parse(fmt::format("{:.5g}", value)) : Json(); }
Json rounded(const std::optional<double>& value) { return value ? rounded(*value) : Json(); }

void add_still(const StillValues& still, Json& json) {
  json["mse"] = rounded(still.mse);
  json["mse_low"] = rounded(still.mse_interval.low);
  json["mse_high"] = rounded(still.mse_interval.high);
  json["rel_mse"] = rounded(still.rel_mse);
  json["flip"] = rounded(still.flip);
  json["frame_ms"] = rounded(still.frame_ms);
  json["frames"] = still.frames;
  json["time_s"] = rounded(still.time_s);
  json["rays"] = rounded(still.rays);
  json["memory_bytes"] = still.memory_bytes;
  json["bias2"] = rounded(still.bias2.value);
  json["bias2_error"] = rounded(still.bias2.error);
  json["variance"] = rounded(still.variance);
}

void add_change(const ChangeValues& change, Json& json) {
  json["lag"] = change.lag ? Json(*change.lag) : Json();
  json["ghost"] = rounded(change.ghost.value);
  json["ghost_error"] = rounded(change.ghost.error);
}

Json technique_json(const std::string& scene, const TechniqueValues& values) {
  Json json = {{"name", values.technique.name}, {"settings", values.technique.settings}, {"slots", Json::object()}};
  for (const auto& [slot, choice] : values.slots) json["slots"][slot] = choice;
  if (!values.refused.empty()) json["refused"] = values.refused;
  if (!values.failed.empty()) json["failed"] = values.failed;
  if (!values.still) return json;
  add_still(*values.still, json);
  json["image"] = image_of(scene, values.technique.name);
  json["keeps_state"] = values.change.has_value();
  if (!values.change) return json;
  add_change(*values.change, json);
  json["image_after"] = image_of(scene, values.technique.name + " after");
  return json;
}

Json scene_json(const SceneValues& scene, double seconds) {
  Json json = {{"name", scene.name},
               {"change", scene.change},
               {"seconds", rounded(seconds)},
               {"mean_square", rounded(scene.mean_square)},
               {"reference_mse", rounded(scene.reference_mse)},
               {"reference_spp", scene.reference_spp},
               {"reference_settings", scene.reference_settings},
               {"image", image_of(scene.name, "reference")},
               {"image_after", image_of(scene.name, "reference after")},
               {"techniques", Json::array()}};
  for (const TechniqueValues& values : scene.techniques)
    json["techniques"].push_back(technique_json(scene.name, values));
  return json;
}

void write_images(const std::filesystem::path& folder, const SceneValues& scene) {
  create_folder((folder / image_of(scene.name, "reference")).parent_path());
  const float exposure = metered_exposure(scene.reference);
  const float exposure_after = metered_exposure(scene.reference_after);
  write_image(folder / image_of(scene.name, "reference"), tone_map(scene.reference, ToneMap::agx, exposure));
  write_image(folder / image_of(scene.name, "reference after"),
              tone_map(scene.reference_after, ToneMap::agx, exposure_after));
  for (const TechniqueValues& values : scene.techniques) {
    if (values.still)
      write_image(folder / image_of(scene.name, values.technique.name),
                  tone_map(values.still->image, ToneMap::agx, exposure));
    if (!values.change) continue;
    write_image(folder / image_of(scene.name, values.technique.name + " after"),
                tone_map(values.change->image, ToneMap::agx, exposure_after));
  }
}

Json setup_json(const ExperimentContext& context, const SurveyEffort& effort) {
  return {{"size", size_text(context)}, {"budget_s", effort.budget_s}, {"repetitions", effort.repetitions},
          {"runs", effort.runs},        {"warm_up", effort.warm_up},   {"frames", effort.frames},
          {"ghost_frame", kGhostFrame}};
}

}  // namespace

std::string image_name(std::string_view name) {
  std::string result;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    const bool kept = std::isalnum(u) != 0 || c == '.';
    if (kept) {
      result += static_cast<char>(std::tolower(u));
    } else if (!result.empty() && result.back() != '-') {
      result += '-';
    }
  }
  return result;
}

std::string survey_key(const ExperimentContext& context, const std::vector<SurveyTechnique>& techniques,
                       const SurveyEffort& effort, int threads) {
  std::string text = fmt::format("{} {} {} {} {} {}", context.program, context.device, threads, context.quick,
                                 effort.reference_spp, setup_json(context, effort).dump());
  for (const SurveyTechnique& technique : techniques) text += fmt::format(" {}={}", technique.name, technique.settings);
  Fnv1a hash;
  hash.add(text.data(), text.size());
  return fmt::format("{:016x}", hash.value());
}

SurveyFile::SurveyFile(std::filesystem::path folder, std::string key)
    : folder_(std::move(folder)), key_(std::move(key)) {
  const std::filesystem::path file = folder_ / kSurveyFile;
  if (std::error_code failure; !std::filesystem::exists(file, failure)) return;
  const std::vector<std::byte> bytes = read_file(file);
  const nlohmann::json json = parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
  try {
    const bool is_current = json.at("key").get<std::string>() == key_;
    for (const nlohmann::json& scene : json.at("scenes")) {
      if (is_current) scenes_.emplace_back(scene.at("name").get<std::string>(), scene.dump());
      if (!is_current) ++dropped_;
    }
  } catch (const nlohmann::json::exception&) {
    throw Error(file.string() + ": this is no survey; move it away or choose another folder");
  }
}

bool SurveyFile::has(std::string_view scene) const {
  return std::any_of(scenes_.begin(), scenes_.end(), [&](const auto& s) { return s.first == scene; });
}

void SurveyFile::add(const SceneValues& scene, double seconds, const ExperimentContext& context,
                     const std::vector<std::pair<std::string, std::string>>& machine, const SurveyEffort& effort) {
  create_folder(folder_);
  write_images(folder_, scene);
  scenes_.emplace_back(scene.name, scene_json(scene, seconds).dump());
  Json json = {{"key", key_},
               {"quick", context.quick},
               {"program", context.program},
               {"device", context.device},
               {"machine", Json::object()},
               {"setup", setup_json(context, effort)},
               {"scenes", Json::array()}};
  for (const auto& [name, value] : machine) json["machine"][name] = value;
  for (const auto& [name, text] : scenes_) json["scenes"].push_back(Json::parse(text));
  write_file(folder_ / kSurveyFile, json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace relume
