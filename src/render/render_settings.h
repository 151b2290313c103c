// Everything that decides what a session renders, apart from the scene.
#pragma once

#include <string>

#include "settings/setting.h"

namespace relume {

enum class EstimatorChoice : int { path };
enum class LightSelectionChoice : int { uniform, power };
enum class ToneMapChoice : int { none, reinhard, aces, agx };

/// Settings of the path estimator.
struct PathSettings {
  int max_bounces = 8;
  bool russian_roulette = true;
};

struct RenderSettings {
  int width = 1280;
  int height = 720;
  int seed = 0;
  int threads = 0;         ///< 0: all
  std::string camera;      ///< name or index; empty: the file's first
  float time_s = 0;        ///< time of the animation
  EstimatorChoice estimator = EstimatorChoice::path;
  LightSelectionChoice lights = LightSelectionChoice::power;
  PathSettings path;
};

SettingList describe(PathSettings& settings);
SettingList describe(RenderSettings& settings);

}  // namespace relume
