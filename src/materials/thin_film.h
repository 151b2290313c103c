// Iridescence: interference in a clear film over a dielectric or a metal ([Belcour17], KHR_materials_iridescence).
#pragma once

#include "core/math.h"
#include "materials/fresnel.h"

namespace relume {

/// Material under the film.
enum class FilmBase : uint8_t { none, dielectric, metal };

/// A film, and the reflectances of both kinds of base without it.
struct ThinFilm {
  float weight;  ///< share of the surface with the film
  float ior;
  float thickness_nm;
  Rgb dielectric_f0;
  float dielectric_f90;
  Rgb metal_f0;  ///< approaches 1 at grazing angles
};

namespace thin_film {

/// Spectral response of the eye to cos(2π · path_nm / wavelength + shift), in Rec. 709. It is the Fourier transform of
/// Gaussian fits to the CIE 1931 curves, with constants from the authors' supplement ([Belcour17], eq. 10). X has a
/// second lobe.
RELUME_HD inline Rgb interference(float path_nm, const Rgb& shift) {
  const float phase = 2.0f * kPi * path_nm * 1e-9f;
  const auto lobe = [&](float value, float position, float variance, float offset) {
    return value * std::sqrt(2.0f * kPi * variance) * math::cos(position * phase + offset) *
           math::exp(-variance * phase * phase);
  };
  constexpr float kScale = 1.0f / 1.0685e-7f;
  const float x =
      kScale * (lobe(5.4856e-13f, 1.6810e6f, 4.3278e9f, shift.x) + lobe(9.7470e-14f, 2.2399e6f, 4.5282e9f, shift.x));
  const float y = kScale * lobe(4.4201e-13f, 1.7953e6f, 9.3046e9f, shift.y);
  const float z = kScale * lobe(5.2481e-13f, 2.2084e6f, 6.6121e9f, shift.z);
  return {3.2404542f * x - 1.5371385f * y - 0.4985314f * z, -0.9692660f * x + 1.8760108f * y + 0.0415560f * z,
          0.0556434f * x - 0.2040259f * y + 1.0572252f * z};
}

/// Thinner films fade out, because two orders of interference do not sum to the bare base.
inline constexpr float kFadingThickness = 0.03f;  // nm

/// Reflectance of film and base at `cos_theta` ≥ 0 in the air outside. Clamped to [0, 1]: the colour may leave the
/// gamut.
RELUME_HD inline Rgb covered_reflectance(float ior, float thickness_nm, const Rgb& base_f0, float cos_theta) {
  const float fade = saturate(thickness_nm / kFadingThickness);
  const float eta = lerp(1.0f, ior, fade * fade * (3.0f - 2.0f * fade));
  const float cos_inside = safe_sqrt(1.0f - (1.0f - cos_theta * cos_theta) / (eta * eta));
  const float top = eta > 1.0f ? fresnel_dielectric(cos_theta, eta) : 0.0f;
  const float through = 1.0f - top;
  Rgb base(0);
  Rgb shift(0);  // half a wave in total; a whole one over a base of lower index than the film
  for (int c = 0; c < 3; ++c) {
    const float root = std::sqrt(clamp(base_f0[c], 0.0f, 0.9999f));
    const float base_ior = (1.0f + root) / (1.0f - root);
    base[c] = fresnel_schlick(Rgb(f0_from_ior(base_ior / eta)), Rgb(1), cos_inside).x;
    shift[c] = kPi + (base_ior < eta ? kPi : 0.0f);
  }
  const float path_nm = 2.0f * eta * thickness_nm * cos_inside;
  const Rgb between = glm::clamp(top * base, Rgb(1e-5f), Rgb(0.9999f));
  const Rgb series = through * through * base / (Rgb(1) - between);
  Rgb sum = Rgb(top) + series;
  Rgb amplitude = series - Rgb(through);
  for (int order = 1; order <= 2; ++order) {
    amplitude *= glm::sqrt(between);
    const float m = static_cast<float>(order);
    sum += 2.0f * amplitude * interference(m * path_nm, m * shift);
  }
  return glm::clamp(sum, Rgb(0), Rgb(1));
}

}  // namespace thin_film

/// Reflectance at `cos_theta` ≥ 0 outside a surface that the film covers in part.
RELUME_HD_NOINLINE inline Rgb film_reflectance(const ThinFilm& film, FilmBase base, float cos_theta) {
  const bool metal = base == FilmBase::metal;
  const Rgb f0 = metal ? film.metal_f0 : film.dielectric_f0;
  const Rgb bare = fresnel_schlick(f0, Rgb(metal ? 1.0f : film.dielectric_f90), cos_theta);
  if (!(film.weight > 0.0f)) return bare;
  const Rgb covered = thin_film::covered_reflectance(film.ior, film.thickness_nm, f0, cos_theta);
  return bare + (covered - bare) * film.weight;
}

/// F0 of a Schlick curve with F90 = 1 that lies above film_reflectance(), or at most 2e-3 below it for films of up to
/// 2000 nm. Layers below the surface receive the light that this curve transmits.
RELUME_HD_NOINLINE inline Rgb film_f0_bound(const ThinFilm& film, FilmBase base) {
  constexpr int kAngles = 20;
  constexpr float kLowestCosine = 0.005f;
  constexpr float kMargin = 4e-3f;  // margin for peaks between the angles, beyond their parabolic fits
  Rgb bound(0);
  Rgb before(0);
  Rgb last(0);
  for (int i = 0; i < kAngles; ++i) {
    const float cos_theta = lerp(1.0f, kLowestCosine, static_cast<float>(i) / (kAngles - 1));
    const float grazing = pow5(1.0f - cos_theta);
    const Rgb now = (film_reflectance(film, base, cos_theta) - Rgb(grazing)) / (1.0f - grazing);
    bound = glm::max(bound, now);
    for (int c = 0; c < 3 && i >= 2; ++c) {
      const float bend = before[c] - 2.0f * last[c] + now[c];
      const bool peaks = last[c] >= before[c] && last[c] >= now[c] && bend < 0.0f;
      if (peaks) bound[c] = relume::max(bound[c], last[c] - sqr(before[c] - now[c]) / (8.0f * bend));
    }
    before = last;
    last = now;
  }
  return glm::min(bound + Rgb(kMargin), Rgb(1));
}

}  // namespace relume
