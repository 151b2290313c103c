// Parameters of materials, lights and cameras that key frames can animate, by the names of ParameterChannel.
#pragma once

#include <string_view>
#include <variant>

#include "scene/scene.h"

namespace relume {

/// The member of that name; std::monostate if none exists. Materials: the numbers and colours of material_parameters()
/// by their keys, and "KEY_texture.offset", ".scale" and ".rotation" of their textures. Lights: "intensity",
/// "inner_cone", "outer_cone" and "angular_diameter" (radians). Cameras: "fov_y" (radians), "half_height",
/// "lens_radius" and "focus_distance".
using ParameterMember = std::variant<std::monostate, float*, Rgb*, Vec2*>;
ParameterMember find_parameter(Material& material, std::string_view name);
ParameterMember find_parameter(PunctualLight& light, std::string_view name);
ParameterMember find_parameter(Camera& camera, std::string_view name);

/// Whether two materials have equal numbers, colours and textures.
bool same_material(const Material& a, const Material& b);

/// Whether the scene has the parameter.
bool has_parameter(const Scene& scene, const ParameterChannel& channel);

/// Sets the parameter to its value at `time_s`, clamped to the valid range.
void apply(const ParameterChannel& channel, float time_s, Material& material);
void apply(const ParameterChannel& channel, float time_s, PunctualLight& light);
void apply(const ParameterChannel& channel, float time_s, Camera& camera);

/// Sets every animated parameter of the scene.
void apply_parameters(Scene& scene, float time_s);

}  // namespace relume
