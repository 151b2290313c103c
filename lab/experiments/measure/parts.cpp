#include "experiments/measure/parts.h"

#include <fmt/format.h>

#include "core/fnv1a.h"
#include "relume/error.h"
#include "scene/scene_hash.h"

namespace relume {

std::filesystem::path part_file(const ExperimentContext& context, const ExperimentScene& scene, std::string_view kind,
                                const std::string& text) {
  if (context.parts_folder.empty()) return {};
  std::string all = fmt::format("{} {:016x} {}", context.program, scene_hash(scene.scene), text);
  if (scene.camera) {
    for (int column = 0; column < 4; ++column) {
      const Vec4& v = scene.camera->to_world[column];
      all += fmt::format(" {} {} {} {}", v.x, v.y, v.z, v.w);
    }
  }
  Fnv1a hash;
  hash.add(all.data(), all.size());
  return context.parts_folder / fmt::format("{}-{:016x}.exr", kind, hash.value());
}

void write_part(const std::filesystem::path& file, const ExrFile& part) {
  const std::filesystem::path folder = file.parent_path();
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error(
        fmt::format("{}: the folder cannot be created ({}); choose another", folder.string(), failure.message()));
  write_exr(file, part);
}

}  // namespace relume
