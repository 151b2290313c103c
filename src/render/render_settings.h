// All settings of a session's rendering, except the scene.
#pragma once

#include <cstdint>
#include <string>

#include "accel/accel_choice.h"
#include "materials/texture.h"
#include "relume/image.h"
#include "relume/settings.h"
#include "scene/shutter.h"
#include "settings/setting.h"
#include "techniques/denoise/asvgf/settings.h"
#include "techniques/denoise/bmfr/settings.h"
#include "techniques/denoise/firefly_clamp/settings.h"
#include "techniques/denoise/svgf/settings.h"
#include "techniques/gbuffer/features/settings.h"
#include "techniques/guiding/directional_quadtree/settings.h"
#include "techniques/guiding/markov_chain/settings.h"
#include "techniques/light_sampling/adaptive_tiles/settings.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/light_sampling/markov_chain_lights/settings.h"
#include "techniques/light_sampling/static_light_lists/settings.h"
#include "techniques/light_sampling/visibility_light_cache/settings.h"
#include "techniques/radiance_cache/adaptive_psf/settings.h"
#include "techniques/radiance_cache/path_graphs/settings.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/radiance_cache/sharc/settings.h"
#include "techniques/reuse/reservoir/settings.h"
#include "techniques/reuse/restir_di/settings.h"
#include "techniques/reuse/restir_gi/settings.h"
#include "techniques/reuse/restir_pt/settings.h"
#include "techniques/spatial/octree/settings.h"
#include "techniques/temporal/adaptive_sampling/settings.h"
#include "techniques/temporal/reprojection/settings.h"
#include "techniques/temporal/upscaling/settings.h"
#include "techniques/transport/bdpt/settings.h"
#include "techniques/transport/path/settings.h"
#include "techniques/transport/vcm/settings.h"

namespace relume {

inline constexpr float kLatestTime = 1e6f;  ///< latest animation time, seconds
/// Largest seed. Larger values are reserved for repetitions, which count up from it, and above 10^9 for references.
inline constexpr int kMostSeed = 900'000'000;

// The slots (docs/architecture.md): each enum lists the available choices.
enum class EstimatorChoice : int { path, bdpt, light, vcm };
enum class LightSelectionChoice : int { uniform, power, light_tree, static_lists, vlc, neeat, mcls };
enum class GuideChoice : int { bsdf, cdq, mcpg };
enum class ReuseChoice : int { none, ris, restir_di, restir_gi, restir_di_gi, restir_pt };
enum class CacheChoice : int { none, psf, apsf, apg, apsf_apg, sharc };
enum class AllocationChoice : int { uniform, adaptive };
enum class HistoryChoice : int { none, accumulate, reproject };
enum class DenoiseChoice : int { none, bmfr, svgf, asvgf, oidn };

/// Whether reservoirs resample the direct light of primary hits, and leave other light to paths or other reservoirs.
constexpr bool resamples_direct_light(ReuseChoice reuse) {
  return reuse == ReuseChoice::ris || reuse == ReuseChoice::restir_di || reuse == ReuseChoice::restir_di_gi;
}
/// Whether reservoirs resample the light that second vertices reflect.
constexpr bool resamples_indirect_light(ReuseChoice reuse) {
  return reuse == ReuseChoice::restir_gi || reuse == ReuseChoice::restir_di_gi;
}

/// Which samples of an image a session renders, and how it adds them up. Derived from the command, so not named
/// settings.
struct SampleSettings {
  bool sums = false;   ///< whether the image is the mean of exact sums, which do not depend on the order of samples
  bool part = false;   ///< whether the image is a part of one with more samples; needs `sums`
  uint32_t first = 0;  ///< index of the first sample, a multiple of kBlockSamples; needs `sums`

  friend bool operator==(const SampleSettings&, const SampleSettings&) = default;
};

struct RenderSettings {
  int width = 1280;
  int height = 720;
  int seed = 0;
  int threads = 0;              ///< 0: all cores
  bool scalar_kernels = false;  ///< whether the host runs the device form of kernels (KernelForm::device)
  std::string camera;           ///< name or index; empty: the file's first
  std::string animation;        ///< clips to play, as for select_animation(); empty: the file's first
  float time_s = 0;             ///< time of the animation
  float shutter_s = 0;          ///< exposure around `time_s`; 0: closed
  int shutter_keys = 9;         ///< poses within it
  bool stratify = true;
  bool dither = false;
  TextureFilter texture_filter = TextureFilter::linear;
  std::string device = "cpu";  ///< processor of kernels (cuda::parse_device()); a GPU uses AccelChoice::bvh
  AccelChoice accel = AccelChoice::embree;
  EstimatorChoice estimator = EstimatorChoice::path;
  LightSelectionChoice lights = LightSelectionChoice::power;
  GuideChoice guide = GuideChoice::bsdf;
  ReuseChoice reuse = ReuseChoice::none;
  CacheChoice cache = CacheChoice::none;
  AllocationChoice allocation = AllocationChoice::uniform;
  HistoryChoice history = HistoryChoice::accumulate;
  DenoiseChoice denoise = DenoiseChoice::none;
  /// Records albedo, normal, depth and motion of the first hit. Derived from the requested layers, so not a named
  /// setting.
  bool auxiliary = false;
  /// Keeps histories when `upscaling` changes between 1 and more. Derived from the viewer's frame rate, so not a named
  /// setting.
  bool switches_upscaling = false;
  /// Renders only these pixels, bit-identical to that part of the full image. Other pixels stay black.
  PixelWindow crop;
  SampleSettings samples;
  PathSettings path;
  LightSelectionSettings light_selection;
  OctreeSettings octree;
  VisibilityLightCacheSettings vlc;
  AdaptiveTilesSettings neeat;
  DirectionalQuadtreeSettings cdq;
  MarkovChainSettings mcpg;
  MarkovChainLightsSettings mcls;
  StaticLightListsSettings static_lists;
  RisSettings ris;
  RestirSettings restir;
  RestirGiSettings restir_gi;
  RestirPtSettings restir_pt;
  PathSpaceFilterSettings psf;
  AdaptivePsfSettings apsf;
  PathGraphSettings apg;
  SharcSettings sharc;
  AdaptiveSamplingSettings adaptive;
  UpscalingSettings upscaling;
  ReprojectionSettings reproject;
  BdptSettings bdpt;
  VcmSettings vcm;
  FireflySettings firefly;
  FeatureSettings features;
  BmfrSettings bmfr;
  SvgfSettings svgf;
  AsvgfSettings asvgf;

  Shutter shutter() const { return {shutter_s, shutter_keys}; }

  /// Converts to the public interface's settings; all other settings there have their defaults.
  operator Settings() const;  // NOLINT(google-explicit-constructor): the same settings
};

/// All of the above except `auxiliary`, `switches_upscaling`, `crop` and `samples`. `path.max_bounces` is named
/// "max-bounces", because it applies to every estimator.
SettingList describe(RenderSettings& settings);

/// Parts of describe(RenderSettings&), grouped for reference pages and widgets.
SettingList describe_image(RenderSettings& settings);
SettingList describe_slots(RenderSettings& settings);
SettingList describe_transport(RenderSettings& settings);
SettingList describe_caches(RenderSettings& settings);
SettingList describe_frames(RenderSettings& settings);
SettingList describe_denoisers(RenderSettings& settings);

}  // namespace relume
