// Traces in files: what an experiment has measured before it was interrupted.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/measure/trace.h"

namespace relume {

/// The file for such a measurement; empty if the context keeps none. Lens and reference are not in its name: each
/// experiment has one of either for a scene.
std::filesystem::path trace_file(const ExperimentContext& context, const ExperimentScene& scene,
                                 const std::vector<TraceContender>& contenders, const TraceOptions& options);

/// An EXR with images and maps, and points as an attribute. Requires that images were taken. Throws Error.
void save_traces(const std::filesystem::path& file, const std::vector<Trace>& traces);

/// std::nullopt if there is no such file, or it is something else.
std::optional<std::vector<Trace>> load_traces(const std::filesystem::path& file);

}  // namespace relume
