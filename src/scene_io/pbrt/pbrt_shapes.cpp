#include "scene_io/pbrt/pbrt_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "builtin_scenes/shapes.h"
#include "core/vec.h"
#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/image_search.h"
#include "scene_io/mesh_repair.h"
#include "scene_io/pbrt/gzip.h"
#include "scene_io/ply/ply_loader.h"
#include "scene_io/shapes/flat_shapes.h"
#include "scene_io/shapes/loop_subdivision.h"
#include "scene_io/shapes/quadrics.h"

namespace relume::pbrt {
namespace {

/// Triangles of all patches and subdivision surfaces of a scene beyond which they are not tessellated.
constexpr size_t kManyTriangles = size_t{1} << 23;

/// Segments of a quadric up to that many triangles of quadrics in a scene.
struct Fineness {
  size_t triangles;
  int segments;
};
constexpr std::array kFineness = {Fineness{size_t{1} << 22, kQuadricSegments}, Fineness{size_t{5} << 20, 32},
                                  Fineness{size_t{10} << 20, 12}};

/// Triangles of a mesh up to which pbrt's default coordinates are stored. Larger meshes without coordinates have no
/// textures in practice.
constexpr size_t kMaxDefaultUv = 64;

/// Indices of a list in groups; a group with one outside of [0, count) throws Error.
template <size_t N>
std::vector<std::array<uint32_t, N>> index_groups(const Parameters& parameters, size_t count) {
  const std::vector<double> numbers = parameters.numbers("indices");
  if (numbers.size() % N != 0)
    fail(parameters.where(), fmt::format("{} indices are no groups of {}; add the missing ones", numbers.size(), N));
  std::vector<std::array<uint32_t, N>> groups(numbers.size() / N);
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (!(numbers[i] >= 0 && numbers[i] < static_cast<double>(count)))
      fail(parameters.where(),
           fmt::format("index {} is out of range; the shape has {} vertices in 'P'", numbers[i], count));
    groups[i / N][i % N] = static_cast<uint32_t>(numbers[i]);
  }
  return groups;
}

std::vector<UVec3> triangle_indices(const Parameters& parameters, size_t count) {
  std::vector<UVec3> triangles;
  for (const auto& t : index_groups<3>(parameters, count)) triangles.emplace_back(t[0], t[1], t[2]);
  if (triangles.empty() && count == 3) triangles.emplace_back(0, 1, 2);
  return triangles;
}

/// Clears values that are not one per vertex, with a warning.
template <typename V>
void check_size(std::vector<V>& values, size_t count, const char* name, Warnings& warnings) {
  if (values.empty() || values.size() == count) return;
  warnings.add(fmt::format("'{}' of a shape does not have one value per vertex and is ignored", name));
  values.clear();
}

/// Makes triangles face as their normals, which determine the front of pbrt's meshes.
void face_normals(Mesh& mesh) {
  if (mesh.normals.size() != mesh.positions.size()) return;
  for (UVec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    const Vec3 face = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    if (glm::dot(face, mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]) < 0) std::swap(t.y, t.z);
  }
}

/// Gives each triangle vertices of its own with pbrt's default coordinates (0, 0), (1, 0) and (1, 1).
void set_default_uv(Mesh& mesh) {
  Mesh separate;
  for (UVec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      separate.positions.push_back(mesh.positions[t[k]]);
      if (!mesh.normals.empty()) separate.normals.push_back(mesh.normals[t[k]]);
      separate.uv0.emplace_back(k > 0 ? 1 : 0, k > 1 ? 0 : 1);  // v points down
      t[k] = static_cast<uint32_t>(separate.positions.size()) - 1;
    }
  }
  separate.triangles = std::move(mesh.triangles);
  mesh = std::move(separate);
}

size_t patch_count(const Parameters& parameters) {
  return std::max<size_t>(parameters.numbers("indices").size() / 4, 1);
}

float positive(const Parameters& parameters, std::string_view name, float otherwise) {
  const float value = parameters.number(name, otherwise);
  if (!(value > 0 && value <= 1e9f))
    fail(parameters.where(), fmt::format("'{}' is {}; give it a value above 0 and at most 1e9", name, value));
  return value;
}

float phi_max(const Parameters& parameters) { return glm::radians(parameters.number("phimax", 360)); }

float finite(float value, float otherwise) { return is_finite(value) ? value : otherwise; }

}  // namespace

int ShapeReader::segments() const {
  const auto level = std::find_if(kFineness.begin(), kFineness.end(),
                                  [&](const Fineness& fineness) { return quadric_triangles_ <= fineness.triangles; });
  return level == kFineness.end() ? 0 : level->segments;
}

Mesh ShapeReader::triangles(const Parameters& parameters) const {
  Mesh mesh;
  mesh.positions = parameters.vectors3("P");
  if (mesh.positions.empty()) fail(parameters.where(), "the shape has no vertices; give it 'point3 P'");
  const size_t count = mesh.positions.size();
  mesh.triangles = triangle_indices(parameters, count);
  mesh.normals = parameters.vectors3("N");
  mesh.uv0 = parameters.vectors2("uv");
  std::vector<Vec3> tangents = parameters.vectors3("S");
  check_size(mesh.normals, count, "N", warnings_);
  check_size(mesh.uv0, count, "uv", warnings_);
  check_size(tangents, count, "S", warnings_);
  for (Vec2& uv : mesh.uv0) uv.y = 1 - uv.y;
  if (mesh.uv0.empty() && tangents.empty() && mesh.triangles.size() <= kMaxDefaultUv) set_default_uv(mesh);
  for (const Vec3& s : tangents) mesh.tangents.emplace_back(s, 1.0f);
  return mesh;
}

Mesh ShapeReader::ply(const Parameters& parameters) {
  const std::string name = parameters.string("filename");
  if (name.empty()) fail(parameters.where(), "a plymesh has no file; give it 'string filename'");
  if (parameters.find("displacement", {"texture"}))
    warnings_.add("displacement is not supported; meshes keep their shape");
  parameters.number("edgelength", 1);
  const std::filesystem::path file = find_inside(base_dir_, name, text_of(parameters.where()));
  Warnings warnings(name);
  Mesh mesh =
      read_ply_mesh(gunzipped(read_reference(file, parameters.where()), file.string()), file.string(), warnings);
  mesh.name = file.stem().string();
  mesh.colors.clear();  // pbrt does not read them
  for (const std::string& warning : warnings.take()) warnings_.add(warning);
  return mesh;
}

Mesh ShapeReader::patches(const Parameters& parameters) {
  const std::vector<Vec3> positions = parameters.vectors3("P");
  if (positions.empty()) fail(parameters.where(), "the shape has no vertices; give it 'point3 P'");
  auto patches = index_groups<4>(parameters, positions.size());
  if (patches.empty() && positions.size() == 4) patches.push_back({0, 1, 2, 3});
  std::vector<Vec3> normals = parameters.vectors3("N");
  std::vector<Vec2> uv = parameters.vectors2("uv");
  check_size(normals, positions.size(), "N", warnings_);
  check_size(uv, positions.size(), "uv", warnings_);
  parameters.string("emissionfilename");  // guides only pbrt's sampling
  const bool is_much = made_ + patches.size() * 2 * kPatchCells * kPatchCells > kManyTriangles;
  Mesh mesh = bilinear_mesh({positions, normals, uv, patches}, is_much ? 1 : kPatchCells);
  return mesh;
}

Mesh ShapeReader::subdivision(const Parameters& parameters) const {
  const std::vector<Vec3> positions = parameters.vectors3("P");
  if (positions.empty()) fail(parameters.where(), "the shape has no vertices; give it 'point3 P'");
  const std::vector<UVec3> triangles = triangle_indices(parameters, positions.size());
  parameters.string("scheme");
  constexpr int kMostLevels = 8;
  const int levels = parameters.integer("levels", 3);
  const int used = made_ < kManyTriangles ? std::clamp(levels, 0, kMostLevels) : 0;
  const Mesh mesh = loop_subdivided(positions, triangles, used);
  if (static_cast<double>(mesh.triangles.size()) < static_cast<double>(triangles.size()) * std::pow(4.0, levels))
    warnings_.add(fmt::format("a subdivision surface keeps to {} triangles and has fewer than {} levels",
                              kMaxSubdivided, levels));
  return mesh;
}

Index ShapeReader::quadric(const std::string& kind, const Parameters& parameters, bool reversed, const Mat4* baked,
                           const std::string& look_key, float radius) {
  const bool is_sphere = kind == "sphere";
  const float extent = is_sphere ? radius : 1;
  const float low = finite(parameters.number("zmin", -extent), -extent) / radius;
  const float high = finite(parameters.number("zmax", extent), extent) / radius;
  const float z_min = std::min(low, high), z_max = std::max(low, high);
  const float height = finite(parameters.number("height", 0), 0) / radius;
  const float inner = finite(parameters.number("innerradius", 0), 0) / radius;
  const float phi = phi_max(parameters);
  const std::string key =
      fmt::format("{} {} {} {} {} {} {} {}", kind, z_min, z_max, phi, height, inner, reversed, look_key);
  if (const auto known = quadrics_.find(key); !baked && known != quadrics_.end()) return known->second;
  if (segments() == 0)
    fail(parameters.where(), fmt::format("the spheres, disks and cylinders have more than {} triangles; give them "
                                         "the same material, outside of objects, or use a mesh",
                                         kFineness.back().triangles));
  Mesh mesh = is_sphere        ? sphere_mesh({1, z_min, z_max, phi}, segments())
              : kind == "disk" ? disk_mesh({height, 1, inner, phi}, segments())
                               : cylinder_mesh({1, z_min, z_max, phi}, segments());
  quadric_triangles_ += mesh.triangles.size();
  mesh.name = fmt::format("{} {}", kind, scene_.meshes.size());
  const Index index = add(std::move(mesh), reversed, baked);
  if (!baked && index != kNone) quadrics_[key] = index;
  return index;
}

Index ShapeReader::add(Mesh mesh, bool reversed, const Mat4* baked) {
  repair_mesh(mesh, warnings_);
  if (mesh.triangles.empty()) return kNone;
  if (reversed) mesh = flipped(std::move(mesh));
  face_normals(mesh);
  if (baked) {
    mesh.tangents.clear();
    mesh = transformed(std::move(mesh), *baked);
    repair_mesh(mesh, warnings_);
  }
  scene_.meshes.push_back(std::move(mesh));
  return static_cast<Index>(scene_.meshes.size()) - 1;
}

ShapeEntity ShapeReader::read(const std::string& kind, const Parameters& parameters, bool reversed, const Mat4* baked,
                              const std::string& look_key) {
  ShapeEntity shape;
  if (kind == "sphere" || kind == "disk" || kind == "cylinder") {
    shape.scale = positive(parameters, "radius", 1);
    const Mat4 scaled = baked ? glm::scale(*baked, Vec3(shape.scale)) : Mat4(1);
    shape.mesh = quadric(kind, parameters, reversed, baked ? &scaled : nullptr, look_key, shape.scale);
    return shape;
  }
  Mesh mesh;
  if (kind == "trianglemesh") {
    mesh = triangles(parameters);
  } else if (kind == "plymesh") {
    mesh = ply(parameters);
  } else if (kind == "bilinearmesh") {
    mesh = patches(parameters);
  } else if (kind == "loopsubdiv") {
    mesh = subdivision(parameters);
  } else if (kind == "curve") {
    warnings_.add("curves are not supported; they are left out");
    return shape;
  } else {
    fail(parameters.where(), fmt::format("there is no shape '{}'; use sphere, disk, cylinder, trianglemesh, plymesh, "
                                         "bilinearmesh or loopsubdiv",
                                         kind));
  }
  const bool is_mesh = kind == "trianglemesh" || kind == "plymesh";
  if (!is_mesh) made_ += mesh.triangles.size();
  shape.faces = kind == "bilinearmesh" ? patch_count(parameters) : mesh.triangles.size();
  if (mesh.name.empty()) mesh.name = fmt::format("{} {}", kind, scene_.meshes.size());
  shape.mesh = add(std::move(mesh), reversed, baked);
  return shape;
}

}  // namespace relume::pbrt
