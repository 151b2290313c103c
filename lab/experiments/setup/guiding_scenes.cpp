#include "experiments/setup/guiding_scenes.h"

#include <utility>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include "experiments/setup/learning_scenes.h"

namespace relume {

ExperimentScene mine(std::string name, bool environment, int scale) {
  ExperimentScene scene = learning_scene("mine");
  scene.name = std::move(name);
  scene.settings.light_selection.environment = environment;
  scene.scale = scale;
  return scene;
}

ExperimentScene built_in_mine(const char* name, const char* suffix, int scale) {
  ExperimentScene scene = learning_scene(name);
  scene.name += suffix;
  scene.settings.light_selection.environment = false;
  scene.scale = scale;
  return scene;
}

ExperimentScene skylight(const char* suffix, int scale) {
  ExperimentScene scene = learning_scene("skylight");
  scene.name += suffix;
  scene.scale = scale;
  return scene;
}

ExperimentScene mine_with_sun(float degrees) {
  ExperimentScene scene = mine(fmt::format("mine, a sun of {}°, environment not sampled, small", degrees), false, 1);
  scene.scene.environment.sun_sky.sun_angular_diameter_rad = glm::radians(degrees);
  return scene;
}

}  // namespace relume
