// Advances the chains of light selection: records new states at the first vertices of a path.
#pragma once

#include "techniques/light_sampling/markov_chain_lights/light_chain.h"
#include "techniques/spatial/markov_grid/markov_records.h"

namespace relume {

/// Shared by the recorders of a frame.
struct LightChainRecording {
  MarkovChainLights chains;  ///< the states from which paths chose their lights
  LightTree tree;
  MarkovRecords<LightState> out;
  float least_alpha = 0.05f;  ///< least share of a new score in the mean
  uint32_t most_count = 64;   ///< largest count of a state
};

/// Hooks along one path, as those of a path policy (techniques/transport/path/path_policy.h), and their steps for light
/// samples without a path. The score of a light is the luminance of its contribution at the vertex: radiance times
/// f cos θ, MIS weight and visibility over pmf and density.
struct LightChainRecorder {
  static constexpr uint32_t kSalt = 0x510e527fu;

  const LightChainRecording* recording = nullptr;
  uint32_t pixel = 0;
  uint32_t recorded = 0;  ///< bit v: vertex v has a record
  LightState state;       ///< that of the picked light in a drawn cell; empty: the light tree alone picked it
  MarkovCell source;      ///< cell of that state
  float sum = 0;          ///< of the weights of the drawn states

  /// Scores a picked light 0, unless connected() follows.
  template <typename Path>
  RELUME_HD void light_picked(const SurfacePoint& sp, const Path& path, LightId light) {
    if (path.bounce < recording->out.vertices) pick(sp, path.bounce, light);
  }

  /// Accepts a light with probability score / mean weight of the drawn states, as a Markov chain does.
  template <typename Path, typename Connection>
  RELUME_HD void connected(const SurfacePoint& sp, const Path& path, const Connection& connection, bool visible) {
    if (path.bounce >= recording->out.vertices || !visible) return;
    Rgb contribution(0);
    for (int c = 0; c < 3; ++c) {
      if (path.throughput[c] > 0.0f) contribution[c] = connection.contribution[c] / path.throughput[c];
    }
    offer(sp, path.bounce, connection.light, luminance(contribution));
  }

  template <typename Path>
  RELUME_HD void finished(const Path&) {
    for (uint32_t v = 0; v < recording->out.vertices; ++v) {
      if ((recorded >> v & 1u) == 0) recording->out.clear(v, pixel);
    }
  }

  /// Step of light_picked() at vertex `v`, which must have a record.
  RELUME_HD void pick(const SurfacePoint& sp, uint32_t v, LightId light) {
    recorded |= 1u << v;
    const MarkovChainLights& chains = recording->chains;
    const uint32_t seed = chains.grid.seed_at(sp);
    state = {};
    source = {};
    sum = 0;
    for (uint32_t i = 0; i < chains.grid.drawn_cells; ++i) {
      MarkovCell cell;
      const LightState drawn = chains.drawn(recording->tree, sp, seed, i, cell);
      sum += drawn.weight;
      if (drawn.light != light || !(drawn.weight > state.weight)) continue;
      state = drawn;
      source = cell;
    }
    set_record(v, scored(0.0f), source, {});
  }

  /// Step of connected() at the vertex of the last pick(), for the picked light.
  RELUME_HD void offer(const SurfacePoint& sp, uint32_t v, LightId light, float score) const {
    if (!(score >= 0.0f && score <= kMostLightWeight)) return;
    LightState next = scored(score);
    next.light = light;
    const MarkovGrid& grid = recording->chains.grid;
    const uint32_t numbers = hash(grid.seed ^ kSalt, pixel, v);
    if (!(to_unit_float(hash(numbers, 0u)) * sum < score * static_cast<float>(grid.drawn_cells)))
      return set_record(v, next, source, {});
    set_record(v, next, grid.adaptive_cell(sp.position, sp.ng, hash(numbers, 1u)),
               grid.static_cell(sp.position, hash(numbers, 2u)));
  }

 private:
  /// The state with a new score.
  RELUME_HD LightState scored(float score) const {
    LightState next = state;
    next.count = relume::min(next.count, recording->most_count - 1) + 1;
    const float alpha = relume::max(1.0f / static_cast<float>(next.count), recording->least_alpha);
    next.weight += alpha * (score - next.weight);
    return next;
  }

  RELUME_HD void set_record(uint32_t v, const LightState& next, const MarkovCell& first,
                            const MarkovCell& second) const {
    MarkovRecord<LightState>& record = recording->out.record(v, pixel);
    record.state = next;
    record.cells[0] = first;
    record.cells[1] = second;
  }
};

}  // namespace relume
