#include "experiments/survey/survey_scenes.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "relume/scene_io.h"
#include "render/session.h"
#include "settings/nearest_name.h"
#include "settings/text_list.h"

namespace relume {
namespace {

/// Caches that gather light of any number of bounces would differ from a reference with few.
constexpr int kBounces = 16;
constexpr float kTurn_deg = 15;
constexpr float kLater_s = 1;
constexpr const char* kSponza = "Sponza";
constexpr std::string_view kSuffix = ".gltf";

/// Scenes with caustics of small lamps, which path tracing finds rarely or never: errors against it would be wrong.
constexpr std::string_view kWithCaustics[] = {"cornell-spheres", "cornell-water", "cornell-glass", "lamp-room"};
/// Merging with a small radius, as in the experiment `caustics`. Its bias is not subtracted from errors.
constexpr const char* kForCaustics = "estimator:vcm,vcm.radius:0.002,vcm.alpha:0.75";

std::filesystem::path file_in(const std::filesystem::path& folder, const std::string& stem) {
  return folder / stem / (stem + std::string(kSuffix));
}

/// Names of the scenes in a folder, sorted.
std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code failure;
  for (std::filesystem::directory_iterator i(folder, failure), end; !failure && i != end; i.increment(failure)) {
    const std::string stem = i->path().filename().string();
    if (std::error_code missing; !std::filesystem::exists(file_in(folder, stem), missing)) continue;
    names.push_back(stem == "sponza" ? kSponza : stem + std::string(kSuffix));
  }
  if (failure)
    throw Error(fmt::format("{}: the folder cannot be read ({}); choose another", folder.string(), failure.message()));
  std::sort(names.begin(), names.end());
  return names;
}

/// Whether anything except cameras is animated.
bool changes_by_itself(const Scene& scene) {
  const auto moves_camera = [&](const AnimationChannel& channel) {
    return channel.node != kNone && scene.nodes[static_cast<size_t>(channel.node)].camera != kNone;
  };
  const auto is_of_camera = [](const ParameterChannel& channel) { return channel.part == AnimatedPart::camera; };
  return !std::all_of(scene.animation.begin(), scene.animation.end(), moves_camera) ||
         !std::all_of(scene.parameter_animation.begin(), scene.parameter_animation.end(), is_of_camera);
}

ExperimentScene from_file(const std::filesystem::path& file, const std::string& name) {
  ExperimentScene scene{.name = name, .scene = load_scene(file)};
  scene.settings.width = scene.settings.height = 1;
  scene.camera = Session(Scene(scene.scene), scene.settings).camera();
  scene.settings = {};
  return scene;
}

ExperimentScene scene_named(const ExperimentContext& context, const std::string& name) {
  if (name == kSponza) {
    if (std::optional<ExperimentScene> hall = sponza(context)) return std::move(*hall);
    throw Error(kNoSponza);
  }
  if (!name.ends_with(kSuffix)) return at_rest(built_in(name, kBounces));
  return from_file(file_in(context.scene_folder, name.substr(0, name.size() - kSuffix.size())), name);
}

}  // namespace

std::vector<std::string> survey_scene_names(const ExperimentContext& context) {
  std::vector<std::string> names;
  for (const BuiltinScene& scene : builtin_scenes()) names.emplace_back(scene.name);
  if (context.scene_folder.empty()) return names;
  for (std::string& name : names_in(context.scene_folder)) names.push_back(std::move(name));
  return names;
}

std::vector<std::string> chosen_scenes(const ExperimentContext& context, std::string_view names) {
  const std::vector<std::string> all = survey_scene_names(context);
  std::vector<std::string> chosen;
  for (const std::string_view part : split_at_commas(names)) {
    const std::string name(part);
    if (!find_builtin_scene(name) && std::find(all.begin(), all.end(), name) == all.end())
      throw Error(fmt::format("the survey has no scene '{}'{}", name, suggestion(name, all)));
    if (std::find(chosen.begin(), chosen.end(), name) == chosen.end()) chosen.push_back(name);
  }
  return chosen.empty() ? all : chosen;
}

SurveyScene survey_scene(const ExperimentContext& context, const std::string& name) {
  SurveyScene result{.before = scene_named(context, name), .camera_after = {}, .change = {}};
  result.before.settings.path.max_bounces = kBounces;
  result.camera_after = *result.before.camera;
  if (std::find(std::begin(kWithCaustics), std::end(kWithCaustics), name) != std::end(kWithCaustics))
    result.reference = kForCaustics;
  if (changes_by_itself(result.before.scene)) {
    result.time_after_s = kLater_s;
    result.change = fmt::format("{} s passes", kLater_s);
  } else {
    result.camera_after = *turned(result.before, kTurn_deg);
    result.change = fmt::format("the camera turns by {}°", kTurn_deg);
  }
  return result;
}

}  // namespace relume
