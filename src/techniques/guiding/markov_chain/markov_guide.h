// Guiding density at a vertex: a mixture of the lobes of several chains, drawn from the cells around it ([Alber25]).
#pragma once

#include "sampling/choose.h"
#include "techniques/guiding/markov_chain/guide_state.h"
#include "techniques/spatial/markov_grid/markov_grid.h"

namespace relume {

/// Lobes with weights.
struct MarkovLobes {
  VonMisesFisher lobes[kMostDrawnCells];  ///< `count` valid elements, here and below
  float weights[kMostDrawnCells];
  uint32_t count = 0;
  float sum = 0;  ///< of the weights

  RELUME_HD bool empty() const { return count == 0; }
  RELUME_HD void add(const VonMisesFisher& lobe, float weight) {
    lobes[count] = lobe;
    weights[count++] = weight;
    sum += weight;
  }

  /// pdf_w of sample(); there must be lobes.
  RELUME_HD float pdf(const Vec3& w) const {
    float total = 0;
    for (uint32_t i = 0; i < count; ++i) total += weights[i] / sum * lobes[i].pdf(w);
    return total;
  }
  /// Samples a direction. `u.x` chooses the lobe; its remainder and `u.y` give the direction.
  RELUME_HD Vec3 sample(const Vec2& u) const {
    ReusableNumber n{u.x, hash(float_bits(u.x), float_bits(u.y))};
    const uint32_t chosen = choose_by_weight(weights, count, sum, n);
    return lobes[chosen].sample({n.u, u.y});
  }
};

struct MarkovGuide {
  MarkovGrid grid;
  MarkovTable<GuideState> table;
  float bsdf_fraction = 0.15f;   ///< β, probability of the BSDF at vertices with lobes
  float prior = 0.2f;            ///< GuidePrior::strength
  uint32_t frame = 0;            ///< number of the frame
  bool replaces_lights = false;  ///< whether paths make no connections to lights that directions can find

  /// A chain drawn at a vertex.
  struct Drawn {
    GuideState state;
    MarkovCell cell;
    VonMisesFisher lobe;
    bool valid = false;  ///< whether it has a lobe
  };

  RELUME_HD GuidePrior prior_at(const SurfacePoint& sp) const { return {prior, grid.edge_at(sp.position)}; }

  /// Chain i of those drawn at a vertex, with its targets at their places in this frame. A static cell does not
  /// distinguish normals, so a lobe below the horizon is not valid there, unless the surface transmits light.
  RELUME_HD Drawn drawn(const SurfacePoint& sp, uint32_t seed, const GuidePrior& at, uint32_t i) const {
    Drawn d;
    d.cell = grid.drawn(sp, seed, i);
    d.state = moved_to_frame(table.load(d.cell), frame);
    d.valid = lobe_at(d.state, sp.position, at, d.lobe);
    if (d.valid && grid.is_static(d.cell) && !transmits_rough(sp.bsdf))
      d.valid = glm::dot(sp.frame.n, d.lobe.axis) > 0.0f;
    return d;
  }

  /// Adds the lobes at a vertex to `lobes`. All calls at a vertex of a frame add the same. They are not returned: a
  /// device's thread would store them twice.
  RELUME_HD void add_lobes(const SurfacePoint& sp, MarkovLobes& lobes) const {
    const uint32_t seed = grid.seed_at(sp);
    const GuidePrior at = prior_at(sp);
    for (uint32_t i = 0; i < grid.drawn_cells; ++i) {
      const Drawn d = drawn(sp, seed, at, i);
      if (d.valid) lobes.add(d.lobe, d.state.weight);
    }
  }

 private:
  RELUME_HD static bool transmits_rough(const Bsdf& bsdf) {
    for (int i = 0; i < bsdf.lobe_count; ++i) {
      if (is_rough_transmission(bsdf.lobes[i].kind)) return true;
    }
    return false;
  }
};

}  // namespace relume
