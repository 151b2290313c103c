#include "experiments/measure/moving_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/measure/parts.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "files/json_parse.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kAttribute = "relume.moving";
constexpr const char* kReferenceLayer = "reference";

std::string layer_of(size_t i) { return fmt::format("contender{}", i); }

void add_channels(const Image& image, const std::string& layer, ExrFile& exr) {
  for (ExrChannel& channel : exr_channels(image, layer)) exr.channels.push_back(std::move(channel));
}

nlohmann::json to_json(const MovingError& e) {
  return {{"name", e.name}, {"frames", e.frames}, {"time_share", e.time_share}, {"mse", e.mse}, {"flip", e.flip},
          {"mses", e.mses}, {"flips", e.flips}};
}

MovingErrors errors_from(const ExrFile& exr, const std::string& place) {
  const nlohmann::json all = parse_json(exr.attributes.at(kAttribute), place);
  MovingErrors errors{.scene = all.at("scene").get<std::string>(),
                      .contenders = {},
                      .reference = image_from_exr(exr, kReferenceLayer, place),
                      .reference_mse = all.at("reference_mse").get<double>()};
  for (const nlohmann::json& json : all.at("contenders")) {
    MovingError e;
    e.name = json.at("name").get<std::string>();
    e.frames = json.at("frames").get<int>();
    e.time_share = json.at("time_share").get<double>();
    e.mse = json.at("mse").get<double>();
    e.flip = json.at("flip").get<double>();
    e.mses = json.at("mses").get<std::vector<double>>();
    e.flips = json.at("flips").get<std::vector<double>>();
    e.last = image_from_exr(exr, layer_of(errors.contenders.size()), place);
    errors.contenders.push_back(std::move(e));
  }
  return errors;
}

}  // namespace

std::filesystem::path moving_file(const ExperimentContext& context, const ExperimentScene& scene,
                                  const std::vector<MovingContender>& contenders, const MovingOptions& options) {
  std::string text = fmt::format("{} {} {} {} {} {} {} {} {} {} {}", scene.name, scene.settings.time_s, options.frames,
                                 options.equal_frames, options.views, options.repetitions, options.step_deg,
                                 options.step_m, options.animation_step_s, options.reference_spp, options.reference);
  RenderSettings of_references = plainly_sampled(scene).settings;
  set_size_and_device(context, of_references);
  text += ' ' + settings_to_json(describe(of_references));
  for (const MovingContender& contender : contenders) {
    RenderSettings settings = contender.settings;
    set_size_and_device(context, settings);
    text += fmt::format(" {} {} {}", contender.name, contender.repetitions, settings_to_json(describe(settings)));
  }
  return part_file(context, scene, "moving", text);
}

void save_moving(const std::filesystem::path& file, const MovingErrors& errors) {
  ExrFile exr{errors.reference.width, errors.reference.height, {}, {}};
  add_channels(errors.reference, kReferenceLayer, exr);
  nlohmann::json list = nlohmann::json::array();
  for (size_t i = 0; i < errors.contenders.size(); ++i) {
    list.push_back(to_json(errors.contenders[i]));
    add_channels(errors.contenders[i].last, layer_of(i), exr);
  }
  exr.attributes[kAttribute] =
      nlohmann::json{{"scene", errors.scene}, {"reference_mse", errors.reference_mse}, {"contenders", list}}.dump();
  write_part(file, exr);
}

std::optional<MovingErrors> load_moving(const std::filesystem::path& file) { return read_part(file, errors_from); }

}  // namespace relume
