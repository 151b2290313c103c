// Stores results of measure_adapted() in files, for interrupted experiments.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/measure/adapted_error.h"

namespace relume {

/// File of a measurement; empty if the context stores none. Its name excludes the reference: an experiment has one per
/// scene.
std::filesystem::path adapted_file(const ExperimentContext& context, const ExperimentScene& scene,
                                   const std::vector<NamedSettings>& contenders, const std::vector<PixelMask>& regions,
                                   const AdaptedOptions& options);

/// Writes an EXR with the last frames, and all numbers in an attribute. Throws Error.
void save_adapted(const std::filesystem::path& file, const std::vector<AdaptedError>& errors);

/// Reads such a file; std::nullopt if it is missing or invalid.
std::optional<std::vector<AdaptedError>> load_adapted(const std::filesystem::path& file);

}  // namespace relume
