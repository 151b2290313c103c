#include "scene_io/assimp/assimp_import.h"

#include <algorithm>
#include <exception>
#include <memory>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/texture.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include "scene_io/assimp/assimp_materials.h"
#include "scene_io/assimp/assimp_messages.h"
#include "scene_io/assimp/assimp_nodes.h"

namespace relume {
namespace {

/// Creates smooth normals between faces that meet below this angle, if the file has none.
constexpr float kCreaseAngleDeg = 60;
constexpr size_t kMaxEmbeddedTexels = size_t{1} << 28;
constexpr unsigned kRemoved = ~0u;

/// Lists the files that assimp opens. It looks for material libraries in several places, and picks others for missing
/// ones.
class RecordingFiles : public Assimp::DefaultIOSystem {
 public:
  /// `names` must outlive this object.
  explicit RecordingFiles(std::vector<std::string>& names) : names_(names) {}

  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (std::find(names_.begin(), names_.end(), file) == names_.end()) names_.emplace_back(file);
    return DefaultIOSystem::Open(file, mode);
  }

 private:
  std::vector<std::string>& names_;
};

unsigned post_processing(std::string_view extension) {
  unsigned steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType |
                   aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices | aiProcess_TransformUVCoords |
                   aiProcess_FlipUVs;
  if (extension == "fbx") steps |= aiProcess_GlobalScale;  // centimetres to metres
  return steps;
}

/// `files` receives the names of opened files, and must outlive the importer.
void configure(Assimp::Importer& importer, std::vector<std::string>& files) {
  importer.SetIOHandler(std::make_unique<RecordingFiles>(files).release());  // owned by the importer
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCreaseAngleDeg);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
}

/// Removes meshes without faces, such as an empty solid of an STL file: assimp rejects the whole file otherwise.
void remove_empty_meshes(aiScene& scene, Warnings& warnings) {
  std::vector<unsigned> index_of(scene.mNumMeshes);
  unsigned kept = 0;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    aiMesh* mesh = scene.mMeshes[i];
    if (mesh->mNumFaces > 0 && mesh->mNumVertices > 0) {
      index_of[i] = kept;
      scene.mMeshes[kept++] = mesh;
    } else {
      index_of[i] = kRemoved;
      warnings.add(fmt::format("mesh '{}': it has no faces and is skipped", mesh->mName.C_Str()));
      delete mesh;
    }
  }
  scene.mNumMeshes = kept;
  std::vector<aiNode*> pending = {scene.mRootNode};
  while (!pending.empty()) {
    aiNode& node = *pending.back();
    pending.pop_back();
    unsigned used = 0;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const unsigned mesh = node.mMeshes[i] < index_of.size() ? index_of[node.mMeshes[i]] : kRemoved;
      if (mesh != kRemoved) node.mMeshes[used++] = mesh;
    }
    node.mNumMeshes = used;
    pending.insert(pending.end(), node.mChildren, node.mChildren + node.mNumChildren);
  }
}

/// Scene read by assimp; nullptr on failure.
const aiScene* read(Assimp::Importer& importer, const AssimpSource& source, Warnings& warnings) {
  const aiScene* scene = source.file.empty() ? importer.ReadFileFromMemory(source.bytes.data(), source.bytes.size(), 0,
                                                                           source.extension.c_str())
                                             : importer.ReadFile(source.file.string(), 0);
  if (!scene || !scene->mRootNode) return nullptr;
  remove_empty_meshes(const_cast<aiScene&>(*scene), warnings);  // owned by the importer, whose copy is mutable
  if (scene->mNumMeshes == 0) return scene;
  return importer.ApplyPostProcessing(post_processing(source.extension));
}

EmbeddedImage copy_embedded(const aiTexture& source) {
  EmbeddedImage image;
  image.width = static_cast<int>(source.mWidth);
  image.height = static_cast<int>(source.mHeight);
  const size_t count = size_t{source.mWidth} * source.mHeight;
  if (!source.pcData || count > kMaxEmbeddedTexels) return image;
  if (source.mHeight == 0) {
    image.width = 0;
    const auto* first = reinterpret_cast<const std::byte*>(source.pcData);
    image.bytes.assign(first, first + source.mWidth);
  }
  image.bytes.reserve(4 * count);
  for (size_t i = 0; i < count; ++i) {
    const aiTexel& texel = source.pcData[i];
    for (const unsigned char c : {texel.r, texel.g, texel.b, texel.a}) image.bytes.push_back(std::byte{c});
  }
  return image;
}

void import_embedded_images(const aiScene& source, ImportedScene& imported) {
  for (const TextureRequest& request : imported.textures) {
    for (const std::string& path : {request.first, request.second}) {
      const aiTexture* embedded = path.empty() ? nullptr : source.GetEmbeddedTexture(path.c_str());
      if (embedded && !imported.embedded.contains(path)) imported.embedded.emplace(path, copy_embedded(*embedded));
    }
  }
}

void convert(const aiScene& source, const std::string& place, Warnings& warnings, ImportedScene& imported) {
  Scene& scene = imported.scene;
  scene.name = std::filesystem::path(place).stem().string();
  if (source.mFlags & AI_SCENE_FLAGS_INCOMPLETE)
    warnings.add("the file is incomplete; only its readable part is loaded");
  import_assimp_materials(source, imported, warnings);
  import_embedded_images(source, imported);
  const std::vector<Index> mesh_of = import_assimp_meshes(source, scene, warnings);
  import_assimp_nodes(source, mesh_of, scene, warnings);
  scene.warnings = warnings.take();
  if (scene.meshes.empty()) imported.problem = fmt::format("{}: {}", place, kNoTriangles);
}

}  // namespace

ImportedScene import_with_assimp(const AssimpSource& source) {
  ImportedScene imported;
  try {
    Assimp::Importer importer;
    configure(importer, imported.files);
    Warnings warnings(source.place);
    if (const aiScene* scene = read(importer, source, warnings)) {
      convert(*scene, source.place, warnings, imported);
    } else {
      imported.problem = fmt::format("{}: {}", source.place, explain_assimp_problem(importer.GetErrorString()));
    }
  } catch (const std::exception& error) {
    imported.problem = fmt::format("{}: {}", source.place, explain_assimp_problem(error.what()));
  }
  return imported;
}

}  // namespace relume
