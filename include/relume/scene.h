// Scene description: a node hierarchy that refers to meshes, materials, textures, lights, cameras and animation.
// Loaders and built-in scenes fill it; a session compiles it.
// Conventions: metres, right-handed, +Y up, linear Rec. 709 radiance.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "relume/export.h"
#include "relume/material_types.h"
#include "relume/math.h"

namespace relume {

/// Upper limit of radiance, intensity and irradiance of lights. Their squares and sums stay finite.
inline constexpr float kMaxRadiance = 1e15f;

/// Index into one of the scene's arrays; kNone: absent.
using Index = int32_t;
inline constexpr Index kNone = -1;

// --- Textures -----------------------------------------------------------------------------------------

/// An image for surface look-ups. Row 0 is the top row; glTF's v runs downwards.
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  PixelFormat format = PixelFormat::rgba8_srgb;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  FilterMode filter = FilterMode::linear;
  std::vector<std::byte> texels;  ///< width · height · bytes per texel, tightly packed
  /// Image file that `texels` were decoded from; empty: none. Writers copy it if it still decodes to `texels`.
  std::shared_ptr<const std::vector<std::byte>> file;
};

/// A material's use of a texture (KHR_texture_transform): uv' = offset + R · (scale ⊙ uv). R = (cos sin; −sin cos) of
/// the rotation, which is counter-clockwise because V points down.
struct TextureRef {
  Index texture = kNone;
  int uv_set = 0;  ///< 0 or 1
  Vec2 offset{0};
  Vec2 scale{1};
  float rotation_rad = 0;

  bool used() const { return texture != kNone; }
};

// --- Materials ----------------------------------------------------------------------------------------

/// glTF 2.0 metallic-roughness with the KHR extensions named beside each member. A texture multiplies its factor, in
/// the channels that glTF defines.
struct Material {
  std::string name;

  Rgb base_color{1};
  float alpha = 1;
  TextureRef base_color_texture;  ///< RGB colour, A alpha
  float metallic = 1;
  float roughness = 1;                    ///< perceptual r in [0, 1]; microfacet α = r²
  TextureRef metallic_roughness_texture;  ///< G roughness, B metallic
  TextureRef normal_texture;
  float normal_scale = 1;

  Rgb emission{0};  ///< radiance: emissive factor × strength (KHR_materials_emissive_strength)
  TextureRef emission_texture;

  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;     ///< whether the back emits, too
  bool cull_back_faces = false;  ///< whether back faces are invisible to the camera, as glTF specifies if single-sided
  bool unlit = false;            ///< KHR_materials_unlit: emits the base colour, reflects nothing

  float ior = 1.5f;             ///< KHR_materials_ior, at the Fraunhofer d line, 587.56 nm
  float dispersion = 0;         ///< KHR_materials_dispersion: 20 / Abbe number; without effect if the thickness is 0
  float specular = 1;           ///< KHR_materials_specular
  TextureRef specular_texture;  ///< A
  Rgb specular_color{1};
  TextureRef specular_color_texture;  ///< RGB
  float transmission = 0;             ///< KHR_materials_transmission
  TextureRef transmission_texture;    ///< R
  float thickness = 0;                ///< KHR_materials_volume, metres; 0: thin-walled, no refraction
  Rgb attenuation_color{1};
  float attenuation_distance = kInfinity;  ///< metres
  float clearcoat = 0;                     ///< KHR_materials_clearcoat
  TextureRef clearcoat_texture;            ///< R
  float clearcoat_roughness = 0;
  TextureRef clearcoat_roughness_texture;  ///< G
  TextureRef clearcoat_normal_texture;     ///< empty: the coat has the unmapped normal, even with a normal_texture
  float clearcoat_normal_scale = 1;
  float anisotropy = 0;                      ///< KHR_materials_anisotropy: strength
  float anisotropy_rotation_rad = 0;         ///< counter-clockwise from the tangent
  TextureRef anisotropy_texture;             ///< RG direction, B strength
  Rgb sheen_color{0};                        ///< KHR_materials_sheen
  TextureRef sheen_color_texture;            ///< RGB
  float sheen_roughness = 0;                 ///< perceptual
  TextureRef sheen_roughness_texture;        ///< A
  float iridescence = 0;                     ///< KHR_materials_iridescence
  TextureRef iridescence_texture;            ///< R
  float iridescence_ior = 1.3f;              ///< of the film
  float iridescence_thickness_min_nm = 100;  ///< thickness where the texture is 0
  float iridescence_thickness_nm = 400;      ///< thickness where the texture is 1, or without a texture
  TextureRef iridescence_thickness_texture;  ///< G
  float diffuse_transmission = 0;            ///< KHR_materials_diffuse_transmission
  TextureRef diffuse_transmission_texture;   ///< A
  Rgb diffuse_transmission_color{1};
  TextureRef diffuse_transmission_color_texture;  ///< RGB
  MicrofacetModel microfacet_model = MicrofacetModel::ggx;

  /// A mixture of two materials. Each hit shows one part: the second with probability `mix_share`, else the first. The
  /// part reflects and transmits. The mixture decides emission, opacity and sides. Its normal map applies where the
  /// part has none. Its other parameters are an approximation for programs without mixtures.
  Index mix_first = kNone;  ///< kNone: no mixture
  Index mix_second = kNone;
  float mix_share = 0.5f;
  TextureRef mix_texture;  ///< R
};

/// Maximum depth of mixtures in mixtures.
inline constexpr int kMaxMixDepth = 16;

// --- Geometry -----------------------------------------------------------------------------------------

/// Displacements of a mesh's vertices; each node has its own weight for them. Arrays are empty (no displacement) or
/// have one entry per vertex.
struct MorphTarget {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<Vec3> tangents;
};

/// Weight with which a joint moves a vertex.
struct JointInfluence {
  uint32_t joint = 0;  ///< index in Skin::joints
  float weight = 0;    ///< not negative; the weights of a vertex sum to 1
};

/// The material of a mesh in one variant of Scene::variants.
struct VariantMaterial {
  Index variant = 0;
  Index material = kNone;
};

/// Triangles with one material. Each optional attribute array is empty or has one entry per vertex.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;   ///< unit; empty: flat shading
  std::vector<Vec4> tangents;  ///< xyz unit, w = ±1 handedness; empty: derived from uv where needed
  std::vector<Vec2> uv0;
  std::vector<Vec2> uv1;
  std::vector<Vec4> colors;  ///< linear RGBA, multiplies base colour and alpha
  std::vector<UVec3> triangles;
  Index material = kNone;                      ///< kNone: glTF's default material
  std::vector<VariantMaterial> variants = {};  ///< materials in variants; other variants keep the default
  std::optional<Index> default_material = {};  ///< material if no variant is chosen; empty: `material`
  std::vector<MorphTarget> morph_targets = {};
  int influences_per_vertex = 0;                ///< 0: the mesh is not skinned
  std::vector<JointInfluence> influences = {};  ///< influences_per_vertex for each vertex, in vertex order
};

// --- Lights and environment ---------------------------------------------------------------------------

enum class PunctualType : uint8_t { point, spot, directional };

/// Punctual light (KHR_lights_punctual) that shines along the node's -Z. glTF's photometric units are read as
/// radiometric ones: 1 cd as 1 W/sr, 1 lx as 1 W/m².
struct PunctualLight {
  std::string name;
  PunctualType type = PunctualType::point;
  Rgb intensity{1};                ///< point, spot: W/sr; directional: irradiance on a facing plane, W/m²
  float inner_cone_rad = 0;        ///< spot: full intensity inside this half-angle
  float outer_cone_rad = kPi / 4;  ///< spot: no light outside this half-angle
  float angular_diameter_rad = 0;  ///< directional: 0 is a delta light
};

/// Daylight: the analytic sky of [Preetham99] and the sun. A radiance of 1 is 1 kcd/m².
struct SunSky {
  float sun_elevation_rad = 0.6f;
  float sun_azimuth_rad = 0.0f;  ///< from +Z towards +X
  float turbidity = 3.0f;        ///< 1.7 (clear) … 10 (hazy)
  float sky_scale = 1.0f;        ///< factor of the sky's radiance
  float sun_scale = 1.0f;        ///< factor of the sun's radiance
  float sun_angular_diameter_rad = 0.00925f;
  Rgb ground_albedo{0.3f};
};

enum class EnvironmentKind : uint8_t {
  none,
  constant,
  map,
  sun_sky,
  studio,     ///< neutral photo studio: three soft boxes before a dim backdrop, oriented by the scene's camera
  automatic,  ///< the studio if nothing in the scene lights the camera's view; otherwise none
};

/// Light from infinity. Maps are equirectangular: row 0 is +Y, the centre column looks along -Z for rotation 0, and +X
/// lies to its right.
struct Environment {
  EnvironmentKind kind = EnvironmentKind::none;
  Rgb color{1};            ///< constant: radiance; other kinds: factor
  int width = 0;           ///< map
  int height = 0;          ///< map
  std::vector<Rgb> map;    ///< radiance, row by row from the top
  float rotation_rad = 0;  ///< about +Y, counter-clockwise as seen from above
  SunSky sun_sky;
};

// --- Cameras ------------------------------------------------------------------------------------------

enum class Projection : uint8_t { perspective, orthographic, panoramic };

/// Looks along the node's -Z with +Y up. The aspect ratio of the image determines the horizontal extent.
struct Camera {
  std::string name;
  Projection projection = Projection::perspective;
  float fov_y_rad = 0.8f;    ///< perspective, full vertical angle
  float half_height = 1;     ///< orthographic, metres
  float aspect_ratio = 0;    ///< default width over height of images; 0: any
  float lens_radius = 0;     ///< perspective, metres; 0: pinhole
  float focus_distance = 1;  ///< metres along -Z
};

/// A camera that is not a node of the scene.
struct CameraPose {
  Mat4 to_world{1};
  Camera camera;
};

// --- Hierarchy and animation --------------------------------------------------------------------------

struct Transform {
  Vec3 translation{0};
  Quaternion rotation{1, 0, 0, 0};
  Vec3 scale{1};
};

/// Joints that deform the meshes of a node (linear blend skinning). Vertex p of the mesh has the world position Σ
/// weight · world(joint) · inverse_bind · p. The node's own transform is ignored.
struct Skin {
  std::string name;
  std::vector<Index> joints;       ///< nodes
  std::vector<Mat4> inverse_bind;  ///< one per joint: from mesh space to joint space, affine
};

struct Node {
  std::string name;
  Index parent = kNone;
  Transform transform;         ///< from the node to its parent; can be animated
  std::optional<Mat4> matrix;  ///< local matrix from the file; replaces `transform` and cannot be animated
  std::vector<Index> meshes;
  std::vector<Mat4> instances;  ///< EXT_mesh_gpu_instancing: one copy of the meshes per matrix; empty: one copy
  Index light = kNone;
  Index camera = kNone;
  Index skin = kNone;  ///< deforms the node's meshes that have influences
  /// Weights of the meshes' morph targets, in their order; missing weights are 0.
  std::vector<float> morph_weights = {};
  bool visible = true;  ///< KHR_node_visibility: false hides the meshes and lights of this node and its descendants
};

enum class AnimatedProperty : uint8_t { translation, rotation, scale, morph_weight, visible };
enum class Interpolation : uint8_t { step, linear, cubic_spline };

/// Key frames of one property of one node.
struct AnimationChannel {
  Index node = kNone;
  AnimatedProperty property = AnimatedProperty::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  ///< seconds, strictly increasing
  /// One value per key (xyz, quaternion xyzw, or x alone). cubic_spline: in-tangent, value, out-tangent per key. A node
  /// is visible if x is not 0.
  std::vector<Vec4> values;
  Index morph_target = 0;  ///< target index for morph_weight
  Index clip = kNone;      ///< index in Scene::clips; kNone: part of every clip
};

enum class AnimatedPart : uint8_t { material, light, camera };

/// Key frames of one parameter of a material, light or camera.
struct ParameterChannel {
  AnimatedPart part = AnimatedPart::material;
  Index index = kNone;    ///< index in Scene::materials, lights or cameras
  std::string parameter;  ///< relume JSON key without unit: "roughness", "intensity", "fov_y", "KEY_texture.offset"
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  ///< seconds, strictly increasing
  std::vector<Vec4> values;  ///< as in AnimationChannel; angles in radians
  Index clip = kNone;        ///< index in Scene::clips; kNone: part of every clip
};

/// A box of space, and the boxes of which a point is visible from one of its points.
struct VisibleSet {
  Vec3 low{0};  ///< metres
  Vec3 high{0};
  std::vector<uint32_t> visible;  ///< indices in Scene::visible_sets, the box itself included

  friend bool operator==(const VisibleSet&, const VisibleSet&) = default;
};

/// Part of an image, in fractions of its width from the left and of its height from the top.
struct ImagePart {
  float left = 0;
  float top = 0;
  float right = 1;
  float bottom = 1;

  friend bool operator==(const ImagePart&, const ImagePart&) = default;
};

struct Scene {
  std::string name;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<PunctualLight> lights;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;  ///< any order; parents may follow children; no cycles
  std::vector<Skin> skins;
  std::vector<std::string> clips;  ///< names of the animations, which play one at a time or together
  std::vector<AnimationChannel> animation;
  std::vector<ParameterChannel> parameter_animation;
  Environment environment;
  std::vector<std::string> variants;  ///< names of alternative sets of materials (KHR_materials_variants)
  /// Boxes that hold all lamps and lit surfaces at all times, such as rooms. They do not overlap. Empty: unknown.
  std::vector<VisibleSet> visible_sets;
  std::string settings_json;                        ///< settings that the file requests, a JSON object; empty: none
  ImagePart crop;                                   ///< part of the image that the file requests
  std::vector<std::string> warnings;                ///< ignored or repaired input, one sentence each
  std::vector<std::string> notes;                   ///< ignored input without effect on images, one sentence each
  std::vector<std::filesystem::path> source_files;  ///< files that load_scene() read, including missing ones

  Index add_node(Node node) {
    nodes.push_back(std::move(node));
    return static_cast<Index>(nodes.size()) - 1;
  }
};

/// Gives every mesh its material in the named variant. Uses the mesh's default material if `name` is empty or the
/// variant has no material for the mesh. Throws Error (not_found) with the names of all variants if no variant has that
/// name.
RELUME_API void choose_variant(Scene& scene, const std::string& name);

/// Checks the invariants that kernels rely on: indices in range, no cycles, finite numbers, consistent array sizes.
/// Throws Error that names `place` (a file name). Loaders repair their input before they call it.
RELUME_API void validate(const Scene& scene, const std::string& place);

/// World matrix of every node at `time_s`, animated by all clips. Values are held before the first key and after the
/// last. Of channels that drive the same property, the first one applies.
RELUME_API std::vector<Mat4> world_matrices(const Scene& scene, float time_s);

/// Number of triangles after instancing: each mesh counts once per instance. The scene must be valid.
RELUME_API size_t placed_triangles(const Scene& scene);

/// Keeps the channels of the chosen clips and those without a clip. `choice` is a name, an index (from 0), several of
/// these separated by commas, or "all"; empty: the first clip. Of channels that drive the same property, the first one
/// stays. Throws Error that lists the clips if a clip does not exist.
RELUME_API void select_animation(Scene& scene, const std::string& choice);

/// Time of the last key in seconds; 0 without animation.
RELUME_API float animation_end(const Scene& scene);

/// Transform of a camera node at `eye` that looks at another point `target` with +Y up, or -Z up if that is above or
/// below.
RELUME_API Transform look_at(const Vec3& eye, const Vec3& target);

}  // namespace relume
