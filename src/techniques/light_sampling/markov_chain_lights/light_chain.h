// Light selection from Markov chains: each cell of a grid holds a light that contributed around it, and selection mixes
// the lights of several cells with a light tree. relume's construction, on the grids of [Alber25].
#pragma once

#include "sampling/choose.h"
#include "techniques/light_sampling/light_selection/light_selection.h"
#include "techniques/light_sampling/light_tree/light_tree.h"
#include "techniques/spatial/markov_grid/markov_grid.h"

namespace relume {

/// Limits of a state's weight: a state beyond them is empty, whatever bits a damaged table has.
inline constexpr float kLeastLightWeight = 1e-30f;
inline constexpr float kMostLightWeight = 1e30f;

struct LightState {
  LightId light = kNoLight;
  float weight = 0;    ///< mean score of the light; 0: empty
  uint32_t count = 0;  ///< number of averaged scores, with a limit
};

/// Whether the tree may choose the light.
RELUME_HD inline bool can_choose(const LightTree& tree, LightId light) {
  if (light >= tree.infinite.first)
    return light - tree.infinite.first < tree.infinite.table.entries.size && tree.infinite.pmf(light) > 0.0f;
  return light < tree.place.size && tree.place[light] != light_tree::kNoParent;
}

/// Lights of the drawn cells, and their weights. Elements of empty cells have weight 0.
struct DrawnLights {
  LightId lights[kMostDrawnCells];  ///< `count` valid elements, here and below
  float weights[kMostDrawnCells];
  uint32_t count = 0;
  float sum = 0;  ///< of the weights

  /// Sum of the weights of a light.
  RELUME_HD float weight_of(LightId light) const {
    float weight = 0;
    for (uint32_t i = 0; i < count; ++i) {
      if (lights[i] == light) weight += weights[i];
    }
    return weight;
  }
};

/// Chooses lights with the probabilities γ · tree + (1 − γ) · Σ weights of the light / Σ weights; those of the tree
/// alone at vertices without states.
struct MarkovChainLights {
  MarkovGrid grid;
  MarkovTable<LightState> table;
  float base_fraction = 0.2f;  ///< γ

  /// State of cell i of those drawn at a vertex; without weight if the tree does not choose its light.
  RELUME_HD LightState drawn(const LightTree& tree, const SurfacePoint& sp, uint32_t seed, uint32_t i,
                             MarkovCell& cell) const {
    cell = grid.drawn(sp, seed, i);
    LightState state = table.load(cell);
    const bool usable = state.weight >= kLeastLightWeight && state.weight <= kMostLightWeight;
    if (!usable || !can_choose(tree, state.light)) state = {};
    return state;
  }

  /// All calls at a vertex of a frame return the same.
  RELUME_HD DrawnLights lights_at(const LightTree& tree, const SurfacePoint& sp) const {
    const uint32_t seed = grid.seed_at(sp);
    DrawnLights drawn_lights;
    drawn_lights.count = grid.drawn_cells;
    for (uint32_t i = 0; i < grid.drawn_cells; ++i) {
      MarkovCell cell;
      const LightState state = drawn(tree, sp, seed, i, cell);
      drawn_lights.lights[i] = state.light;
      drawn_lights.weights[i] = state.weight;
      drawn_lights.sum += state.weight;
    }
    return drawn_lights;
  }

  /// `u`, `bits`: those of a ReusableNumber, as numbers because a copy of it enlarges the stack of all paths.
  RELUME_HD LightSelection sample(const LightTree& tree, const SurfacePoint& sp, float u, uint32_t bits) const {
    ReusableNumber n{u, bits};
    const DrawnLights lights = lights_at(tree, sp);
    if (!(lights.sum > 0.0f)) return tree.sample(sp, n);
    if (takes_share(base_fraction, n)) {
      LightSelection s = tree.sample(sp, n);
      if (s.pmf > 0.0f) s.pmf = mixed(lights, s.light, s.pmf);
      return s;
    }
    const LightId light = lights.lights[choose_by_weight(lights.weights, lights.count, lights.sum, n)];
    return {light, mixed(lights, light, tree.pmf(sp, light)), n.u};
  }

  /// Probability that sample() chooses `light`.
  RELUME_HD float pmf(const LightTree& tree, const SurfacePoint& sp, LightId light) const {
    const DrawnLights lights = lights_at(tree, sp);
    const float base = tree.pmf(sp, light);
    return lights.sum > 0.0f ? mixed(lights, light, base) : base;
  }

 private:
  RELUME_HD float mixed(const DrawnLights& lights, LightId light, float base) const {
    return base_fraction * base + (1.0f - base_fraction) * (lights.weight_of(light) / lights.sum);
  }
};

}  // namespace relume
