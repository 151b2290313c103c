// Stores traces in files, for interrupted experiments.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/measure/trace.h"

namespace relume {

/// File of a measurement; empty if the context stores none. Its name excludes lens and reference: an experiment has one
/// of each per scene.
std::filesystem::path trace_file(const ExperimentContext& context, const ExperimentScene& scene,
                                 const std::vector<TraceContender>& contenders, const TraceOptions& options);

/// Writes an EXR with images and maps, and points in an attribute. Requires recorded images. Throws Error.
void save_traces(const std::filesystem::path& file, const std::vector<Trace>& traces);

/// Reads such a file; std::nullopt if it is missing or invalid.
std::optional<std::vector<Trace>> load_traces(const std::filesystem::path& file);

}  // namespace relume
