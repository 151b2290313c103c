// White furnaces of the layers from make_layered_bsdf.h.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "materials/testing/furnace.h"

namespace relume {
namespace {

using testing::albedo_by_quadrature;
using testing::albedo_by_sampling;
using testing::BsdfCase;
using testing::largest_albedo_by_sampling;
using testing::MaterialCase;
using testing::Mean;
using testing::Random;
using testing::white;

constexpr double kWhite = 1e-3;             // tolerance of a white furnace
constexpr double kAnisotropicError = 0.03;  // tolerance with the tables of anisotropic surfaces
const std::vector<float> kRoughness{0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.75f, 1.0f};
const std::vector<float> kCosines{1.0f, 0.8f, 0.5f, 0.25f, 0.1f, 0.03f};

TEST(LayeredEnergy, NoLayerCreatesLight) {
  for (MaterialCase m : testing::layered_material_list()) {
    m.sample.base_color = Rgb(1);
    m.sample.specular_color = Rgb(1);
    m.layers->diffuse_transmission_color = Rgb(1);
    if (!is_black(m.layers->sheen_color)) m.layers->sheen_color = Rgb(1);
    const double tolerance = m.layers->anisotropy > 0.0f ? kAnisotropicError : kWhite;
    for (const float r : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
      const BsdfCase c = testing::full_material(m, r, MicrofacetModel::ggx);
      for (const float cos_o : {1.0f, 0.5f, 0.1f, 0.03f}) {
        const Mean mean = largest_albedo_by_sampling(c, cos_o, 4000);
        EXPECT_LT(mean.value, 1.0 + tolerance + 5 * mean.error) << c.name << ", cos " << cos_o;
      }
    }
  }
}

/// Tests the bound of AnisotropicEnergyTable from both sides. Returns the mean error.
double expect_nearly_white_metal(const std::vector<float>& strengths) {
  double sum = 0;
  int count = 0;
  for (const float strength : strengths) {
    for (const float angle : {0.0f, 0.5f, 1.2f, 1.5f}) {
      MaterialCase metal = white("anisotropic metal", 1, 0, false);
      metal.layers.emplace();
      metal.layers->anisotropy = strength;
      metal.layers->anisotropy_direction = {std::cos(angle), std::sin(angle)};
      for (const float r : kRoughness) {
        const BsdfCase c = testing::full_material(metal, r, MicrofacetModel::ggx);
        for (const float cos_o : kCosines) {
          const Mean mean = albedo_by_sampling(c, cos_o, 20000);
          EXPECT_NEAR(mean.value, 1.0, kAnisotropicError + 5 * mean.error)
              << c.name << ", strength " << strength << ", angle " << angle << ", cos " << cos_o;
          sum += std::fabs(mean.value - 1.0);
          ++count;
        }
      }
    }
  }
  return sum / count;
}
TEST(LayeredEnergy, AnisotropicMetalIsNearlyWhite) { expect_nearly_white_metal({0.5f, 1.0f}); }
TEST(SlowLayeredEnergy, AnisotropicMetalIsNearlyWhite) {
  EXPECT_LT(expect_nearly_white_metal({0.2f, 0.5f, 0.8f, 1.0f}), 0.01);
}

/// Cloth over a white base never returns more than all light, and loses little where the fibres absorb little.
TEST(LayeredEnergy, SheenOverAWhiteBaseCreatesNoEnergy) {
  for (const float sheen_roughness : {0.1f, 0.3f, 0.6f, 1.0f}) {
    MaterialCase cloth = white("cloth", 0, 0, false);
    cloth.sample.specular = 0;
    cloth.layers.emplace();
    cloth.layers->sheen_roughness = sheen_roughness;
    for (const float color : {0.3f, 1.0f}) {
      cloth.layers->sheen_color = Rgb(color);
      const BsdfCase c = testing::full_material(cloth, 1, MicrofacetModel::ggx);
      for (const float cos_o : kCosines) {
        const double albedo = albedo_by_quadrature(c, cos_o);
        EXPECT_LT(albedo, 1.0 + 5e-3) << sheen_roughness << ", cos " << cos_o;
        EXPECT_GT(albedo, 1.0 - 0.6 * color) << sheen_roughness << ", cos " << cos_o;
      }
    }
  }
}

TEST(LayeredEnergy, DiffuseTransmissionSharesDiffuseLight) {
  MaterialCase sheet = white("sheet", 0, 0, false);
  sheet.sample.specular = 0;
  sheet.layers.emplace();
  sheet.layers->diffuse_transmission = 0.25f;
  const Bsdf bsdf = testing::full_material(sheet, 1, MicrofacetModel::ggx).make(0.6f, true);
  const Vec3 wo = testing::viewer(0.6f);
  const Vec3 wi = testing::viewer(0.3f);
  EXPECT_NEAR(eval_pdf(bsdf, wo, wi).f.x, 0.75f * kInvPi, 1e-5f);
  EXPECT_NEAR(eval_pdf(bsdf, wo, -wi).f.x, 0.25f * kInvPi, 1e-5f);
}

/// Light that enters a medium diffusely and leaves it by refraction has the factors 1/η² and η², at any wavelength.
TEST(LayeredEnergy, DiffuseTransmissionScalesLikeRefraction) {
  MaterialCase m = white("diffusely transmitting glass", 0, 0.5f, true);
  m.layers.emplace();
  m.layers->diffuse_transmission = 1;
  for (const auto& [front_face, dispersion] : {std::pair(true, 0.0f), {false, 0.0f}, {true, 1.0f}, {false, 1.0f}}) {
    m.dispersion = dispersion;
    m.wavelength_nm = dispersion > 0.0f ? kShortestWavelength : kNoWavelength;
    const float eta = index_at(m.ior, dispersion, m.wavelength_nm);
    const Bsdf bsdf = testing::full_material(m, 0, MicrofacetModel::ggx).make(0.6f, front_face);
    const float expected = front_face ? 1 / sqr(eta) : sqr(eta);
    EXPECT_FLOAT_EQ(refraction_eta_scale(bsdf), expected);
    const Vec3 wo = testing::viewer(0.6f);
    const Vec3 wi = -testing::viewer(0.3f);
    EXPECT_NEAR(eval_pdf(bsdf, wo, wi).f.x, expected * eval_pdf(bsdf, wo, wi, TransportMode::importance).f.x, 1e-5f);
    Random random(46);
    for (int i = 0; i < 200; ++i) {
      const float u_lobe = random.next();
      const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d());
      if (!s.valid || !s.transmitted()) continue;
      EXPECT_FLOAT_EQ(s.eta_scale, expected);
    }
  }
}

/// From inside a medium, light that does not pass is reflected.
TEST(LayeredEnergy, DiffuseTransmissionOutOfAMediumLosesNothing) {
  MaterialCase m = white("medium", 0, 0, true);
  m.sample.specular = 0;
  m.layers.emplace();
  m.layers->diffuse_transmission = 1;
  for (const bool front_face : {true, false}) {
    const Bsdf bsdf = testing::full_material(m, 1, MicrofacetModel::ggx).make(0.6f, front_face);
    const Vec3 wo = testing::viewer(0.6f);
    const Vec3 wi = testing::viewer(0.3f);
    const float reflected = eval_pdf(bsdf, wo, wi, TransportMode::importance).f.x;
    const float passed = eval_pdf(bsdf, wo, -wi, TransportMode::importance).f.x;
    EXPECT_NEAR(reflected + passed, kInvPi, 1e-5f);
    EXPECT_NEAR(passed, front_face ? kInvPi : kInvPi / sqr(m.ior), 1e-5f);
  }
}

TEST(LayeredEnergy, ACoatWithTheNormalOfItsBaseIsTheCoat) {
  MaterialCase coated = white("coated", 0.5f, 0, false);
  coated.sample.clearcoat = 1;
  for (const float coat_roughness : {0.0f, 0.4f}) {
    coated.sample.clearcoat_roughness = coat_roughness;
    coated.layers.reset();
    const Bsdf flat = testing::full_material(coated, 0.5f, MicrofacetModel::ggx).make(0.6f, true);
    coated.layers.emplace();
    coated.layers->coat_has_normal = true;
    const Bsdf own_normal = testing::full_material(coated, 0.5f, MicrofacetModel::ggx).make(0.6f, true);
    const Vec3 wo = testing::viewer(0.6f);
    Random random(44);
    for (int i = 0; i < 100; ++i) {
      Vec3 wi = random.direction();
      wi.z = std::fabs(wi.z);
      const Rgb a = eval_pdf(flat, wo, wi).f;
      EXPECT_LT(max_component(abs(a - eval_pdf(own_normal, wo, wi).f)), 1e-4f * (1 + max_component(a)));
    }
  }
}

}  // namespace
}  // namespace relume
