// Stores partial measurements of interrupted experiments in files.
#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"

namespace relume {

/// KIND-HASH.exr in the context's folder; empty without one. The name hashes the program, the scene, the camera pose
/// and `text`, which must contain all other conditions of the measurement.
std::filesystem::path part_file(const ExperimentContext& context, const ExperimentScene& scene, std::string_view kind,
                                const std::string& text);

/// Result of `parse` for the file; std::nullopt if it is missing or invalid.
template <typename Parse>
auto read_part(const std::filesystem::path& file, const Parse& parse) {
  std::optional<decltype(parse(ExrFile{}, std::string{}))> result;
  if (std::error_code failure; !std::filesystem::exists(file, failure)) return result;
  try {
    result = parse(read_exr(file), file.string());
  } catch (const std::exception&) {
    result.reset();  // any failure leads to a new measurement
  }
  return result;
}

/// Writes the file and its folder. Throws Error.
void write_part(const std::filesystem::path& file, const ExrFile& part);

}  // namespace relume
