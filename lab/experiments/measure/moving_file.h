// Stores results of measure_moving() in files, for interrupted experiments.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/measure/moving_error.h"

namespace relume {

/// File of a measurement; empty if the context stores none.
std::filesystem::path moving_file(const ExperimentContext& context, const ExperimentScene& scene,
                                  const std::vector<MovingContender>& contenders, const MovingOptions& options);

/// Writes an EXR with the images, and all numbers in an attribute. Throws Error.
void save_moving(const std::filesystem::path& file, const MovingErrors& errors);

/// Reads such a file; std::nullopt if it is missing or invalid.
std::optional<MovingErrors> load_moving(const std::filesystem::path& file);

}  // namespace relume
