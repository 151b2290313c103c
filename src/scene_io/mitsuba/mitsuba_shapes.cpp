#include "scene_io/mitsuba/mitsuba_shapes.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "core/frame.h"
#include "files/bytes.h"
#include "files/read_record.h"
#include "relume/error.h"
#include "scene/placement.h"
#include "scene_io/mesh_repair.h"
#include "scene_io/mitsuba/mitsuba_meshes.h"
#include "scene_io/ply/ply_loader.h"
#include "scene_io/shapes/quadrics.h"

namespace relume::mitsuba {
namespace {

/// Vertices and triangles of all meshes together.
constexpr uint64_t kMaxElements = uint64_t{1} << 27;
/// The same for further copies of a mesh, which differ in their materials.
constexpr uint64_t kMaxCopied = uint64_t{1} << 25;
constexpr uint64_t kMaxShapes = uint64_t{1} << 20;  // outside groups
constexpr uint64_t kMaxInstances = uint64_t{1} << 22;

bool is_file_type(const std::string& type) { return type == "obj" || type == "ply" || type == "serialized"; }
bool is_quadric(const std::string& type) { return type == "sphere" || type == "disk" || type == "cylinder"; }

Surface diffuse_surface(const Rgb& color, const char* name) {
  Surface surface;
  surface.material.name = name;
  surface.material.metallic = 0;
  surface.material.specular = 0;
  surface.material.base_color = color;
  surface.has_black_back = true;
  return surface;
}

/// Rows of the file's matrix beyond an affine one are projective.
bool is_affine(const glm::dmat4& m) { return m[0].w == 0 && m[1].w == 0 && m[2].w == 0 && m[3].w == 1; }

/// Segments of quadrics; fewer if there are many.
int segments_for(const Document& document) {
  const auto count = std::count_if(document.objects.begin(), document.objects.end(), [](const Object& object) {
    return object.tag == "shape" && is_quadric(object.type);
  });
  if (count > 32000) return kQuadricSegments / 8;
  return count > 8000 ? kQuadricSegments / 4 : count > 2000 ? kQuadricSegments / 2 : kQuadricSegments;
}

}  // namespace

Shapes::Shapes(Import& import, Textures& textures)
    : import_(import),
      surfaces_(import, textures),
      materials_(import, textures),
      grey_(diffuse_surface(Rgb(0.5f), "diffuse")),
      black_(diffuse_surface(Rgb(0), "lamp")),
      segments_(segments_for(import.document)) {}

std::optional<Mesh> Shapes::load(const Parameters& p, const std::filesystem::path& file) {
  const std::string& type = p.object().type;
  const std::string place = file.string();
  if (const std::string reason = missing_reason(file); !reason.empty()) {
    record_read(file);
    import_.warnings.add(fmt::format("{}: the file {}; its shape is left out", place, reason));
    return std::nullopt;
  }
  if (type == "serialized") return load_serialized(p, place);
  const Bytes bytes = read_file_bytes(file);
  if (type == "obj") return read_obj(bytes, p.boolean("flip_tex_coords", true), place);
  Warnings warnings(place);
  Mesh mesh = read_ply_mesh(bytes, place, warnings);
  for (const std::string& warning : warnings.take()) import_.warnings.add(warning);
  // relume's reader turns v round; Mitsuba does not.
  if (!p.boolean("flip_tex_coords", false)) {
    for (Vec2& uv : mesh.uv0) uv.y = 1 - uv.y;
  }
  return mesh;
}

Mesh Shapes::load_serialized(const Parameters& p, const std::string& place) {
  if (place != serialized_place_) {
    serialized_ = read_file_bytes(place);
    serialized_place_ = place;
  }
  const auto inflatable = inflatable_.try_emplace(place, largest_inflated(serialized_.size())).first;
  return read_serialized(serialized_, p.integer("shape_index", 0), place, inflatable->second);
}

const Mesh* Shapes::geometry(const Parameters& p, std::string* key) {
  const std::string& type = p.object().type;
  const bool has_face_normals = p.boolean("face_normals", false);
  // Mirrored spheres face inwards in Mitsuba, unlike other shapes.
  const bool is_mirrored = type == "sphere" && glm::determinant(glm::dmat3(to_world_of(p))) < 0;
  const bool is_flipped = p.boolean("flip_normals", false) != is_mirrored;
  std::filesystem::path file;
  if (is_file_type(type)) {
    const std::string reference = p.text("filename", "");
    const std::optional<std::filesystem::path> found = import_.files.find(reference);
    if (!found) p.fail(fmt::format("its filename '{}' names no file; correct it", reference.substr(0, 80)));
    file = *found;
  }
  const bool flips_v = type != "serialized" && p.boolean("flip_tex_coords", type == "obj");
  const int64_t index = type == "serialized" ? p.integer("shape_index", 0) : 0;
  *key = fmt::format("{}|{}|{}|{}|{}|{}", type, file.string(), index, flips_v, has_face_normals, is_flipped);
  const auto [known, is_new] = geometries_.try_emplace(*key);
  std::optional<Mesh>& mesh = known->second;
  if (is_new) {
    mesh = file.empty() ? unit_shape(type, segments_) : load(p, file);
    if (mesh) {
      mesh->name = file.empty() ? type : file.stem().string();
      repair_mesh(*mesh, import_.warnings);
      if (has_face_normals) mesh->normals.clear();
      if (mesh->normals.empty() && !has_face_normals) add_smooth_normals(*mesh);
      if (is_flipped) flip(*mesh);
      count_elements(*mesh, elements_, kMaxElements);
    }
  }
  return mesh && !mesh->triangles.empty() ? &*mesh : nullptr;
}

void Shapes::count_elements(const Mesh& mesh, uint64_t& count, uint64_t limit) const {
  count += mesh.positions.size() + mesh.triangles.size();
  if (count > limit)
    throw Error(fmt::format("{}: the meshes{} have more than {} vertices and triangles; use instances",
                            import_.document.files[0], &count == &copied_ ? " of further materials" : "", limit));
}

glm::dmat4 Shapes::own_transform(const Parameters& p) {
  const std::string& type = p.object().type;
  if (type == "sphere") {
    const glm::dmat4 moved = glm::translate(glm::dmat4(1), p.vector("center").value_or(glm::dvec3(0)));
    return glm::scale(moved, glm::dvec3(p.number("radius", 1)));
  }
  if (type != "cylinder") return glm::dmat4(1);
  const glm::dvec3 p0 = p.vector("p0").value_or(glm::dvec3(0));
  const glm::dvec3 axis = p.vector("p1").value_or(glm::dvec3(0, 0, 1)) - p0;
  const double length = glm::length(axis);
  if (!(length > 0)) p.fail("its ends p0 and p1 are equal");
  const Frame frame = make_frame(Vec3(axis / length));
  const glm::dmat4 turned(glm::dvec4(frame.t, 0), glm::dvec4(frame.b, 0), glm::dvec4(axis / length, 0),
                          glm::dvec4(p0, 1));
  const double radius = p.number("radius", 1);
  return glm::scale(turned, glm::dvec3(radius, radius, length));
}

glm::dmat4 Shapes::to_world_of(const Parameters& p) {
  return p.transform("to_world").value_or(glm::dmat4(1)) * own_transform(p);
}

Index Shapes::mesh_of(const Parameters& p, const Mesh& geometry, const std::string& key, const glm::dmat4& to_world) {
  const std::vector<const Object*> bsdfs = p.children({"bsdf"});
  const std::vector<const Object*> emitters = p.children({"emitter"});
  const Surface& surface = !bsdfs.empty() ? surfaces_.of(*bsdfs[0]) : emitters.empty() ? grey_ : black_;
  Emission emission;
  for (const Object* emitter : emitters) {
    if (emitter->type == "area") {
      emission = materials_.emission(*emitter);
    } else {
      import_.warnings.add(fmt::format("{} of a shape is not supported and is ignored", name_of(*emitter)));
    }
  }
  if (surface.is_null && emission.is_black()) return kNone;
  const bool is_closed = p.object().type == "sphere" || p.object().type == "cube";
  if (surface.has_black_back && !surface.is_two_sided && !is_closed && &surface != &black_)
    import_.warnings.add("opaque BSDFs outside 'twosided' reflect on both sides; in Mitsuba their backs are black");
  const Vec2 scale = surface.has_bumps ? stretch(geometry, Mat4(to_world)) : Vec2(1);
  const Index material = materials_.find(surface, emission, emission.is_black() ? nullptr : emitters[0], scale);
  const auto [known, is_new] = meshes_.try_emplace({key, material}, static_cast<Index>(import_.scene.meshes.size()));
  if (!is_new) return known->second;
  if (!used_.insert(key).second) count_elements(geometry, copied_, kMaxCopied);
  Mesh mesh = geometry;
  mesh.material = material;
  if (!surface.uses_vertex_colors) mesh.colors.clear();
  if (surface.is_inverted && emission.is_black()) flip(mesh);
  if (surface.needs_tangents()) add_tangents(mesh);
  import_.scene.meshes.push_back(std::move(mesh));
  return known->second;
}

std::optional<Shapes::Placed> Shapes::place(const Object& shape) {
  const Parameters p(import_, shape);
  const bool is_known =
      is_file_type(shape.type) || is_quadric(shape.type) || shape.type == "rectangle" || shape.type == "cube";
  if (!is_known) {
    import_.warnings.add(fmt::format("{} is not supported and is left out", name_of(shape)));
    return std::nullopt;
  }
  p.ignore({"silhouette_sampling_weight"});
  if (!p.children({"medium"}).empty()) import_.warnings.add("media are not supported; light passes them unchanged");
  std::string key;
  const Mesh* mesh = geometry(p, &key);
  Placed placed;
  placed.to_world = to_world_of(p);
  if (!is_affine(placed.to_world) || !within_reach(Mat4(placed.to_world))) {
    import_.warnings.add(fmt::format("{}: its to_world is not affine or reaches beyond {:g} m; the shape is left out",
                                     name_of(shape), kMaxCoordinate));
    return std::nullopt;
  }
  if (!mesh) {
    shape.read = false;  // no warnings about the parameters of a missing shape
    return std::nullopt;
  }
  placed.mesh = mesh_of(p, *mesh, key, placed.to_world);
  return placed.mesh == kNone ? std::nullopt : std::optional(placed);
}

void Shapes::add_instance(const Object& instance) {
  const Parameters p(import_, instance);
  const std::vector<const Object*> groups = p.children({"shape"});
  if (groups.size() != 1 || groups[0]->type != "shapegroup") p.fail("it needs one reference to a shapegroup");
  const glm::dmat4 to_world = p.transform("to_world").value_or(glm::dmat4(1));
  if (!is_affine(to_world) || !within_reach(Mat4(to_world))) {
    import_.warnings.add(fmt::format("{}: its to_world is not affine or reaches beyond {:g} m; it is left out",
                                     name_of(instance), kMaxCoordinate));
    return;
  }
  instances_[groups[0]].push_back(Mat4(to_world));
  placed_ += std::max<size_t>(groups[0]->children.size(), 1);
  if (placed_ > kMaxInstances) p.fail(fmt::format("the scene has more than {} instances; remove some", kMaxInstances));
}

void Shapes::add(const Object& shape, Index parent) {
  shapes_ += 1 + (shape.type == "merge" ? shape.children.size() : 0);
  if (shapes_ > kMaxShapes)
    throw Error(fmt::format("{}: the scene has more than {} shapes; use instances", import_.document.place_of(shape),
                            kMaxShapes));
  if (shape.type == "shapegroup") return;  // its instances show it
  if (shape.type == "instance") {
    add_instance(shape);
    return;
  }
  if (shape.type == "merge") {
    const Parameters p(import_, shape);
    for (const Object* part : p.children({"shape"})) add(*part, parent);
    return;
  }
  const std::optional<Placed> placed = place(shape);
  if (!placed) return;
  Node node;
  node.name = shape.id;
  node.parent = parent;
  node.matrix = Mat4(placed->to_world);
  node.meshes = {placed->mesh};
  import_.scene.add_node(std::move(node));
}

void Shapes::finish(Index parent) {
  for (const Object& group : import_.document.objects) {
    const auto found = instances_.find(&group);
    if (found == instances_.end()) continue;
    const Parameters p(import_, group);
    for (const Object* shape : p.children({"shape"})) {
      const std::optional<Placed> placed = place(*shape);
      if (!placed) continue;
      Node node;
      node.name = shape->id.empty() ? group.id : shape->id;
      node.parent = parent;
      node.meshes = {placed->mesh};
      for (const Mat4& instance : found->second) node.instances.push_back(instance * Mat4(placed->to_world));
      import_.scene.add_node(std::move(node));
    }
  }
}

}  // namespace relume::mitsuba
