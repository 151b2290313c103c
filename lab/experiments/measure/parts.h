// Files for what an experiment has measured before it was interrupted.
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

/// KIND-HASH.exr in the context's folder; empty without one. The name hashes the program, the scene, where the camera
/// stands and `text`, which says everything else on which the measurement depends.
std::filesystem::path part_file(const ExperimentContext& context, const ExperimentScene& scene, std::string_view kind,
                                const std::string& text);

/// What `parse` makes of the file; std::nullopt if there is none, or it is something else.
template <typename Parse>
auto read_part(const std::filesystem::path& file, const Parse& parse) {
  std::optional<decltype(parse(ExrFile{}, std::string{}))> result;
  if (file.empty() || !std::filesystem::exists(file)) return result;
  try {
    result = parse(read_exr(file), file.string());
  } catch (const std::exception&) {
    result.reset();  // whatever is wrong with it: it is measured again
  }
  return result;
}

/// Writes it, with its folder. Throws Error.
void write_part(const std::filesystem::path& file, const ExrFile& part);

}  // namespace relume
