#include "materials/thin_film.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

ThinFilm film_over(const Rgb& f0, float ior, float thickness_nm) { return {1, ior, thickness_nm, f0, 1, f0}; }

TEST(ThinFilm, VanishesWithItsThickness) {
  for (const float base : {0.04f, 0.3f, 0.9f}) {
    for (const float cos_theta : {1.0f, 0.6f, 0.2f}) {
      const Rgb bare = fresnel_schlick(Rgb(base), Rgb(1), cos_theta);
      const Rgb covered = film_reflectance(film_over(Rgb(base), 1.5f, 0), FilmBase::dielectric, cos_theta);
      EXPECT_LT(max_component(abs(covered - bare)), 0.01f) << base << ", cos " << cos_theta;
    }
  }
}

TEST(ThinFilm, WithoutWeightIsTheBase) {
  ThinFilm film = film_over(Rgb(0.1f, 0.4f, 0.7f), 1.4f, 300);
  film.weight = 0;
  EXPECT_EQ(film_reflectance(film, FilmBase::metal, 0.7f), fresnel_schlick(film.metal_f0, Rgb(1), 0.7f));
}

/// A film with the index of its base changes nothing at any thickness: R = R12 at its top, 0 at its bottom.
TEST(ThinFilm, OfTheSameIndexAsItsBaseReflectsAtItsTopOnly) {
  const float ior = 1.5f;
  for (const float thickness : {50.0f, 300.0f, 900.0f}) {
    for (const float cos_theta : {1.0f, 0.8f, 0.6f}) {
      const Rgb r = film_reflectance(film_over(Rgb(f0_from_ior(ior)), ior, thickness), FilmBase::dielectric, cos_theta);
      // The difference is Schlick's curve inside the film, which has angles up to 41° only.
      EXPECT_NEAR(r.y, fresnel_dielectric(cos_theta, ior), 0.02f) << thickness << ", cos " << cos_theta;
    }
  }
}

/// Where wavelengths average out, the energies of the two reflections add up: R12 + T12² R23 / (1 − R12 R23).
TEST(ThinFilm, OfGreatThicknessHasNoColor) {
  const Rgb base(0.3f);
  const Rgb r = film_reflectance(film_over(base, 1.5f, 50000), FilmBase::metal, 1);
  const float top = f0_from_ior(1.5f);
  const float root = std::sqrt(0.3f);
  const float bottom = f0_from_ior((1 + root) / (1 - root) / 1.5f);
  const float expected = top + (1 - top) * (1 - top) * bottom / (1 - top * bottom);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(r[c], expected, 1e-3f);
}

/// At normal incidence, a film of index n over n² darkens at a thickness of a quarter wave ([Belcour17], §2).
TEST(ThinFilm, OfAQuarterWaveDarkens) {
  const float ior = 1.3f;
  const Rgb base(f0_from_ior(ior * ior));
  const float quarter_nm = 550 / (4 * ior);
  const Rgb dark = film_reflectance(film_over(base, ior, quarter_nm), FilmBase::dielectric, 1);
  const Rgb bright = film_reflectance(film_over(base, ior, 2 * quarter_nm), FilmBase::dielectric, 1);
  EXPECT_LT(dark.y, 0.15f * base.y);
  EXPECT_GT(bright.y, 0.7f * base.y);
}

TEST(ThinFilm, StaysBelowItsBound) {
  constexpr float kTolerance = 2e-3f;  // bound stated by film_f0_bound()
  for (const float base : {0.0f, 0.04f, 0.2f, 0.5f, 1.0f}) {
    for (const float ior : {1.0f, 1.05f, 1.3f, 1.8f, 2.5f}) {
      for (const float thickness : {0.0f, 5.0f, 80.0f, 120.0f, 350.0f, 700.0f, 960.0f, 1200.0f, 2000.0f}) {
        const ThinFilm film = film_over(Rgb(base, 0.5f * base, 0.1f), ior, thickness);
        const Rgb bound = film_f0_bound(film, FilmBase::dielectric);
        for (float cos_theta = 0.01f; cos_theta <= 1.0f; cos_theta += 0.01f) {
          const Rgb r = film_reflectance(film, FilmBase::dielectric, cos_theta);
          ASSERT_GE(min_component(r), 0.0f);
          ASSERT_LE(max_component(r), 1.0f);
          const Rgb above = fresnel_schlick(bound, Rgb(1), cos_theta);
          ASSERT_LT(max_component(r - above), kTolerance)
              << base << ", ior " << ior << ", nm " << thickness << ", cos " << cos_theta;
        }
      }
    }
  }
}

/// The bound is also tight where its curve touches the reflectance.
TEST(ThinFilm, HasATightBound) {
  for (const float thickness : {80.0f, 350.0f, 960.0f}) {
    const ThinFilm film = film_over(Rgb(0.04f), 1.3f, thickness);
    const Rgb bound = film_f0_bound(film, FilmBase::dielectric);
    Rgb least(1);
    for (float cos_theta = 0.01f; cos_theta <= 1.0f; cos_theta += 0.005f) {
      const Rgb above = fresnel_schlick(bound, Rgb(1), cos_theta);
      least = glm::min(least, above - film_reflectance(film, FilmBase::dielectric, cos_theta));
    }
    EXPECT_LT(max_component(least), 0.01f) << thickness;
  }
}

}  // namespace
}  // namespace relume
