#include "io/assimp/assimp_loader.h"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <assimp/Importer.hpp>

#include "core/error.h"
#include "io/assimp/assimp_materials.h"
#include "io/assimp/assimp_nodes.h"
#include "io/assimp/trial_run.h"
#include "io/bytes.h"
#include "io/extension.h"
#include "io/ply/ply_loader.h"
#include "io/scene_io.h"

namespace relume {
namespace {

/// What load_assimp() accepts. assimp reads more, but its rarer importers do not check their input.
constexpr std::array<std::string_view, 7> kExtensions = {"obj", "fbx", "dae", "ply", "stl", "3ds", "off"};
/// assimp computes sizes in 32 bits.
constexpr uintmax_t kMaxFileSize = uintmax_t{1} << 31;
/// Faces that meet at a smaller angle share a smooth normal where a file has none.
constexpr float kCreaseAngleDeg = 60;

unsigned post_processing(std::string_view extension) {
  unsigned steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType |
                   aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices | aiProcess_TransformUVCoords |
                   aiProcess_FlipUVs;
  if (extension == "fbx") steps |= aiProcess_GlobalScale;  // centimetres to metres
  return steps;
}

void configure(Assimp::Importer& importer) {
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCreaseAngleDeg);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
}

[[noreturn]] void fail_without_triangles(const std::string& place) {
  throw Error(fmt::format("{}: the file has no triangles; check that it is the right one", place));
}

Scene convert(const aiScene* source, const std::string& problem, const std::filesystem::path& base_dir,
              const std::string& place) {
  if (!source) {
    std::string reason = problem.empty() ? "its content is not understood" : problem;
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    // What assimp says of files with points and lines only, or with nothing at all.
    for (const char* empty : {"No meshes", "no faces", "no meshes"}) {
      if (reason.find(empty) != std::string::npos) fail_without_triangles(place);
    }
    throw Error(fmt::format("{}: the file cannot be read: {}", place, reason));
  }
  Scene scene;
  scene.name = std::filesystem::path(place).stem().string();
  Warnings warnings(place);
  if (source->mFlags & AI_SCENE_FLAGS_INCOMPLETE) warnings.add("the file is incomplete; what it has is shown");
  AssimpTextures textures(*source, base_dir, scene, warnings);
  import_assimp_materials(*source, textures, scene, warnings);
  textures.finish();
  darken_missing_lamps(*source, textures, scene);
  mask_transparent_textures(textures, scene);
  const std::vector<Index> mesh_of = import_assimp_meshes(*source, scene, warnings);
  import_assimp_nodes(*source, mesh_of, scene, warnings);
  if (scene.meshes.empty()) fail_without_triangles(place);
  scene.warnings = warnings.take();
  validate(scene, place);
  return scene;
}

/// assimp crashes or hangs on some damaged files, so that a child process reads every file first. `read` calls assimp.
template <typename Read>
void check_by_trial(const std::string& place, uintmax_t file_size, const Read& read) {
  constexpr uint64_t kMebibyte = uint64_t{1} << 20;
  const auto trial = [&] {
    Assimp::Importer importer;
    configure(importer);
    read(importer);
  };
  if (!survives_trial(trial, 3 + file_size / kMebibyte, 1024 * kMebibyte + 256 * file_size))
    throw Error(fmt::format("{}: reading the file would crash, or take too long; it is damaged", place));
}

/// Turns what assimp throws into an Error.
template <typename Read>
Scene guarded(const std::string& place, const std::filesystem::path& base_dir, uintmax_t file_size, const Read& read) {
  check_by_trial(place, file_size, read);
  try {
    Assimp::Importer importer;
    configure(importer);
    const aiScene* source = read(importer);
    return convert(source, importer.GetErrorString(), base_dir, place);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(fmt::format("{}: the file cannot be read: {}", place, error.what()));
  }
}

}  // namespace

Scene load_assimp_from_memory(std::span<const std::byte> file, const std::string& extension, const std::string& place) {
  if (extension == "ply") return load_ply_from_memory(file, place);
  return guarded(place, {}, file.size(), [&](Assimp::Importer& importer) {
    return importer.ReadFileFromMemory(file.data(), file.size(), post_processing(extension), extension.c_str());
  });
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
    throw Error(fmt::format("{}: the file does not exist; check its path", file.string()));
  if (size > kMaxFileSize)
    throw Error(fmt::format("{}: the file is larger than 2 GiB; convert it to glTF", file.string()));
  if (size == 0) throw Error(fmt::format("{}: the file is empty; export or copy it again", file.string()));
  if (extension == "ply") return load_ply_from_memory(read_file_bytes(file), file.string());
  return guarded(file.string(), file.parent_path(), size, [&](Assimp::Importer& importer) {
    return importer.ReadFile(file.string(), post_processing(extension));
  });
}

}  // namespace relume
