// The scene as its author describes it: a node hierarchy that refers to meshes, materials, textures, lights,
// cameras and animation. Loaders and built-in scenes fill it; a session compiles it.
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

/// The brightest radiance, intensity or irradiance that lights may have: squares and sums of it are still finite.
inline constexpr float kMaxRadiance = 1e15f;

/// Index into one of the scene's arrays; kNone is "absent".
using Index = int32_t;
inline constexpr Index kNone = -1;

// --- Textures -----------------------------------------------------------------------------------------

/// An image for look-ups on surfaces. Row 0 is the top row; glTF's v runs downwards.
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  PixelFormat format = PixelFormat::rgba8_srgb;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  FilterMode filter = FilterMode::linear;
  std::vector<std::byte> texels;  ///< width · height · bytes per texel, tightly packed
  /// The image file that `texels` were decoded from; writers keep it as long as it decodes to them. Empty: none.
  std::shared_ptr<const std::vector<std::byte>> file;
};

/// Where a material takes a texture from (KHR_texture_transform): uv' = offset + R · (scale ⊙ uv), R = (cos sin; −sin
/// cos) of the rotation, which is counter-clockwise because V points down.
struct TextureRef {
  Index texture = kNone;
  int uv_set = 0;  ///< 0 or 1
  Vec2 offset{0};
  Vec2 scale{1};
  float rotation_rad = 0;

  bool used() const { return texture != kNone; }
};

// --- Materials ----------------------------------------------------------------------------------------

/// glTF 2.0 metallic-roughness with the KHR extensions named beside each member. A texture multiplies its
/// factor, in the channels that glTF says.
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
  bool double_sided = false;     ///< emission leaves from the front only unless set
  bool cull_back_faces = false;  ///< the camera sees through the back, as glTF asks for single-sided faces
  bool unlit = false;            ///< KHR_materials_unlit: base colour is emitted, nothing is reflected

  float ior = 1.5f;             ///< KHR_materials_ior; at the line d, 587.56 nm
  float dispersion = 0;         ///< KHR_materials_dispersion: 20 over the Abbe number; needs a thickness
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
  TextureRef clearcoat_normal_texture;     ///< unused: the coat is not bent, whatever normal_texture says
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
  float iridescence_thickness_min_nm = 100;  ///< where the thickness texture is 0
  float iridescence_thickness_nm = 400;      ///< where it is 1; also used without a texture
  TextureRef iridescence_thickness_texture;  ///< G
  float diffuse_transmission = 0;            ///< KHR_materials_diffuse_transmission
  TextureRef diffuse_transmission_texture;   ///< A
  Rgb diffuse_transmission_color{1};
  TextureRef diffuse_transmission_color_texture;  ///< RGB
  MicrofacetModel microfacet_model = MicrofacetModel::ggx;
};

// --- Geometry -----------------------------------------------------------------------------------------

/// Displacements of a mesh's vertices, which a node adds with a weight of its own. Arrays are empty, which displaces
/// nothing, or have one entry a vertex.
struct MorphTarget {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<Vec3> tangents;
};

/// Weight with which a joint moves a vertex.
struct JointInfluence {
  uint32_t joint = 0;  ///< index in Skin::joints
  float weight = 0;    ///< not negative; those of a vertex sum to 1
};

/// The material of a mesh in one of Scene::variants.
struct VariantMaterial {
  Index variant = 0;
  Index material = kNone;
};

/// Triangles with one material. Either every optional attribute array is empty or it has one entry a vertex.
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
  std::vector<VariantMaterial> variants = {};  ///< materials in other variants; missing ones keep the default
  std::optional<Index> default_material = {};  ///< `material` where no variant is chosen; empty: `material` itself
  std::vector<MorphTarget> morph_targets = {};
  int influences_per_vertex = 0;                ///< 0: no skin bends the mesh
  std::vector<JointInfluence> influences = {};  ///< as many for each vertex, in the order of the vertices
};

// --- Lights and environment ---------------------------------------------------------------------------

enum class PunctualType : uint8_t { point, spot, directional };

/// KHR_lights_punctual; shines along the node's -Z. Candela and lux map one to one to radiometric units.
struct PunctualLight {
  std::string name;
  PunctualType type = PunctualType::point;
  Rgb intensity{1};                ///< point, spot: W/sr; directional: irradiance on a facing plane, W/m²
  float inner_cone_rad = 0;        ///< spot: full intensity inside this half-angle
  float outer_cone_rad = kPi / 4;  ///< spot: none outside this half-angle
  float angular_diameter_rad = 0;  ///< directional: 0 is a delta light
};

struct SunSky {
  float sun_elevation_rad = 0.6f;
  float sun_azimuth_rad = 0.0f;  ///< from +Z towards +X
  float turbidity = 3.0f;        ///< 1.7 (clear) … 10 (hazy)
  float sky_scale = 1.0f;
  float sun_scale = 1.0f;
  float sun_angular_diameter_rad = 0.00925f;
  Rgb ground_albedo{0.3f};
};

enum class EnvironmentKind : uint8_t {
  none,
  constant,
  map,
  sun_sky,
  studio,     ///< neutral photo studio: three soft boxes before a dim backdrop, turned towards the scene's camera
  automatic,  ///< the studio if nothing in the scene lights what its camera sees; otherwise none
};

/// Light from infinity. Map: equirectangular, row 0 is +Y, the centre column looks along -Z for rotation 0,
/// and +X lies to its right.
struct Environment {
  EnvironmentKind kind = EnvironmentKind::none;
  Rgb color{1};            ///< constant: radiance; others: multiplies
  int width = 0;           ///< map
  int height = 0;          ///< map
  std::vector<Rgb> map;    ///< radiance, row by row from the top
  float rotation_rad = 0;  ///< about +Y
  SunSky sun_sky;
};

// --- Cameras ------------------------------------------------------------------------------------------

enum class Projection : uint8_t { perspective, orthographic, panoramic };

/// Looks along the node's -Z with +Y up. The image's own aspect ratio decides the horizontal extent.
struct Camera {
  std::string name;
  Projection projection = Projection::perspective;
  float fov_y_rad = 0.8f;    ///< perspective, full vertical angle
  float half_height = 1;     ///< orthographic, metres
  float aspect_ratio = 0;    ///< width over height that images get if no other is asked for; 0: any
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

/// Joints that bend the meshes of a node (linear blend skinning). A vertex p of the mesh is at
/// Σ weight · world(joint) · inverse_bind · p in the world. The node's own transform is ignored.
struct Skin {
  std::string name;
  std::vector<Index> joints;       ///< nodes
  std::vector<Mat4> inverse_bind;  ///< one a joint: from the space of the mesh to that of the joint, affine
};

struct Node {
  std::string name;
  Index parent = kNone;
  Transform transform;         ///< local; what animation changes
  std::optional<Mat4> matrix;  ///< replaces `transform` when the file gives one (cannot be animated)
  std::vector<Index> meshes;
  std::vector<Mat4> instances;  ///< EXT_mesh_gpu_instancing: meshes appear once per matrix; empty: once
  Index light = kNone;
  Index camera = kNone;
  Index skin = kNone;  ///< deforms the node's meshes that have influences
  /// Of the meshes' morph targets, in their order; weights that are missing are 0.
  std::vector<float> morph_weights = {};
  bool visible = true;  ///< KHR_node_visibility: false hides the meshes and lights of this node and of those below
};

enum class AnimatedProperty : uint8_t { translation, rotation, scale, morph_weight, visible };
enum class Interpolation : uint8_t { step, linear, cubic_spline };

/// Key frames of one property of one node.
struct AnimationChannel {
  Index node = kNone;
  AnimatedProperty property = AnimatedProperty::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  ///< seconds, strictly increasing
  /// One value a key (xyz, quaternion xyzw, or x alone); cubic_spline: in-tangent, value, out-tangent a key. A node is
  /// visible where x is not 0.
  std::vector<Vec4> values;
  Index morph_target = 0;  ///< index of the morph target, for morph_weight
  Index clip = kNone;      ///< of Scene::clips; kNone: plays with each of them
};

enum class AnimatedPart : uint8_t { material, light, camera };

/// Key frames of one parameter of a material, light or camera.
struct ParameterChannel {
  AnimatedPart part = AnimatedPart::material;
  Index index = kNone;  ///< in Scene::materials, lights or cameras
  std::string
      parameter;  ///< by its key in relume JSON without unit: "roughness", "intensity", "fov_y"; "KEY_texture.offset"
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  ///< seconds, strictly increasing
  std::vector<Vec4> values;  ///< as those of AnimationChannel; angles in radians
  Index clip = kNone;        ///< of Scene::clips; kNone: plays with each of them
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
  std::vector<std::string> clips;  ///< names of the animations, of which one plays or several together
  std::vector<AnimationChannel> animation;
  std::vector<ParameterChannel> parameter_animation;
  Environment environment;
  std::vector<std::string> variants;                ///< names of other choices of materials (KHR_materials_variants)
  std::string settings_json;                        ///< settings the file asks for, a JSON object; empty: none
  std::vector<std::string> warnings;                ///< what was ignored or repaired, one sentence each
  std::vector<std::string> notes;                   ///< what was ignored and changes nothing, one sentence each
  std::vector<std::filesystem::path> source_files;  ///< that load_scene() read, missing ones included

  Index add_node(Node node) {
    nodes.push_back(std::move(node));
    return static_cast<Index>(nodes.size()) - 1;
  }
};

/// Gives every mesh its material in the variant of that name, or its default material where `name` is empty or the
/// variant has none for it. Throws Error (not_found) with the names of all variants if there is no such variant.
RELUME_API void choose_variant(Scene& scene, const std::string& name);

/// Checks what kernels rely on: indices in range, no cycles, finite numbers, array sizes that agree. Throws
/// Error with `place` (a file name) in its sentence. Loaders repair what they can before they call it.
RELUME_API void validate(const Scene& scene, const std::string& place);

/// World matrix of every node at `time_s`, with the animation of all clips. Values are held before the first key and
/// after the last. Of channels that drive the same property, the first one counts.
RELUME_API std::vector<Mat4> world_matrices(const Scene& scene, float time_s);

/// As many as the nodes of a valid scene place, every instance counted.
RELUME_API size_t placed_triangles(const Scene& scene);

/// Leaves the channels of one clip, by name or index (from 0), of several, separated by commas, or of "all"; empty: the
/// first. Channels without a clip stay. Of channels that drive the same property, the first one stays. Throws an Error
/// that lists the clips if there is no such clip.
RELUME_API void select_animation(Scene& scene, const std::string& choice);

/// Time of the last key in seconds; 0 without animation.
RELUME_API float animation_end(const Scene& scene);

/// Transform of a camera node at `eye` that looks at `target` with +Y up.
RELUME_API Transform look_at(const Vec3& eye, const Vec3& target);

}  // namespace relume
