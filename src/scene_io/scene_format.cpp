#include "scene_io/scene_format.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "files/extension.h"
#include "relume/error.h"
#include "scene_io/assimp/assimp_loader.h"
#include "scene_io/gltf/gltf_json.h"
#include "scene_io/gltf/gltf_loader.h"
#include "scene_io/mitsuba/mitsuba_loader.h"
#include "scene_io/pbrt/pbrt_loader.h"
#include "scene_io/ply/ply_loader.h"
#include "scene_io/relume_json/relume_json.h"

namespace relume {
namespace {

std::string gltf_contents() {
  return fmt::format(
      "nodes, instances, meshes, skins, morph targets, materials, textures, cameras, lights, animations. Extensions: "
      "{}. Other extensions are ignored with a warning. A `minVersion` above 2.0 gives a warning",
      fmt::join(gltf::supported_extensions(), ", "));
}

constexpr const char* kJsonContents =
    "relume's format for a scene of another format, with changes ([reference](scene-json.md))";
constexpr const char* kPlyContents =
    "one mesh with normals, texture coordinates and colours; integer colours are sRGB, floats are linear";
constexpr const char* kPbrtContents =
    "shapes, objects with instances, textures, materials, lights, environment, camera, film, motion of transforms of "
    "pbrt-v4; turned to +Y up, and mirrored where pbrt's camera is left-handed ([details](formats.md#pbrt))";
constexpr const char* kMitsubaContents =
    "scenes of Mitsuba 3, and of 0.6 as far as 3 reads them: shapes, instances, BSDFs, textures, emitters, sensors, "
    "parameters, includes ([details](formats.md#mitsuba))";
constexpr const char* kAssimpContents =
    "nodes, meshes, materials, textures, lights and cameras, through assimp; lengths and axes are unchanged";
constexpr const char* kAssimpMetricContents =
    "nodes, meshes, materials, textures, lights and cameras, through assimp; converted to metres and +Y up";

std::string first_bytes(const std::filesystem::path& file, size_t count) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  std::string bytes(count, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<size_t>(in.gcount()));
  return bytes;
}

/// An unsupported format and a converter to glTF.
struct ForeignFormat {
  std::vector<std::string_view> extensions;
  std::string_view name;
  std::string_view remedy;
};

constexpr std::string_view kBlender = "import the file into Blender and export glTF 2.0 from there";

const ForeignFormat* foreign_format(std::string_view extension) {
  static const std::vector<ForeignFormat> kFormats = {
      {{"blend"}, "Blender", "export glTF 2.0 from Blender"},
      {{"usd", "usda", "usdc", "usdz"}, "USD", kBlender},
      {{"abc"}, "Alembic", kBlender},
      {{"x3d", "wrl"}, "X3D and VRML", kBlender},
      {{"max"}, "3ds Max", "export glTF 2.0 or FBX from 3ds Max"},
      {{"ma", "mb"}, "Maya", "export FBX from Maya"},
      {{"c4d"}, "Cinema 4D", "export glTF 2.0 from Cinema 4D"},
      {{"skp"}, "SketchUp", "export glTF 2.0 or DAE from SketchUp"},
      {{"3dm"}, "Rhino", "export glTF 2.0 or OBJ from Rhino"},
      {{"step", "stp", "iges", "igs"}, "CAD", "export STL, OBJ or glTF 2.0 from FreeCAD"},
  };
  for (const ForeignFormat& format : kFormats) {
    if (std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end())
      return &format;
  }
  return nullptr;
}

/// Extension in lower case without its dot; the last two of compressed files.
std::string extension_of(const std::filesystem::path& file) {
  std::string extension = lower_extension(file);
  if (extension == ".gz") extension = lower_extension(file.stem()) + extension;
  if (!extension.empty()) extension.erase(0, 1);
  return extension;
}

std::vector<std::string_view> all_extensions() {
  std::vector<std::string_view> all;
  for (const SceneFormat& format : scene_formats())
    all.insert(all.end(), format.extensions.begin(), format.extensions.end());
  return all;
}

}  // namespace

const std::vector<SceneFormat>& scene_formats() {
  static const std::vector<SceneFormat> kFormats = {
      {"glTF", {"gltf", "glb"}, "glTF", load_gltf, gltf_contents()},
      {"relume JSON", {"json"}, "", load_relume_json, kJsonContents},
      {"pbrt", {"pbrt", "pbrt.gz"}, "", load_pbrt, kPbrtContents},
      {"Mitsuba", {"xml"}, "", load_mitsuba, kMitsubaContents},
      {"PLY", {"ply"}, "", load_ply, kPlyContents},
      {"OBJ", {"obj"}, "", load_assimp, kAssimpContents},
      {"FBX", {"fbx"}, "", load_assimp, kAssimpMetricContents},
      {"DAE", {"dae"}, "", load_assimp, kAssimpMetricContents},
      {"STL", {"stl"}, "", load_assimp, kAssimpContents},
      {"3DS", {"3ds"}, "", load_assimp, kAssimpContents},
      {"OFF", {"off"}, "", load_assimp, kAssimpContents},
  };
  return kFormats;
}

const SceneFormat& scene_format_of(const std::filesystem::path& file) {
  constexpr size_t kLongestSignature = 16;
  const std::string start = first_bytes(file, kLongestSignature);
  for (const SceneFormat& format : scene_formats()) {
    if (!format.signature.empty() && start.starts_with(format.signature)) return format;
  }
  const std::string extension = extension_of(file);
  for (const SceneFormat& format : scene_formats()) {
    if (std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end())
      return format;
  }
  if (const ForeignFormat* foreign = foreign_format(extension))
    throw Error(fmt::format("{}: {} files are not read; {}", file.string(), foreign->name, foreign->remedy));
  throw Error(fmt::format("{}: scene files with extension '{}' are not supported; use {}", file.string(), extension,
                          fmt::join(all_extensions(), ", ")));
}

std::string scene_format_names() {
  const std::vector<SceneFormat>& formats = scene_formats();
  std::string names;
  for (size_t i = 0; i < formats.size(); ++i) {
    names += i == 0 ? "" : i + 1 < formats.size() ? ", " : " or ";
    names += formats[i].name;
  }
  return names;
}

std::string scene_formats_reference() {
  std::string text =
      "# Scene formats\n\nMade by `relume scenes --formats` from the declarations in the code. "
      "[Scene\nfiles](scene-json.md#other-formats) describes how readers treat features that they "
      "cannot\nrepresent.\n\n| format | extensions | contents |\n|---|---|---|\n";
  for (const SceneFormat& format : scene_formats()) {
    text += fmt::format("| {} | `.{}` | {} |\n", format.name, fmt::join(format.extensions, "`, `."), format.contents);
  }
  return text;
}

}  // namespace relume
