// Parts of a relume JSON file, made from what a scene holds; overrides.h reads them back.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "scene/scene.h"

namespace relume {

/// "camera": one that `to_world` places. Its scale is lost.
nlohmann::json camera_to_json(const Camera& camera, const Mat4& to_world);

/// One of "camera_keys": at `eye`, turned by `rotation` from looking along -Z. What is up comes back as +Y.
nlohmann::json camera_key_to_json(float time_s, const Vec3& eye, const glm::quat& rotation);

/// One of "materials": the parameters that the viewer changes. Others stay as the scene has them.
nlohmann::json material_to_json(const Material& material);

/// One of "nodes": where it stands below its parent.
nlohmann::json transform_to_json(const Transform& transform);

/// "environment"; for a map without the file, whose name a scene does not know: the caller adds "map". `none` comes
/// back as `constant` 0: the format has no word for it.
nlohmann::json environment_to_json(const Environment& environment);

}  // namespace relume
