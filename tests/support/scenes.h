// Parts of scenes with analytic images, and the formulas for them.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "scene/scene.h"

namespace relume::support {

/// Adds a camera node at `eye` looking along `direction` (not along ±Y).
void add_camera(Scene& scene, const Camera& camera, const Vec3& eye, const Vec3& direction);

/// Adds a mesh with a separate node and material.
void add(Scene& scene, Mesh mesh, Material material);
void add_light(Scene& scene, const PunctualLight& light, const Transform& placed = {});
void set_constant_environment(Scene& scene, const Rgb& radiance);
Index add_texture(Scene& scene, Texture texture);

/// Adds an orthographic camera that covers 1 mm² about `target` along `direction`, from `distance` metres.
void add_spot_meter(Scene& scene, const Vec3& target, const Vec3& direction, float distance);

/// A white Lambertian patch at the origin facing +Z, and a spot meter on it: the image is irradiance / π.
Scene irradiance_meter();

/// The Cornell box, open at the front to a sky, with two additional lamps: light of every kind for selection.
Scene open_box();

/// The parts of testing::figure() in a room with a lamp, viewed from the front. Node 0 holds the figure.
Scene in_a_room(Scene figure);

/// 8-bit texture with nearest filtering and texel (x, y) from `value`.
Texture make_texture(int width, int height, PixelFormat format, std::array<int, 4> (*value)(int x, int y));

/// Node with this name; fails the test if it is missing.
Index node_named(const Scene& scene, std::string_view name);

/// Unlit material of this colour.
Material unlit(const Rgb& color);

/// Irradiance at p with normal n under a polygon of radiance 1 on both sides, entirely above the horizon (Lambert's
/// formula).
double polygon_irradiance(const std::vector<Vec3>& polygon, const Vec3& p, const Vec3& n);

/// Irradiance under the front faces of a mesh of radiance 1, entirely above the horizon and without mutual occlusion.
double mesh_irradiance(const Mesh& mesh, const Vec3& p, const Vec3& n);

}  // namespace relume::support
