#include "scene/compiled_scene.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <glm/gtc/matrix_inverse.hpp>

#include "core/parallel.h"
#include "relume/error.h"
#include "scene/framing.h"
#include "scene/light_parameters.h"
#include "scene/material_parameters.h"
#include "scene/placement.h"
#include "scene/studio.h"
#include "scene/surface_point.h"
#include "scene/view_lighting.h"

namespace relume {
namespace {

/// Repeated meshes are instanced if copies would add more triangles than this. Below, copies trace faster.
constexpr size_t kFlattenedTriangleBudget = 1'000'000;

/// Emissive surfaces light a view if they contribute at least this share of the studio's irradiance. Built-in scenes
/// reach 8 % and more; models with only glowing parts reach 0.04 % or less.
constexpr float kEmissionShare = 0.02f;

std::vector<uint32_t> triangle_counts(const Scene& scene) {
  std::vector<uint32_t> counts;
  for (const Mesh& m : scene.meshes) counts.push_back(static_cast<uint32_t>(m.triangles.size()));
  return counts;
}

}  // namespace

CompiledScene::CompiledScene(Scene scene, const CompileOptions& options, Memory& memory, SceneLauncher& launcher)
    : launcher_(launcher),
      source_(std::move(scene)),
      deforming_(memory),
      deforming_vertices_(memory),
      previous_positions_(memory),
      instance_keys_(memory),
      vertex_keys_(memory),
      camera_keys_(memory),
      accel_choice_(options.accel),
      vertices_(memory),
      triangles_(memory),
      uv1_(memory),
      colors_(memory),
      meshes_(memory),
      instances_(memory),
      materials_(memory),
      layers_(memory),
      energy_tables_(memory),
      textures_(memory),
      lights_(memory),
      resolution_(options.width, options.height) {
  validate(source_, error_place(source_));
  note_clips(options.animation);
  select_animation(source_, options.animation);
  apply_parameter_animation();
  world_ = world_matrices(source_, time_s_);  // at time 0: the environment does not depend on the start time
  visible_ = visible_nodes(source_, time_s_);
  check_placement(source_, world_, error_place(source_));
  textures_ = TextureStore(source_.textures, options.texture_filter, memory);
  for (Texture& t : source_.textures) {
    t.texels = {};
    t.file = nullptr;
  }
  list_mesh_instances();
  moves_ = moving_nodes(source_, options.movable);
  bake_static_deformations();
  decide_instancing();
  build_materials();
  build_meshes();
  place_instances();
  compute_bounds();
  collect_lights();
  note_collapsed_lights();
  choose_camera(options.camera);
  camera_view_ = view_through(camera());
  build_accel();
  refresh_view();
  studio_rotation_rad_ = relume::studio_rotation_rad(-camera_view_.axes.n);
  use_environment();
  note_lighting();
  if (options.time_s != 0) set_time(options.time_s);
  set_shutter(options.shutter);
  was_moved_ = true;
  end_frame();
}

void CompiledScene::open_for_host() const {
  vertices_.permit_reading();
  triangles_.permit_reading();
  uv1_.permit_reading();
  colors_.permit_reading();
  previous_positions_.permit_reading();
  instance_keys_.permit_reading();
  vertex_keys_.permit_reading();
  camera_keys_.permit_reading();
  meshes_.permit_reading();
  instances_.permit_reading();
  materials_.permit_reading();
  layers_.permit_reading();
  energy_tables_.open_for_host();
  textures_.open_for_host();
  lights_.open_for_host();
  if (accel_) accel_->open_for_host();
}

void CompiledScene::note_clips(const std::string& choice) {
  constexpr size_t kMostNames = 8;
  const size_t count = source_.clips.size();
  if (!choice.empty() || count < 2) return;
  std::string others;
  for (size_t i = 1; i < std::min(count, kMostNames + 1); ++i) others += (i > 1 ? ", '" : "'") + source_.clips[i] + "'";
  if (count > kMostNames + 1) others += fmt::format(" and {} more", count - kMostNames - 1);
  notes_.push_back(
      fmt::format("using the animation '{}'; --animation selects another ({}), or all", source_.clips.front(), others));
}

void CompiledScene::list_mesh_instances() {
  for (uint32_t n = 0; n < source_.nodes.size(); ++n) {
    for_each_place(source_.nodes[n], [&](Index mesh, const Mat4& to_node) {
      MeshInstance& placed = mesh_instances_.emplace_back();
      placed.node = n;
      placed.mesh = static_cast<uint32_t>(mesh);
      placed.local = to_node;
    });
  }
}

void CompiledScene::decide_instancing() {
  const std::vector<uint32_t> triangles = triangle_counts(source_);
  std::vector<size_t> uses(source_.meshes.size(), 0);
  for (const MeshInstance& a : mesh_instances_) ++uses[a.mesh];
  size_t copied = 0;
  for (size_t m = 0; m < uses.size(); ++m) {
    if (uses[m] > 1) copied += uses[m] * triangles[m];
  }
  const bool copy_repeated = copied <= kFlattenedTriangleBudget;
  for (const MeshInstance& a : mesh_instances_)
    world_space_.push_back(a.skinned || (!a.deforms && !moves_[a.node] && (uses[a.mesh] == 1 || copy_repeated)));
}

void CompiledScene::build_materials() {
  std::vector<MaterialData> materials;
  std::vector<LayerData> layers;
  for (const Material& m : source_.materials) {
    MaterialData& data = materials.emplace_back(material_data(m));
    const std::optional<LayerData> own_layers = layer_data(m);
    if (!own_layers) continue;
    data.layers = static_cast<int32_t>(layers.size());
    layers.push_back(*own_layers);
  }
  for (MaterialData& data : materials) {
    if (!data.is_mixture()) continue;
    data.uses_uv = true;           // its parts may
    data.cull_back_faces = false;  // its parts may have a volume
  }
  materials.push_back(material_data(Material{}));  // glTF's default, for meshes without a material
  // Both change together, or none.
  materials_.reserve(materials.size());
  layers_.reserve(layers.size());
  materials_.assign(materials);
  layers_.assign(layers);
}

void CompiledScene::append_mesh(uint32_t mesh_index, const Mat4* transform) {
  const Mesh& mesh = source_.meshes[mesh_index];
  const uint32_t first_vertex = static_cast<uint32_t>(vertices_.size());
  const Affine m = transform ? Affine{Mat3(*transform), Vec3((*transform)[3])} : Affine{};
  const Mat3 normal_to_world = normal_matrix(m.linear);
  const bool mirrored = glm::dot(m.linear[0], normal_to_world[0]) < 0.0f;
  const float orientation = mirrored ? -1.0f : 1.0f;

  MeshView view;
  view.first_triangle = static_cast<uint32_t>(triangles_.size());
  view.triangle_count = static_cast<uint32_t>(mesh.triangles.size());
  view.material =
      mesh.material == kNone ? static_cast<uint32_t>(materials_.size()) - 1 : static_cast<uint32_t>(mesh.material);
  view.has_normals = !mesh.normals.empty();
  view.has_uv = !mesh.uv0.empty();
  view.has_tangents = !mesh.tangents.empty();
  view.has_uv1 = !mesh.uv1.empty();
  view.has_colors = !mesh.colors.empty();
  view.first_uv1 = static_cast<uint32_t>(uv1_.size()) - first_vertex;
  view.first_color = static_cast<uint32_t>(colors_.size()) - first_vertex;
  meshes_.push_back(view);

  const size_t count = mesh.positions.size();
  vertices_.resize(first_vertex + count, kUninitialized);
  const std::span<Vertex> vertices = vertices_.write().subspan(first_vertex);
  parallel_for(count, [&](size_t i) {
    Vertex& v = vertices[i];
    v.position = m.point(mesh.positions[i]);
    const auto unit = [](const Vec3& d) { return length_squared(d) > 0.0f ? glm::normalize(d) : Vec3(0, 0, 1); };
    const Vec3 normal = view.has_normals ? unit(normal_to_world * mesh.normals[i] * orientation) : Vec3(0, 0, 1);
    const float handedness = view.has_tangents ? std::copysign(1.0f, mesh.tangents[i].w) * orientation : 1.0f;
    v.normal = pack_normal(normal, handedness);
    v.uv = view.has_uv ? mesh.uv0[i] : Vec2(0);
    v.tangent = view.has_tangents ? pack_direction(unit(m.vector(Vec3(mesh.tangents[i])))) : 0;
  });
  triangles_.resize(view.first_triangle + mesh.triangles.size(), kUninitialized);
  UVec3* triangle = triangles_.write().data() + view.first_triangle;
  for (const UVec3& t : mesh.triangles) {
    const UVec3 moved = t + UVec3(first_vertex);
    *triangle++ = mirrored ? UVec3(moved.x, moved.z, moved.y) : moved;
  }
  uv1_.append(mesh.uv1);
  colors_.append(mesh.colors);
}

void CompiledScene::build_meshes() {
  shared_meshes_.assign(source_.meshes.size(), kNoHit);
  for (size_t i = 0; i < mesh_instances_.size(); ++i) {
    MeshInstance& a = mesh_instances_[i];
    if (a.deforms) {
      append_deforming_mesh(a);
      continue;
    }
    if (world_space_[i]) {
      const Mat4 transform = a.skinned ? Mat4(1) : world_[a.node] * a.local;
      mesh_of_instance_.push_back(static_cast<uint32_t>(meshes_.size()));
      append_mesh(a.mesh, &transform);
      continue;
    }
    if (shared_meshes_[a.mesh] == kNoHit) {
      shared_meshes_[a.mesh] = static_cast<uint32_t>(meshes_.size());
      append_mesh(a.mesh, nullptr);
    }
    mesh_of_instance_.push_back(shared_meshes_[a.mesh]);
  }
  deform_meshes();
  for (Mesh& m : source_.meshes) {  // the compiled copy replaces the arrays
    m = Mesh{.name = std::move(m.name),
             .positions = {},
             .normals = {},
             .tangents = {},
             .uv0 = {},
             .uv1 = {},
             .colors = {},
             .triangles = {},
             .material = m.material,
             .morph_targets = {},
             .influences_per_vertex = 0,
             .influences = {}};
  }
  // Embree reads 16 bytes at the last vertex. Colours and second coordinates are addressed like vertices.
  vertices_.shrink_to_fit();
  triangles_.shrink_to_fit();
}

void CompiledScene::note_collapsed_lights() {
  for (size_t i = 0; i < source_.nodes.size(); ++i) {
    const Index light = source_.nodes[i].light;
    if (light == kNone || direction_of(Vec3(world_[i][2])) != Vec3(0)) continue;
    const PunctualLight& source = source_.lights[static_cast<size_t>(light)];
    if (type_of(source).has_direction)
      notes_.push_back(
          fmt::format("light '{}' is dark, because a scale of 0 leaves it without direction; change the scale of its "
                      "node or its ancestors",
                      source.name));
  }
}

bool CompiledScene::shines(bool emissive_surfaces) const {
  const LightsView lights = lights_.view();
  for (LightId id = 0; id < lights.lights.size; ++id) {
    const LightKind kind = lights.lights[id].kind;
    if (kind == LightKind::environment || (kind == LightKind::triangle && !emissive_surfaces)) continue;
    if (!is_black(power(lights, id))) return true;
  }
  // Moving instances may emit at another time.
  const std::vector<bool> ever_visible = ever_visible_nodes(source_);
  for (size_t i = 0; i < source_.nodes.size(); ++i) {
    const Index light = source_.nodes[i].light;
    if (light != kNone && moves_[i] && ever_visible[i] &&
        !is_black(source_.lights[static_cast<size_t>(light)].intensity))
      return true;
  }
  return false;
}

void CompiledScene::note_lighting() {
  if (in_studio_ && source_.environment.kind == EnvironmentKind::automatic) {
    notes_.push_back(fmt::format(
        "{}: using the studio environment; --env FILE, sky or R,G,B selects another, --env none removes it",
        !shines(true) ? "the scene has no light" : "emissive surfaces hardly light the surfaces that the camera sees"));
  }
  if (source_.environment.kind == EnvironmentKind::none && !shines(true) && !all_unlit())
    notes_.emplace_back("the scene has no light: the image is black; give it an environment, such as --env studio");
}

bool CompiledScene::all_unlit() const {
  const std::span<const Instance> instances = instances_.read();
  const std::span<const MeshView> meshes = meshes_.read();
  const std::span<const MaterialData> materials = materials_.read();
  return !instances.empty() && std::all_of(instances.begin(), instances.end(), [&](const Instance& i) {
    return !i.visible || materials[meshes[i.mesh].material].unlit;
  });
}

void CompiledScene::use_environment() {
  const EnvironmentKind kind = source_.environment.kind;
  in_studio_ = kind == EnvironmentKind::studio;
  if (kind == EnvironmentKind::automatic) {
    if (!automatic_is_studio_) automatic_is_studio_ = needs_studio();
    in_studio_ = *automatic_is_studio_;
  }
  if (in_studio_) {
    use_studio();
  } else {
    lights_.set_environment(source_.environment);
  }
  collect_lights();
}

void CompiledScene::use_studio() {
  Environment studio = source_.environment;
  studio.kind = EnvironmentKind::studio;
  studio.rotation_rad += studio_rotation_rad_;
  lights_.set_environment(studio);
}

bool CompiledScene::needs_studio() {
  lights_.set_environment({});  // the previous environment must not affect the scene's own lights
  collect_lights();
  if (shines(false) || all_unlit()) return false;
  if (!shines(true)) return true;
  use_studio();
  collect_lights();
  return !estimate_view_lighting(view_).finite_lights_give(kEmissionShare);
}

Index find_camera(const Scene& scene, const std::string& name) {
  std::vector<Index> nodes;
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].camera != kNone) nodes.push_back(static_cast<Index>(i));
  }
  std::stable_sort(nodes.begin(), nodes.end(), [&](Index a, Index b) {
    return scene.nodes[static_cast<size_t>(a)].camera < scene.nodes[static_cast<size_t>(b)].camera;
  });
  if (name.empty()) return nodes.empty() ? kNone : nodes.front();
  if (nodes.empty()) {
    throw Error(
        ErrorCode::not_found,
        fmt::format(
            "{}: there is no camera '{}', because the scene has no cameras; remove --camera to use a default view",
            error_place(scene), name));
  }
  size_t index = 0;
  const auto parsed = std::from_chars(name.data(), name.data() + name.size(), index);
  const bool is_number = parsed.ec == std::errc{} && parsed.ptr == name.data() + name.size();
  std::string known;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = scene.nodes[static_cast<size_t>(nodes[i])];
    const std::string& camera_name = scene.cameras[static_cast<size_t>(node.camera)].name;
    if (node.name == name || camera_name == name || (is_number && i == index)) return nodes[i];
    known += (i ? ", '" : "'") + (node.name.empty() ? camera_name : node.name) + "'";
  }
  throw Error(ErrorCode::not_found,
              fmt::format("{}: there is no camera '{}'; choose one of {}", error_place(scene), name, known));
}

void CompiledScene::choose_camera(const std::string& name) {
  camera_node_ = find_camera(source_, name);
  if (camera_node_ == kNone) {
    notes_.emplace_back("the scene has no camera: using a default camera that frames the scene");
    const float tan_half_y = std::tan(0.5f * camera_.fov_y_rad);
    const float aspect = static_cast<float>(resolution_.x) / static_cast<float>(resolution_.y);
    const Vec3 forward = -glm::normalize(Vec3(0.6f, 0.4f, 1.0f));
    default_camera_ = framing_camera(view_, forward, {tan_half_y * aspect, tan_half_y}, bounds_.center);
    return;
  }
  camera_ = source_.cameras[static_cast<size_t>(source_.nodes[static_cast<size_t>(camera_node_)].camera)];
}

size_t CompiledScene::memory_bytes() const {
  return vertices_.memory_bytes() + triangles_.memory_bytes() + uv1_.memory_bytes() + colors_.memory_bytes() +
         meshes_.memory_bytes() + instances_.memory_bytes() + materials_.memory_bytes() + layers_.memory_bytes() +
         energy_tables_.memory_bytes() + textures_.memory_bytes() + previous_positions_.memory_bytes() +
         instance_keys_.memory_bytes() + vertex_keys_.memory_bytes() + camera_keys_.memory_bytes() +
         deforming_vertices_.memory_bytes() + deforming_.memory_bytes() + lights_.memory_bytes() +
         accel_->memory_bytes();
}

}  // namespace relume
