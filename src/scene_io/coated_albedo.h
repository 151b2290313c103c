// Diffuse bases below the dielectric coats of pbrt's and Mitsuba's materials.
#pragma once

#include "relume/math.h"

namespace relume {

/// Share of the diffuse light inside a dielectric that its surface reflects back: F_dr = 1 - (1 - F_avg) / η².
float inner_reflectance(float ior);

/// Albedo that relume's diffuse base needs below a coat of index `ior` for the colour that light gives which bounces
/// between a base of `albedo` and the coat: ρ (1 - F_dr) / (1 - ρ F_dr). relume's base receives what the coat
/// transmits, without the light that the coat reflects back.
Rgb albedo_below_coat(const Rgb& albedo, float inner_reflectance);
/// The inverse.
Rgb albedo_without_coat(const Rgb& color, float inner_reflectance);

}  // namespace relume
