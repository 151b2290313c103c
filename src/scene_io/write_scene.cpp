#include <fmt/format.h>

#include "files/extension.h"
#include "relume/error.h"
#include "relume/scene_io.h"

namespace relume {

std::vector<std::string> write_scene(const std::filesystem::path& file, const Scene& scene) {
  const std::string extension = lower_extension(file);
  if (extension == ".gltf" || extension == ".glb") return write_gltf(file, scene);
  if (extension == ".pbrt") return write_pbrt(file, scene);
  throw Error(
      fmt::format("{}: scenes are written as .gltf, .glb or .pbrt; choose one of these extensions", file.string()));
}

}  // namespace relume
