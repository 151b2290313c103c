// Writes parts of a relume JSON file from a scene; overrides.h reads them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scene/scene.h"

namespace relume {

/// "camera": placed by `to_world`, whose scale is lost.
nlohmann::json camera_to_json(const Camera& camera, const Mat4& to_world);

/// An element of "camera_keys": at `eye`, rotated by `rotation` from looking along -Z. Reading sets the up vector to
/// +Y.
nlohmann::json camera_key_to_json(float time_s, const Vec3& eye, const glm::quat& rotation);

/// An element of "materials": the parameters that the viewer changes. The reader keeps the scene's other values.
nlohmann::json material_to_json(const Material& material);

/// An element of "nodes": the transform relative to the parent.
nlohmann::json transform_to_json(const Transform& transform);

/// "environment". A map's file name is not in the scene: the caller adds "map". `none` is written as `constant` 0,
/// because the format has no equivalent.
nlohmann::json environment_to_json(const Environment& environment);

}  // namespace relume
