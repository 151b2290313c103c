#include "scene_io/assimp/assimp_nodes.h"

#include <algorithm>
#include <map>

#include <assimp/camera.h>
#include <assimp/light.h>
#include <assimp/mesh.h>
#include <assimp/metadata.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "scene_io/look_rotation.h"
#include "scene_io/mesh_repair.h"

namespace relume {
namespace {

Vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Converts assimp's row-major matrix.
Mat4 to_matrix(const aiMatrix4x4& m) {
  return {Vec4(m.a1, m.b1, m.c1, 0), Vec4(m.a2, m.b2, m.c2, 0), Vec4(m.a3, m.b3, m.c3, 0), Vec4(m.a4, m.b4, m.c4, 1)};
}

bool is_finite_matrix(const Mat4& m) {
  return is_finite(Vec3(m[0])) && is_finite(Vec3(m[1])) && is_finite(Vec3(m[2])) && is_finite(Vec3(m[3]));
}

std::vector<Vec2> read_uv(const aiMesh& source, unsigned set) {
  std::vector<Vec2> uv;
  if (!source.HasTextureCoords(set)) return uv;
  uv.reserve(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i)
    uv.emplace_back(source.mTextureCoords[set][i].x, source.mTextureCoords[set][i].y);
  return uv;
}

Mesh convert_mesh(const aiMesh& source, const aiScene& scene) {
  Mesh mesh;
  mesh.name = source.mName.C_Str();
  mesh.positions.reserve(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i) mesh.positions.push_back(to_vec3(source.mVertices[i]));
  if (source.HasNormals()) {
    mesh.normals.reserve(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) mesh.normals.push_back(to_vec3(source.mNormals[i]));
  }
  mesh.uv0 = read_uv(source, 0);
  mesh.uv1 = read_uv(source, 1);
  if (source.HasVertexColors(0)) {
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiColor4D& c = source.mColors[0][i];
      mesh.colors.emplace_back(c.r, c.g, c.b, c.a);
    }
  }
  mesh.triangles.reserve(source.mNumFaces);
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices == 3) mesh.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
  }
  if (source.mMaterialIndex < scene.mNumMaterials) mesh.material = static_cast<Index>(source.mMaterialIndex);
  return mesh;
}

/// Rotation to Y up from the file's axes for right, up and towards the viewer. assimp 5.2 only reports these axes.
/// assimp 5.4 rotates the root node instead, which no file can rotate.
Mat4 to_y_up(const aiScene& source) {
  const aiMatrix4x4& root = source.mRootNode->mTransformation;
  if (root.b3 != 0.0f || root.c2 != 0.0f || root.a2 != 0.0f) return Mat4(1);
  int32_t axes[3] = {0, 1, 2};
  int32_t signs[3] = {1, 1, 1};
  constexpr const char* kNames[3] = {"CoordAxis", "UpAxis", "FrontAxis"};
  if (!source.mMetaData) return Mat4(1);
  Mat3 rows(0);
  for (int i = 0; i < 3; ++i) {
    source.mMetaData->Get(kNames[i], axes[i]);
    source.mMetaData->Get(std::string(kNames[i]) + "Sign", signs[i]);
    if (axes[i] < 0 || axes[i] > 2) return Mat4(1);
    rows[i][axes[i]] = signs[i] < 0 ? -1.0f : 1.0f;
  }
  // Other matrices than rotations are errors of the file.
  return glm::determinant(rows) > 0.5f ? Mat4(glm::transpose(rows)) : Mat4(1);
}

/// assimp links lights and cameras to nodes by name.
using NodesByName = std::map<std::string, Index>;

Node child_node(const NodesByName& nodes, const aiString& name, const Vec3& position, const Vec3& direction,
                const Vec3& up) {
  Node node;
  node.name = name.C_Str();
  const auto parent = nodes.find(node.name);
  if (parent != nodes.end()) node.parent = parent->second;
  if (is_finite(position)) node.transform.translation = position;
  node.transform.rotation = look_rotation(direction, up);
  return node;
}

void import_lights(const aiScene& source, const NodesByName& nodes, Scene& scene, Warnings& warnings) {
  for (unsigned i = 0; i < source.mNumLights; ++i) {
    const aiLight& in = *source.mLights[i];
    PunctualLight light;
    light.name = in.mName.C_Str();
    switch (in.mType) {
      case aiLightSource_POINT: light.type = PunctualType::point; break;
      case aiLightSource_SPOT: light.type = PunctualType::spot; break;
      case aiLightSource_DIRECTIONAL: light.type = PunctualType::directional; break;
      default:
        warnings.add(fmt::format("light '{}': only point, spot and directional lights are supported; it is ignored",
                                 light.name));
        continue;
    }
    // The intensity falls off as 1 / (c0 + c1 d + c2 d²); only the quadratic term is physical.
    const bool has_falloff = light.type != PunctualType::directional && in.mAttenuationQuadratic > 0;
    const float scale = has_falloff ? 1.0f / in.mAttenuationQuadratic : 1.0f;
    const Rgb intensity = Rgb(in.mColorDiffuse.r, in.mColorDiffuse.g, in.mColorDiffuse.b) * scale;
    light.intensity = is_finite(intensity) ? glm::clamp(intensity, Rgb(0), Rgb(kMaxRadiance)) : Rgb(0);
    if (light.intensity != intensity)
      warnings.add(fmt::format(
          "light '{}': its intensity is negative, above {:g} or not finite; it is clamped, or 0 if not finite",
          light.name, kMaxRadiance));
    if (light.type == PunctualType::spot) {
      light.outer_cone_rad = clamp(in.mAngleOuterCone / 2, 1e-3f, kPi / 2);  // assimp stores full angles
      light.inner_cone_rad = clamp(in.mAngleInnerCone / 2, 0, light.outer_cone_rad);
    }
    Node node = child_node(nodes, in.mName, to_vec3(in.mPosition), to_vec3(in.mDirection), Vec3(0, 1, 0));
    node.light = static_cast<Index>(scene.lights.size());
    scene.lights.push_back(std::move(light));
    scene.add_node(std::move(node));
  }
}

void import_cameras(const aiScene& source, const NodesByName& nodes, Scene& scene) {
  constexpr float kDefaultAspect = 16.0f / 9.0f;
  for (unsigned i = 0; i < source.mNumCameras; ++i) {
    const aiCamera& in = *source.mCameras[i];
    Camera camera;
    camera.name = in.mName.C_Str();
    if (in.mAspect > 0.01f && in.mAspect < 100) camera.aspect_ratio = in.mAspect;
    const float aspect = camera.aspect_ratio > 0 ? camera.aspect_ratio : kDefaultAspect;
    if (in.mOrthographicWidth > 0 && is_finite(in.mOrthographicWidth)) {
      camera.projection = Projection::orthographic;
      camera.half_height = in.mOrthographicWidth / aspect;
    } else if (in.mHorizontalFOV > 0 && in.mHorizontalFOV < kPi) {
      camera.fov_y_rad = 2 * std::atan(std::tan(in.mHorizontalFOV / 2) / aspect);
    }
    Node node = child_node(nodes, in.mName, to_vec3(in.mPosition), to_vec3(in.mLookAt), to_vec3(in.mUp));
    node.camera = static_cast<Index>(scene.cameras.size());
    scene.cameras.push_back(std::move(camera));
    scene.add_node(std::move(node));
  }
}

}  // namespace

std::vector<Index> import_assimp_meshes(const aiScene& source, Scene& scene, Warnings& warnings) {
  std::vector<Index> mesh_of(source.mNumMeshes, kNone);
  for (unsigned i = 0; i < source.mNumMeshes; ++i) {
    const aiMesh& in = *source.mMeshes[i];
    if (!(in.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) || !in.HasPositions()) {
      warnings.add(fmt::format("mesh '{}': points and lines are skipped", in.mName.C_Str()));
      continue;
    }
    if (in.HasBones()) warnings.add("skins are not supported; meshes keep their rest pose");
    if (in.mNumAnimMeshes > 0) warnings.add("morph targets are not supported; meshes keep their rest shape");
    Mesh mesh = convert_mesh(in, source);
    repair_mesh(mesh, warnings);
    if (mesh.triangles.empty()) continue;
    mesh_of[i] = static_cast<Index>(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
  }
  return mesh_of;
}

void import_assimp_nodes(const aiScene& source, const std::vector<Index>& mesh_of, Scene& scene, Warnings& warnings) {
  struct Pending {
    const aiNode* node;
    Index parent;
  };
  NodesByName nodes;
  std::vector<Pending> pending;
  if (source.mRootNode) pending.push_back({source.mRootNode, kNone});
  for (size_t k = 0; k < pending.size(); ++k) {
    const aiNode& in = *pending[k].node;
    Node node;
    node.name = in.mName.C_Str();
    node.parent = pending[k].parent;
    node.matrix = to_matrix(in.mTransformation);
    if (k == 0) node.matrix = to_y_up(source) * *node.matrix;
    if (!is_finite_matrix(*node.matrix)) {
      warnings.add(fmt::format("node '{}': its matrix is not finite and is ignored", node.name));
      node.matrix.reset();
    }
    for (unsigned i = 0; i < in.mNumMeshes; ++i) {
      if (in.mMeshes[i] < mesh_of.size() && mesh_of[in.mMeshes[i]] != kNone)
        node.meshes.push_back(mesh_of[in.mMeshes[i]]);
    }
    const Index index = scene.add_node(std::move(node));
    nodes.emplace(in.mName.C_Str(), index);
    for (unsigned i = 0; i < in.mNumChildren; ++i) pending.push_back({in.mChildren[i], index});
  }
  import_lights(source, nodes, scene, warnings);
  import_cameras(source, nodes, scene);
  if (source.mNumAnimations > 0) warnings.add("animation is loaded from glTF files only and is ignored here");
}

}  // namespace relume
