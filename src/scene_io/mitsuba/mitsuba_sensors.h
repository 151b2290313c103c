// Sensors of Mitsuba scenes, with their films and samplers.
#pragma once

#include "scene_io/mitsuba/mitsuba_parameters.h"

namespace relume::mitsuba {

/// Adds the camera of a sensor with its node below `parent`. Sensors that are no cameras are skipped with a warning.
/// The first camera requests the size of its film and its samples per pixel in Scene::settings_json. Mitsuba's cameras
/// look along +Z with +X to the left; images are the same.
void import_sensor(const Object& sensor, Index parent, Import& import);

/// Whether the first camera's to_world mirrors.
bool is_mirrored(const Import& import);

/// Requests the maximum path length of the integrators of `parent`. As in Mitsuba, paths without integrator or without
/// max_depth have no limit.
void import_integrators(const Parameters& parent, Import& import);

/// Full horizontal angle in radians from Mitsuba's parameters fov, fov_axis and focal_length. Throws Error unless it is
/// in (0, π).
double horizontal_fov_rad(const Parameters& sensor, double aspect);

}  // namespace relume::mitsuba
