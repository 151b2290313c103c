// Files for what an experiment has measured before it was interrupted.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "experiments/experiment.h"
#include "experiments/scenes.h"
#include "io/image.h"

namespace relume {

/// KIND-HASH.exr in the context's folder; empty without one. The name hashes the program, the scene, where the camera
/// stands and `text`, which says everything else on which the measurement depends.
std::filesystem::path part_file(const ExperimentContext& context, const ExperimentScene& scene, std::string_view kind,
                                const std::string& text);

/// Writes it, with its folder. Throws Error.
void write_part(const std::filesystem::path& file, const ExrFile& part);

}  // namespace relume
