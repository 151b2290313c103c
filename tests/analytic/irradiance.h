// Tests irradiance with every unbiased technique.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <utility>

#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {

/// An unbiased technique.
struct Way {
  const char* name;
  EstimatorChoice estimator = EstimatorChoice::path;
  LightSelectionChoice lights = LightSelectionChoice::power;
  GuideChoice guide = GuideChoice::bsdf;
  double noise = 1;      ///< factor of tolerances; above 1 without low-discrepancy sequences (adaptation, exploration)
  bool departs = false;  ///< all learning settings differ from their defaults
  ReuseChoice reuse = ReuseChoice::none;
};

inline const Way kUniform{"uniform", EstimatorChoice::path, LightSelectionChoice::uniform};
inline const Way kPower{"power"};
inline const Way kLightTree{"light_tree", EstimatorChoice::path, LightSelectionChoice::light_tree};
inline const Way kLists{"lists", EstimatorChoice::path, LightSelectionChoice::static_lists, GuideChoice::bsdf, 2};
inline const Way kNeeat{"neeat", EstimatorChoice::path, LightSelectionChoice::neeat, GuideChoice::bsdf, 8};
inline const Way kVlcCdq{"vlc_cdq", EstimatorChoice::path, LightSelectionChoice::vlc, GuideChoice::cdq, 8};
inline const Way kBdpt{"bdpt", EstimatorChoice::bdpt};
inline const Way kDeparts{"departures", EstimatorChoice::path, LightSelectionChoice::vlc, GuideChoice::cdq, 10, true};

inline const auto kWays = ::testing::Values(kUniform, kPower, kLightTree, kLists, kNeeat, kVlcCdq, kBdpt);

/// Parts of pairs above, and other pairs. Images of learned techniques have the departures in the quick tests.
inline const auto kOtherWays = ::testing::Values(
    kDeparts, Way{"vlc", EstimatorChoice::path, LightSelectionChoice::vlc, GuideChoice::bsdf, 8},
    Way{"cdq", EstimatorChoice::path, LightSelectionChoice::power, GuideChoice::cdq, 8},
    Way{"bdpt_lists", EstimatorChoice::bdpt, LightSelectionChoice::static_lists, GuideChoice::bsdf, 2},
    Way{"light_tree_cdq", EstimatorChoice::path, LightSelectionChoice::light_tree, GuideChoice::cdq, 8},
    Way{"bdpt_light_tree", EstimatorChoice::bdpt, LightSelectionChoice::light_tree},
    Way{"bdpt_neeat", EstimatorChoice::bdpt, LightSelectionChoice::neeat, GuideChoice::bsdf, 8},
    Way{"bdpt_vlc_cdq", EstimatorChoice::bdpt, LightSelectionChoice::vlc, GuideChoice::cdq, 8},
    Way{"ris", EstimatorChoice::path, LightSelectionChoice::power, GuideChoice::bsdf, 2, false, ReuseChoice::ris},
    Way{"ris_vlc_cdq", EstimatorChoice::path, LightSelectionChoice::vlc, GuideChoice::cdq, 8, false, ReuseChoice::ris},
    Way{"restir_di", EstimatorChoice::path, LightSelectionChoice::light_tree, GuideChoice::bsdf, 8, false,
        ReuseChoice::restir_di},
    Way{"restir_gi", EstimatorChoice::path, LightSelectionChoice::power, GuideChoice::bsdf, 16, false,
        ReuseChoice::restir_gi},
    Way{"restir_di_gi", EstimatorChoice::path, LightSelectionChoice::light_tree, GuideChoice::bsdf, 16, false,
        ReuseChoice::restir_di_gi},
    Way{"restir_pt", EstimatorChoice::path, LightSelectionChoice::power, GuideChoice::bsdf, 16, false,
        ReuseChoice::restir_pt},
    Way{"mcpg", EstimatorChoice::path, LightSelectionChoice::power, GuideChoice::mcpg, 8},
    Way{"mcls_mcpg", EstimatorChoice::path, LightSelectionChoice::mcls, GuideChoice::mcpg, 8});

/// For scenes in which the selection of lights does not matter, and the others of kWays.
inline const auto kWaysOfOneLight = ::testing::Values(kPower, kVlcCdq, kBdpt);
inline const auto kOtherSelections = ::testing::Values(kUniform, kLightTree, kLists, kNeeat);

inline void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }
inline std::string way_name(const ::testing::TestParamInfo<Way>& info) { return info.param.name; }

/// Applies the technique with settings that give small images many regions.
inline void take(const Way& way, RenderSettings& settings) {
  settings.estimator = way.estimator;
  settings.lights = way.lights;
  settings.guide = way.guide;
  settings.reuse = way.reuse;
  settings.octree = {.collapse = 32, .split = 64, .scale = false};
  settings.static_lists.rays = 64;
  if (!way.departs) return;
  settings.octree.vertices = 4;
  settings.octree.jitter = 1;
  settings.vlc.memory = 0;
  settings.vlc.bucket_size = 4;  // several buckets per region
  settings.cdq.bits = QuadtreeBits::b64;
  settings.cdq.migrations = 4;
  settings.cdq.memory = 8;
  settings.cdq.spread = 1;
  settings.cdq.sampling = QuadtreeSampling::stratified;
}

class WayTest : public ::testing::TestWithParam<Way> {
 protected:
  /// Whether tolerances are wide, because samples are independent.
  static bool is_wide() { return GetParam().noise >= 8; }

  /// Mean of `spp` samples per pixel. Of independent samples, only their number counts: wide ways render a quarter of
  /// the frames with four times the pixels, since adaptation after each frame takes longer than a small image.
  static Estimate estimated(Scene scene, RenderSettings settings, int spp) {
    if (is_wide()) {
      settings.width *= 2;
      settings.height *= 2;
      spp = std::max(spp / 4, 1);
    }
    return estimate_of(render(std::move(scene), settings, spp));
  }

  static void expect_near(const Estimate& estimate, const Rgb& expected, double tolerance) {
    support::expect_near(estimate, expected, tolerance * GetParam().noise);
  }
};

/// Samples per pixel where the tolerance is 0.2 %, and where it is at least eight times as wide.
struct Samples {
  int sharp = 0;
  int wide = 0;
};

class IrradianceTest : public WayTest {
 protected:
  /// For one uniform lamp. 1,024 samples suffice for a standard deviation of twice the mean.
  static constexpr Samples kOneLamp{2048, 1024};

  /// Expects the white patch of an irradiance_meter() to have this irradiance from direct light, in W/m², within 0.2 %
  /// times the technique's noise.
  void expect_irradiance(Scene scene, const Rgb& expected, const Samples& spp) const {
    RenderSettings settings = small_settings(12, 12);
    take(GetParam(), settings);
    settings.path.max_bounces = 1;
    Estimate e = estimated(std::move(scene), settings, samples(spp));
    e.mean *= kPi;
    e.standard_error *= kPi;
    expect_near(e, expected, 0.002);
  }
  void expect_irradiance(Scene scene, const Rgb& expected, int spp = 2048) const {
    constexpr int kMostIfWide = 2560;  // enough for the largest deviation in any scene
    expect_irradiance(std::move(scene), expected, Samples{spp, std::min(spp, kMostIfWide)});
  }

  /// Expects no light at all. A single wrong one of 37,000 samples would show.
  void expect_black(Scene scene) const { expect_irradiance(std::move(scene), Rgb(0), 256); }

 private:
  /// Per pixel of an image of 12 × 12 pixels.
  static int samples(const Samples& spp) {
    if (is_wide()) return spp.wide;
    // Twice the tolerance needs a quarter of the samples if they are independent. Half leaves a margin for correlation.
    return GetParam().noise >= 2 && spp.sharp > 4096 ? spp.sharp / 2 : spp.sharp;
  }
};

}  // namespace relume::support
