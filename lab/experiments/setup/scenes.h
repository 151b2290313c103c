// Scenes of experiments: a box around the camera, real rooms and a city, and variations of the box.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/experiment.h"
#include "render/render_settings.h"
#include "scene/compiled_scene.h"
#include "scene/scene.h"

namespace relume {

struct ExperimentScene {
  std::string name;
  std::string property = {};  ///< changed property of a variation: "light", "triangles", "material"
  Scene scene;
  std::optional<CameraPose> camera = {};  ///< end of a turn; empty: the scene's own
  RenderSettings settings = {};           ///< bounces
  int scale = 1;                          ///< image scale per edge in a full run
};

/// A measured technique.
struct NamedSettings {
  std::string name;
  RenderSettings settings;
};

/// A built-in scene with its camera path. Throws Error if it is missing.
ExperimentScene built_in(std::string_view name, int max_bounces);

/// The scene with its first camera fixed at its pose at time 0. Throws Error if it has none.
ExperimentScene at_rest(ExperimentScene scene);

/// Variations of the box from [Schalk18 §4.2.4, §4.3.4].
enum class BoxVariation { plain, point_light, directional_light, triangles_80k, triangles_1m, reflective, glass };

/// The closed Cornell box with slightly glossy walls, as in the paper, seen from inside. For directional light, the
/// ceiling is removed.
ExperimentScene closed_box(BoxVariation variation = BoxVariation::plain);

/// Lights without extent.
enum class DeltaLight { point, directional };

/// A built-in box with such a light instead of its lamp. Directional light enters obliquely through a removed ceiling.
/// Throws Error if the scene or its lamp is missing.
ExperimentScene box_under(std::string_view box, DeltaLight light, int max_bounces);

/// A built-in box whose lamp is `scale` times as long and as deep, with the same power. Throws Error if the scene or
/// its lamp is missing.
ExperimentScene box_under_large_lamp(std::string_view box, float scale, int max_bounces);

/// Sponza from the context's folder; std::nullopt if unavailable. Throws Error if it cannot be read.
std::optional<ExperimentScene> sponza(const ExperimentContext& context);

/// A street of the built-in city: sun and sky, 19 million triangles.
ExperimentScene city_street();

/// The experiment's camera turned left by an angle about +Y. Throws Error for a nonzero angle if the scene has none.
std::optional<CameraPose> turned(const ExperimentScene& scene, float degrees);
/// Same, and moved to the right of the unturned view by `aside_m`. Without a camera, both must be 0.
std::optional<CameraPose> turned_aside(const ExperimentScene& scene, float degrees, float aside_m);
/// Same, and moved by `ahead_m` in the direction of the unturned view: a step of a walk.
std::optional<CameraPose> turned_ahead(const ExperimentScene& scene, float degrees, float ahead_m);

inline constexpr const char* kNoSponza = "needs Sponza: give the folder above sponza/sponza.gltf with --scenes";

/// Motion of a walk per frame: 1.2 m/s at 24 frames per second.
inline constexpr float kWalkStep_m = 0.05f;
inline constexpr float kWalkTurn_deg = 0.5f;

/// A claim about Sponza, which is not a built-in scene.
struct SponzaClaim {
  std::string id;
  std::string claim;
  std::string threshold;
};
/// Adds the claims as not measured if the context has no scene folder.
void claim_without_sponza(const ExperimentContext& context, const char* paper, const std::vector<SponzaClaim>& missing,
                          std::vector<Claim>& claims);

}  // namespace relume
