// Writes geometry, lights, environment and camera as pbrt's directives.
#pragma once

#include <vector>

#include "scene_io/pbrt/pbrt_output.h"
#include "scene_io/pbrt/pbrt_write_materials.h"

namespace relume::pbrt {

/// Adds the camera and the studio that relume renders the scene with where it has none of its own, for other programs.
Scene with_defaults(Scene scene, Output& output);

/// Size of the image, pixels: that of the scene's settings, else 720 rows with the aspect ratio of the first camera.
IVec2 image_size(const Scene& scene);

/// Writes Film, Camera, Sampler and Integrator. The scene needs a camera. pbrt's camera space is left-handed: the
/// written matrix mirrors, and the world stays as it is.
void write_camera(const Scene& scene, const std::vector<Mat4>& world, Output& output);

/// Writes the lights of visible nodes, and the environment, which must not be automatic.
void write_lights(const Scene& scene, const std::vector<Mat4>& world, const std::vector<bool>& visible, Output& output);

/// Writes the meshes of visible nodes: as objects with instances if they are used more than once.
void write_shapes(const Scene& scene, const std::vector<Mat4>& world, const std::vector<bool>& visible,
                  const std::vector<WrittenMaterial>& materials, Output& output);

}  // namespace relume::pbrt
