// Lamps and environments of Mitsuba scenes.
#pragma once

#include "scene_io/mitsuba/mitsuba_parameters.h"

namespace relume::mitsuba {

/// Import::turn: a mirror if the first camera mirrors the image, which relume's cameras cannot, then the rotation that
/// takes the zenith of the scene's sky to +Y, which relume's sky needs.
glm::dmat4 turn_of_scene(const Import& import);

/// Adds a lamp below `parent`, or sets the environment. Emitters that are not supported are skipped with a warning.
void import_emitter(const Object& emitter, Index parent, Import& import);

/// Whether the type is that of Mitsuba's daylight.
bool is_daylight(const Object& emitter);

/// Axes of the daylight's own frame in the world, of which the third is the zenith. Until Mitsuba 0.6, +Y is up by
/// default, and +Z is since.
glm::dmat3 daylight_frame(const Parameters& p);

/// Daylight of "sunsky" and its old forms "sky" and "sun".
void import_daylight(const Parameters& p, Import& import);

/// Unit vector towards the sun in the emitter's frame, where +Z is up, from date, time and place as in Mitsuba.
glm::dvec3 sun_direction_of_time(const Parameters& p);

/// Environment map of "envmap". Mitsuba's maps start in the direction −Z; the columns run towards +X.
void import_environment_map(const Parameters& p, Import& import);

}  // namespace relume::mitsuba
