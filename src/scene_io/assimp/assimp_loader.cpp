#include "scene_io/assimp/assimp_loader.h"

#include <algorithm>

#include <fmt/format.h>

#include "files/bytes.h"
#include "files/extension.h"
#include "files/read_record.h"
#include "relume/error.h"
#include "scene_io/assimp/assimp_import.h"
#include "scene_io/assimp/assimp_textures.h"
#include "scene_io/assimp/trial_run.h"

namespace relume {
namespace {

/// assimp computes sizes with 32 bits.
constexpr uintmax_t kMaxFileSize = uintmax_t{1} << 31;

/// Generous limits for valid files.
TrialLimits limits_for(uintmax_t file_size) {
  constexpr uint64_t kMebibyte = uint64_t{1} << 20;
  TrialLimits limits;
  limits.cpu_s = 3 + file_size / kMebibyte;
  limits.wall_s = 5 + 2 * static_cast<double>(limits.cpu_s);
  limits.memory_bytes = 1024 * kMebibyte + 256 * file_size;
  return limits;
}

/// Runs assimp in a child process: some damaged files make it crash, hang or exhaust memory.
Scene load(const AssimpSource& source, uintmax_t file_size) {
  ImportedScene imported =
      deserialise(run_trial([&] { return serialise(import_with_assimp(source)); }, limits_for(file_size), source.place),
                  source.place);
  for (const std::string& file : imported.files) record_read(file);
  if (!imported.problem.empty()) throw Error(imported.problem);
  Warnings warnings(source.place);
  AssimpTextures textures(imported, source.file.parent_path(), warnings);
  textures.finish();
  textures.darken_missing_lamps();
  textures.mask_transparent_textures();
  Scene scene = std::move(imported.scene);
  scene.environment.kind = EnvironmentKind::automatic;
  for (std::string& warning : warnings.take()) scene.warnings.push_back(std::move(warning));
  validate(scene, source.place);
  return scene;
}

}  // namespace

Scene load_assimp_from_memory(std::span<const std::byte> file, const std::string& extension, const std::string& place) {
  return load({extension, place, {}, file}, file.size());
}

Scene load_assimp(const std::filesystem::path& file) {
  std::error_code unreadable;
  const uintmax_t size = std::filesystem::file_size(file, unreadable);
  if (unreadable)
    throw Error(ErrorCode::not_found, fmt::format("{}: the file cannot be read; check its path", file.string()));
  if (size > kMaxFileSize)
    throw Error(fmt::format("{}: the file is larger than 2 GiB; convert it to glTF", file.string()));
  const std::string extension = lower_extension(file);
  return load({extension.substr(std::min<size_t>(extension.size(), 1)), file.string(), file, {}}, size);
}

}  // namespace relume
