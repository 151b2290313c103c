// The scenes of the survey, each with a change after which techniques must adapt.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

struct SurveyScene {
  ExperimentScene before;  ///< also the still view
  CameraPose camera_after;
  float time_after_s = 0;
  std::string change;                           ///< "the camera turns by 15°"
  std::string reference = "lights:light-tree";  ///< settings of the references, in the syntax of `relume compare`
};

/// All built-in scenes, and those in the context's scene folder: Sponza, and NAME.gltf for NAME/NAME.gltf. Throws Error
/// if the folder cannot be read.
std::vector<std::string> survey_scene_names(const ExperimentContext& context);

/// The names that `names` lists, separated by commas; empty: all. Scenes of experiments can be named, too. Throws Error
/// for unknown names.
std::vector<std::string> chosen_scenes(const ExperimentContext& context, std::string_view names);

/// The scene of that name. Where lamps or objects are animated, one second passes; elsewhere the camera turns. Throws
/// Error if a file cannot be read.
SurveyScene survey_scene(const ExperimentContext& context, const std::string& name);

}  // namespace relume
