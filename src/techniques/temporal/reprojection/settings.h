// Settings of reprojection.
#pragma once

#include <cstdint>

#include "settings/setting.h"

namespace relume {

enum class ReprojectionMethod : int { forward, backward };
enum class StoredSampleChoice : int { one, four };

struct ReprojectionSettings {
  ReprojectionMethod method = ReprojectionMethod::forward;
  StoredSampleChoice stored = StoredSampleChoice::four;
  bool fill = true;
  float error = 1.0f / 256.0f;
  float light_error = 8.0f / 256.0f;
  float exposure = 0;
  float max_distance = 0.02f;
  int max_samples = 1024;
  int max_samples_changed = 16;

  uint32_t capacity() const { return stored == StoredSampleChoice::four ? 4u : 1u; }
};

SettingList describe(ReprojectionSettings& settings);

}  // namespace relume
