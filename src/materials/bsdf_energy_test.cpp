// White furnaces: the light returned by a surface under uniform illumination.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "materials/testing/furnace.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::albedo_by_quadrature;
using testing::albedo_by_sampling;
using testing::BsdfCase;
using testing::MaterialCase;
using testing::Mean;
using testing::Random;
using testing::white;

constexpr double kWhite = 1e-3;  // tolerance of a white furnace
const std::vector<float> kRoughness{0.05f, 0.1f, 0.2f, 0.35f, 0.5f, 0.75f, 1.0f};
const std::vector<float> kCosines{1.0f, 0.8f, 0.5f, 0.25f, 0.1f, 0.03f};

TEST(BsdfEnergy, LambertIsWhite) {
  MaterialCase lambert = white("lambert", 0, 0, false);
  lambert.sample.specular = 0;
  for (const float cos_o : kCosines) {
    const BsdfCase c = testing::full_material(lambert, 1, MicrofacetModel::ggx);
    EXPECT_NEAR(albedo_by_quadrature(c, cos_o), 1.0, kWhite);
    EXPECT_NEAR(albedo_by_sampling(c, cos_o, 1000).value, 1.0, 1e-5);  // each weight is 1
  }
}

TEST(BsdfEnergy, CompensatedMetalIsWhite) {
  for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann}) {
    for (const float r : kRoughness) {
      const BsdfCase c = testing::full_material(white("metal", 1, 0, false), r, model);
      for (const float cos_o : kCosines)
        EXPECT_NEAR(albedo_by_quadrature(c, cos_o), 1.0, kWhite) << c.name << ", cos " << cos_o;
    }
  }
}

TEST(BsdfEnergy, SmoothMetalAndGlassLoseNothing) {
  for (const float cos_o : {1.0f, 0.5f, 0.05f, 0.002f}) {
    const BsdfCase metal = testing::full_material(white("mirror", 1, 0, false), 0, MicrofacetModel::ggx);
    EXPECT_NEAR(albedo_by_sampling(metal, cos_o, 100).value, 1.0, 1e-5);
    const BsdfCase glass = testing::full_material(white("glass", 0, 1, true), 0, MicrofacetModel::ggx);
    EXPECT_NEAR(albedo_by_sampling(glass, cos_o, 100).value, 1.0, 1e-5);
    const BsdfCase wall = testing::full_material(white("thin wall", 0, 1, false), 0, MicrofacetModel::ggx);
    const Mean m = albedo_by_sampling(wall, cos_o, 100000);
    EXPECT_NEAR(m.value, 1.0, 1e-4 + 5 * m.error) << cos_o;
  }
}

/// Mean weight of samples of delta lobes, per side.
struct Shares {
  Rgb reflected{0};
  Rgb transmitted{0};
};

Shares shares_by_sampling(const Bsdf& bsdf, const Vec3& wo, int samples) {
  Random random(43);
  Shares sum;
  for (int i = 0; i < samples; ++i) {
    const float u_lobe = random.next();
    const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d(), TransportMode::importance);
    EXPECT_TRUE(s.valid && s.delta);
    (s.transmitted() ? sum.transmitted : sum.reflected) += s.weight / static_cast<float>(samples);
  }
  return sum;
}

TEST(BsdfEnergy, SmoothInterfacesShareLightAsFresnelSays) {
  const Rgb gold(1.0f, 0.77f, 0.34f);
  MaterialCase metal = white("metal", 1, 0, false);
  metal.sample.base_color = gold;
  MaterialCase gilded = white("gilded glass", 0, 1, true);  // F0 of 0.4, 0.3, 0.14 and F90 of 0.5
  gilded.sample.specular = 0.5f;
  gilded.sample.specular_color = Rgb(20, 15, 7);
  MaterialCase dull = white("glass without reflections", 0, 1, true);
  dull.sample.specular = 0;
  for (const float cos_o : {1.0f, 0.6f, 0.2f}) {
    const float exact = fresnel_dielectric(cos_o, 1.5f);
    const float wall = 0.04f + 0.96f * pow5(1 - cos_o);
    const Rgb f0 = 0.04f * 0.5f * Rgb(20, 15, 7);
    const std::pair<MaterialCase, Rgb> expected[] = {{metal, gold + (Rgb(1) - gold) * pow5(1 - cos_o)},
                                                     {white("glass", 0, 1, true), Rgb(exact)},
                                                     {white("thin wall", 0, 1, false), Rgb(wall)},
                                                     {gilded, f0 + (Rgb(0.5f) - f0) * ((exact - 0.04f) / 0.96f)},
                                                     {dull, Rgb(0)}};
    for (const auto& [material, reflected] : expected) {
      const Bsdf bsdf = testing::full_material(material, 0, MicrofacetModel::ggx).make(cos_o, true);
      const Shares shares = shares_by_sampling(bsdf, testing::viewer(cos_o), 100000);
      const Rgb transmitted = material.sample.transmission > 0 ? Rgb(1) - reflected : Rgb(0);
      EXPECT_LT(max_component(abs(shares.reflected - reflected)), 0.01f) << material.name << ", cos " << cos_o;
      EXPECT_LT(max_component(abs(shares.transmitted - transmitted)), 0.01f) << material.name << ", cos " << cos_o;
    }
  }
}

TEST(BsdfEnergy, MediaThatDoNotRefractLetLightPass) {
  for (const float r : {0.0f, 0.3f, 1.0f}) {
    MaterialCase air = white("air", 0, 1, true);
    air.ior = 1;
    air.sample.base_color = Rgb(0.2f, 0.4f, 0.9f);
    const Vec3 wo = testing::viewer(0.4f);
    const Bsdf bsdf = testing::full_material(air, r, MicrofacetModel::ggx).make(wo.z, true);
    const BsdfSample s = sample(bsdf, wo, 0.5f, {0.3f, 0.7f});
    ASSERT_TRUE(s.valid) << r;
    EXPECT_LT(glm::length(s.wi + wo), 1e-5f) << r;
    EXPECT_LT(max_component(abs(s.weight - air.sample.base_color)), 1e-5f) << r;
  }
}

TEST(BsdfEnergy, LayersBelowAPerfectMirrorAreInvisible) {
  MaterialCase mirror = white("mirror over a diffuse base", 0, 0, false);
  mirror.sample.specular_color = Rgb(25);
  for (const float r : {0.01f, 0.2f}) {
    const Bsdf bsdf = testing::full_material(mirror, r, MicrofacetModel::ggx).make(0.6f, true);
    const BsdfEval e = eval_pdf(bsdf, testing::viewer(0.6f), testing::viewer(0.3f));
    EXPECT_TRUE(is_finite(e.f)) << r;
    EXPECT_LT(max_component(e.f), r < 0.1f ? 1e-5f : 1.0f) << r;
  }
}

TEST(BsdfEnergy, RadianceIsCompressedOnTheWayInAndSpreadOnTheWayOut) {
  const BsdfCase glass = testing::full_material(white("glass", 0, 1, true), 0, MicrofacetModel::ggx);
  Random random(42);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 wo = testing::viewer(0.6f);
    const BsdfSample in = sample(glass.make(wo.z, true), wo, random.next(), {});
    if (!in.transmitted()) continue;
    EXPECT_NEAR(in.weight.x, 1.0f / sqr(1.5f), 1e-5f);
    const Vec3 inside = -in.wi;
    const BsdfSample out = sample(glass.make(std::fabs(inside.z), false), Vec3(inside.x, inside.y, std::fabs(inside.z)),
                                  kOneMinusEpsilon, {});
    ASSERT_TRUE(out.transmitted());
    EXPECT_NEAR(in.weight.x * out.weight.x, 1.0f, 1e-5f);
  }
}

TEST(BsdfEnergy, NothingCreatesLight) {
  std::vector<BsdfCase> cases;
  for (MaterialCase m : testing::material_list()) {
    m.sample.base_color = Rgb(1);
    m.sample.specular_color = Rgb(1);
    for (const float r : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
      for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann})
        cases.push_back(testing::full_material(m, r, model));
    }
  }
  for (const BsdfCase& c : cases) {
    for (const float cos_o : {1.0f, 0.5f, 0.1f, 0.03f}) {
      const Mean m = albedo_by_sampling(c, cos_o, 4000);
      EXPECT_LT(m.value, 1.0 + kWhite + 5 * m.error) << c.name << ", cos " << cos_o;
    }
  }
}

TEST(BsdfEnergy, SamplingAndQuadratureAgree) {
  for (const MaterialCase& m : {white("metal", 1, 0, false), white("plastic", 0, 0, false), white("glass", 0, 1, true),
                                white("wall", 0, 1, false)}) {
    for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann}) {
      for (const float cos_o : {0.9f, 0.2f}) {
        const BsdfCase c = testing::full_material(m, 0.4f, model);
        const Mean mean = albedo_by_sampling(c, cos_o, 100000);
        EXPECT_NEAR(mean.value, albedo_by_quadrature(c, cos_o), 5 * mean.error + 3e-4) << c.name << ", cos " << cos_o;
      }
    }
  }
}

TEST(BsdfEnergy, AlbedoMatchesReflectedEnergy) {
  // The sum used by sampling and demodulation; exact for opaque materials.
  for (const MaterialCase& m :
       {white("metal", 1, 0, false), white("plastic", 0, 0, false), white("half metal", 0.5f, 0, false)}) {
    for (const float r : kRoughness) {
      for (const float cos_o : kCosines) {
        const BsdfCase c = testing::full_material(m, r, MicrofacetModel::ggx);
        EXPECT_NEAR(max_component(albedo(c.make(cos_o, true), cos_o)), albedo_by_quadrature(c, cos_o), kWhite)
            << c.name << ", cos " << cos_o;
      }
    }
  }
}

/// Losses in percent, by row, from the table of docs/materials.md below `title`.
std::vector<std::vector<double>> documented_losses(const std::string& title) {
  std::ifstream page(RELUME_SOURCE_DIR "/docs/materials.md");
  std::string line;
  while (std::getline(page, line) && line.find("**" + title + "**") == std::string::npos) {
  }
  std::vector<std::vector<double>> rows;
  while (std::getline(page, line) && line.find("**") == std::string::npos) {
    if (line.empty() || line[0] != '|' || !std::isdigit(static_cast<unsigned char>(line[2]))) continue;
    std::replace(line.begin(), line.end(), '|', ' ');
    std::istringstream cells(line);
    const std::vector<double> row(std::istream_iterator<double>(cells), std::istream_iterator<double>{});
    rows.emplace_back(row.begin() + 1, row.end());  // drops the roughness
  }
  return rows;
}

/// Prints a table of losses and expects equality with docs/materials.md.
void expect_documented_losses(const std::string& title, const MaterialCase& m) {
  const std::vector<std::vector<double>> documented = documented_losses(title);
  ASSERT_EQ(documented.size(), kRoughness.size()) << title;
  std::printf("%s\n| roughness |", title.c_str());
  for (const float cos_o : kCosines) std::printf(" cos θ = %.2f |", static_cast<double>(cos_o));
  std::printf("\n");
  for (size_t row = 0; row < documented.size(); ++row) {
    ASSERT_EQ(documented[row].size(), kCosines.size()) << title;
    std::printf("| %.2f |", static_cast<double>(kRoughness[row]));
    for (size_t column = 0; column < documented[row].size(); ++column) {
      const BsdfCase c = testing::full_material(m, kRoughness[row], MicrofacetModel::ggx);
      const double loss = 100.0 * (1.0 - albedo_by_quadrature(c, kCosines[column]));
      std::printf(" %.2f |", loss);
      EXPECT_GT(loss, -100.0 * kWhite) << c.name << ", cos " << kCosines[column];
      EXPECT_NEAR(loss, documented[row][column], 0.02) << c.name << ", cos " << kCosines[column];
    }
    std::printf("\n");
  }
}

TEST(BsdfEnergy, LossTable) {
  expect_documented_losses("Dielectric over a diffuse base",
                           white("dielectric over a white diffuse base", 0, 0, false));
  expect_documented_losses("Rough glass", white("rough glass", 0, 1, true));
  expect_documented_losses("Rough thin wall.", white("rough thin wall", 0, 1, false));
}

TEST(BsdfEnergy, BlackSurfacesReflectNothing) {
  MaterialCase m = white("black", 0, 0, false);
  m.sample.base_color = Rgb(0);
  m.sample.specular = 0;
  const Bsdf bsdf = testing::full_material(m, 0.5f, MicrofacetModel::ggx).make(0.5f, true);
  EXPECT_TRUE(bsdf.empty());
  EXPECT_FALSE(sample(bsdf, testing::viewer(0.5f), 0.5f, {0.5f, 0.5f}).valid);
}

}  // namespace
}  // namespace relume
