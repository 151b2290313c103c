// Everything that decides what a session renders, apart from the scene.
#pragma once

#include <string>

#include "settings/setting.h"
#include "techniques/path/path_settings.h"

namespace relume {

enum class EstimatorChoice : int { path };
enum class LightSelectionChoice : int { uniform, power };
enum class ToneMapChoice : int { none, reinhard, aces, agx };

struct RenderSettings {
  int width = 1280;
  int height = 720;
  int seed = 0;
  int threads = 0;         ///< 0: all
  std::string camera;      ///< name or index; empty: the file's first
  float time_s = 0;        ///< time of the animation
  EstimatorChoice estimator = EstimatorChoice::path;
  LightSelectionChoice lights = LightSelectionChoice::power;
  bool auxiliary = false;  ///< record albedo, normal, depth and motion of the first hit
  PathSettings path;
};

SettingList describe(RenderSettings& settings);

}  // namespace relume
