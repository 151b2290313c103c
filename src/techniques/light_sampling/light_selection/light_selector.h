// Selects the light for next event estimation: a switch over a closed list. A new strategy adds a member, a kind and a
// case.
#pragma once

#include "scene/surface_point.h"
#include "techniques/light_sampling/adaptive_tiles/adaptive_tiles.h"
#include "techniques/light_sampling/light_selection/light_selection.h"
#include "techniques/light_sampling/light_tree/light_tree.h"
#include "techniques/light_sampling/markov_chain_lights/light_chain.h"
#include "techniques/light_sampling/power_lights/power_lights.h"
#include "techniques/light_sampling/static_light_lists/static_light_lists.h"
#include "techniques/light_sampling/uniform_lights/uniform_lights.h"
#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"

namespace relume {

enum class LightSelectorKind : int { uniform, power, light_tree, static_lists, cache, adaptive_tiles, markov_chains };
inline constexpr int kLightSelectorKindCount = 7;

struct LightSelector {
  LightSelectorKind kind = LightSelectorKind::power;
  UniformLights uniform;
  PowerLights power;
  LightTree tree;
  StaticLightLists lists;
  VisibilityLightCache cache;
  AdaptiveTiles tiles;
  MarkovChainLights chains;  ///< mixed with `tree`

  /// Samples a light for the point `sp`; pmf 0 if none can be chosen.
  RELUME_HD LightSelection sample(const SurfacePoint& sp, ReusableNumber n) const {
    switch (kind) {
      case LightSelectorKind::uniform: return uniform.sample(n);
      case LightSelectorKind::power: return power.sample(n);
      case LightSelectorKind::light_tree: return tree.sample(sp, n);
      case LightSelectorKind::static_lists: return lists.sample(sp, n);
      case LightSelectorKind::cache: return cache.sample(sp, n);
      case LightSelectorKind::adaptive_tiles: return tiles.sample(sp, n.u, n.bits);
      case LightSelectorKind::markov_chains: return chains.sample(tree, sp, n.u, n.bits);
    }
    return {};
  }

  /// Probability that sample() chooses `light` at `sp`.
  RELUME_HD float pmf(const SurfacePoint& sp, LightId light) const {
    switch (kind) {
      case LightSelectorKind::uniform: return uniform.pmf(light);
      case LightSelectorKind::power: return power.pmf(light);
      case LightSelectorKind::light_tree: return tree.pmf(sp, light);
      case LightSelectorKind::static_lists: return lists.pmf(sp, light);
      case LightSelectorKind::cache: return cache.pmf(sp, light);
      case LightSelectorKind::adaptive_tiles: return tiles.pmf(sp, light);
      case LightSelectorKind::markov_chains: return chains.pmf(tree, sp, light);
    }
    return 0.0f;
  }
};

}  // namespace relume
