// Parts of scenes whose images have an analytic answer, and the formulas for them.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "scene/scene.h"

namespace relume::support {

/// A camera node at `eye` that looks along `direction` (not along ±Y).
void add_camera(Scene& scene, const Camera& camera, const Vec3& eye, const Vec3& direction);

/// A mesh with a node and a material of its own.
void add(Scene& scene, Mesh mesh, Material material);
void add_light(Scene& scene, const PunctualLight& light, const Transform& placed = {});
void set_constant_environment(Scene& scene, const Rgb& radiance);
Index add_texture(Scene& scene, Texture texture);

/// Orthographic camera that sees 1 mm² about `target` along `direction`, from `distance` metres.
void add_spot_meter(Scene& scene, const Vec3& target, const Vec3& direction, float distance);

/// A white Lambert patch about the origin that faces +Z, and a spot meter on it: the image is irradiance / π.
Scene irradiance_meter();

/// The Cornell box, open at the front to a sky, with two lamps besides its own: some light of every kind to choose
/// from.
Scene open_box();

/// 8 bit linear, nearest: texel (x, y) from `value`.
Texture make_texture(int width, int height, PixelFormat format, std::array<int, 4> (*value)(int x, int y));

/// The node of that name; fails the test if there is none.
Index node_named(const Scene& scene, std::string_view name);

/// Unlit: shows `color` from everywhere.
Material unlit(const Rgb& color);

/// Irradiance at p with normal n under a polygon of radiance 1 that is wholly above the horizon and seen from its front
/// or back alike (Lambert's formula).
double polygon_irradiance(const std::vector<Vec3>& polygon, const Vec3& p, const Vec3& n);

/// Irradiance under the front sides of a mesh of radiance 1 whose triangles do not hide one another, all above the
/// horizon.
double mesh_irradiance(const Mesh& mesh, const Vec3& p, const Vec3& n);

}  // namespace relume::support
