// Scenes of experiments: a box that the camera stands in, real rooms and a city, and variations of the box.
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
  std::string property = {};  ///< what a variation varies: "light", "triangles", "material"
  Scene scene;
  std::optional<CameraPose> camera = {};  ///< at which a turn ends; empty: the scene's own
  RenderSettings settings = {};           ///< bounces
  int scale = 1;                          ///< edges of its images over the usual ones, in a full run
};

/// A technique that an experiment measures.
struct NamedSettings {
  std::string name;
  RenderSettings settings;
};

/// A built-in scene as it is, with its camera path. Throws Error if there is none of that name.
ExperimentScene built_in(std::string_view name, int max_bounces);

/// The scene through its own first camera where that stands at time 0, instead of along its camera path. Throws Error
/// if it has none.
ExperimentScene at_rest(ExperimentScene scene);

/// Which of the properties of [Schalk18 §4.2.4, §4.3.4] the box has.
enum class BoxVariation { plain, point_light, directional_light, triangles_80k, triangles_1m, reflective, glass };

/// The closed Cornell box with slightly glossy walls, as in the paper, seen from inside. Light from a direction comes
/// in where the ceiling is taken off.
ExperimentScene closed_box(BoxVariation variation = BoxVariation::plain);

/// Lights without extent.
enum class DeltaLight { point, directional };

/// A built-in box with such a light in place of its lamp. Light from a direction comes in obliquely where the ceiling
/// is taken off. Throws Error if there is no scene of that name, or if it has no lamp.
ExperimentScene box_under(std::string_view box, DeltaLight light, int max_bounces);

/// Sponza from the context's folder; std::nullopt if it is not there. Throws Error if it cannot be read.
std::optional<ExperimentScene> sponza(const ExperimentContext& context);

/// A street of the built-in city: sun and sky, nineteen million triangles.
ExperimentScene city_street();

/// The scene's camera turned to the left by an angle about +Y. Throws Error for an angle if the scene has none of the
/// experiment's own.
std::optional<CameraPose> turned(const ExperimentScene& scene, float degrees);
/// The same, and moved to its own right (as it looks when it is not turned) by `aside_m`. Without the scene's camera
/// both have to be 0.
std::optional<CameraPose> turned_aside(const ExperimentScene& scene, float degrees, float aside_m);

inline constexpr const char* kNoSponza = "needs Sponza: say with --scenes where sponza/sponza.gltf is";

/// A claim about Sponza, which is not built in.
struct SponzaClaim {
  std::string id;
  std::string claim;
  std::string threshold;
};
/// Adds the claims as not measured if the context has no folder of scenes.
void claim_without_sponza(const ExperimentContext& context, const char* paper, const std::vector<SponzaClaim>& missing,
                          std::vector<Claim>& claims);

}  // namespace relume
