// Adapted errors in files: what measure_adapted() has found before the experiment was interrupted.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/measure/adapted_error.h"

namespace relume {

/// The file for such a measurement; empty if the context keeps none. The reference is not in its name: each experiment
/// has one for a scene.
std::filesystem::path adapted_file(const ExperimentContext& context, const ExperimentScene& scene,
                                   const std::vector<NamedSettings>& contenders, const std::vector<PixelMask>& regions,
                                   const AdaptedOptions& options);

/// An EXR with the last frames, and all numbers as an attribute. Throws Error.
void save_adapted(const std::filesystem::path& file, const std::vector<AdaptedError>& errors);

/// std::nullopt if there is no such file, or it is something else.
std::optional<std::vector<AdaptedError>> load_adapted(const std::filesystem::path& file);

}  // namespace relume
