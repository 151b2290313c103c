#include "scene_io/assimp/assimp_loader.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "files/bytes.h"
#include "files/extension.h"
#include "relume/error.h"
#include "scene_io/assimp/assimp_import.h"
#include "scene_io/assimp/assimp_textures.h"
#include "scene_io/assimp/trial_run.h"
#include "scene_io/ply/ply_loader.h"
#include "scene_io/scene_io.h"

namespace relume {
namespace {

/// What load_assimp() accepts. assimp reads more, but its rarer importers do not check their input.
constexpr std::array<std::string_view, 7> kExtensions = {"obj", "fbx", "dae", "ply", "stl", "3ds", "off"};
/// assimp computes sizes in 32 bits.
constexpr uintmax_t kMaxFileSize = uintmax_t{1} << 31;

/// Generous for every file that was written as its format says.
TrialLimits limits_for(uintmax_t file_size) {
  constexpr uint64_t kMebibyte = uint64_t{1} << 20;
  TrialLimits limits;
  limits.cpu_s = 3 + file_size / kMebibyte;
  limits.wall_s = 5 + 2 * static_cast<double>(limits.cpu_s);
  limits.memory_bytes = 1024 * kMebibyte + 256 * file_size;
  return limits;
}

/// assimp crashes, hangs or takes any memory on some damaged files, so that only a child process runs it.
Scene load(const AssimpSource& source, uintmax_t file_size) {
  ImportedScene imported =
      deserialise(run_trial([&] { return serialise(import_with_assimp(source)); }, limits_for(file_size), source.place),
                  source.place);
  if (!imported.problem.empty()) throw Error(imported.problem);
  Warnings warnings(source.place);
  AssimpTextures textures(imported, source.file.parent_path(), warnings);
  textures.finish();
  textures.darken_missing_lamps();
  textures.mask_transparent_textures();
  Scene scene = std::move(imported.scene);
  for (std::string& warning : warnings.take()) scene.warnings.push_back(std::move(warning));
  validate(scene, source.place);
  return scene;
}

}  // namespace

Scene load_assimp_from_memory(std::span<const std::byte> file, const std::string& extension, const std::string& place) {
  if (extension == "ply") return load_ply_from_memory(file, place);
  return load({extension, place, {}, file}, file.size());
}

Scene load_assimp(const std::filesystem::path& file) {
  std::string extension = lower_extension(file);
  if (!extension.empty()) extension.erase(0, 1);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
    throw Error(fmt::format("{}: scene files with extension '{}' are not supported; use gltf, glb, json, {}",
                            file.string(), extension, fmt::join(kExtensions, ", ")));
  std::error_code error;
  const uintmax_t size = std::filesystem::is_regular_file(file, error) ? std::filesystem::file_size(file, error) : 0;
  if (error || !std::filesystem::is_regular_file(file))
    throw Error(ErrorCode::not_found, fmt::format("{}: the file does not exist; check its path", file.string()));
  if (size > kMaxFileSize)
    throw Error(fmt::format("{}: the file is larger than 2 GiB; convert it to glTF", file.string()));
  if (size == 0) throw Error(fmt::format("{}: the file is empty; export or copy it again", file.string()));
  if (extension == "ply") return load_ply_from_memory(read_file_bytes(file), file.string());
  return load({extension, file.string(), file, {}}, size);
}

}  // namespace relume
