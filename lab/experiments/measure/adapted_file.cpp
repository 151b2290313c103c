#include "experiments/measure/adapted_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/fnv1a.h"
#include "experiments/measure/parts.h"
#include "files/json_parse.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kAttribute = "relume.adapted";

std::string layer_of(size_t i) { return fmt::format("contender{}", i); }

nlohmann::json to_json(const AdaptedError& e) {
  nlohmann::json figures = nlohmann::json::array();
  for (const PassStatistic& figure : e.figures) figures.push_back({figure.name, figure.value});
  return {{"name", e.name}, {"mse", e.mse},       {"frame_s", e.frame_s},
          {"rays", e.rays}, {"pass_s", e.pass_s}, {"figures", figures}};
}

std::vector<AdaptedError> errors_from(const ExrFile& exr, const std::string& place) {
  std::vector<AdaptedError> errors;
  for (const nlohmann::json& json : parse_json(exr.attributes.at(kAttribute), place)) {
    AdaptedError e;
    e.name = json.at("name").get<std::string>();
    e.mse = json.at("mse").get<decltype(e.mse)>();
    e.frame_s = json.at("frame_s").get<decltype(e.frame_s)>();
    e.rays = json.at("rays").get<double>();
    e.pass_s = json.at("pass_s").get<decltype(e.pass_s)>();
    for (const nlohmann::json& figure : json.at("figures"))
      e.figures.push_back({figure.at(0).get<std::string>(), figure.at(1).get<double>()});
    e.last = image_from_exr(exr, layer_of(errors.size()), place);
    errors.push_back(std::move(e));
  }
  return errors;
}

}  // namespace

std::filesystem::path adapted_file(const ExperimentContext& context, const ExperimentScene& scene,
                                   const std::vector<NamedSettings>& contenders, const std::vector<PixelMask>& regions,
                                   const AdaptedOptions& options) {
  std::string text =
      fmt::format("{} {} {} {} {}", options.warm_up, options.frames, options.sessions, options.block, options.seed);
  for (const PixelMask& region : regions) {
    Fnv1a hash;
    hash.add(region.mask.data(), region.mask.size());
    text += fmt::format(" {} {:016x}", region.name, hash.value());
  }
  for (const NamedSettings& contender : contenders) {
    RenderSettings settings = contender.settings;
    text += fmt::format(" {} {}", contender.name, settings_to_json(describe(settings)));
  }
  return part_file(context, scene, "adapted", text);
}

void save_adapted(const std::filesystem::path& file, const std::vector<AdaptedError>& errors) {
  ExrFile exr{errors.front().last.width, errors.front().last.height, {}, {}};
  nlohmann::json list = nlohmann::json::array();
  for (size_t i = 0; i < errors.size(); ++i) {
    list.push_back(to_json(errors[i]));
    for (ExrChannel& channel : exr_channels(errors[i].last, layer_of(i))) exr.channels.push_back(std::move(channel));
  }
  exr.attributes[kAttribute] = list.dump();
  write_part(file, exr);
}

std::optional<std::vector<AdaptedError>> load_adapted(const std::filesystem::path& file) {
  return read_part(file, errors_from);
}

}  // namespace relume
