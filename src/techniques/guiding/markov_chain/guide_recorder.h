// Advances the chains that guide paths: records new states at the first vertices of a path ([Alber25]).
#pragma once

#include "techniques/guiding/markov_chain/markov_guide.h"
#include "techniques/spatial/markov_grid/markov_records.h"

namespace relume {

/// Shared by the recorders of a frame.
struct GuideRecording {
  MarkovGuide guide;  ///< the states from which paths took their lobes
  MarkovRecords<GuideState> out;
  ChainRates rates;
  bool recovers = true;  ///< whether chains end whose light has vanished
};

/// Numbers of hashes for decisions at a vertex.
struct ChainNumbers {
  static constexpr uint32_t kSalt = 0x5be0cd19u;

  uint32_t seed;

  RELUME_HD ChainNumbers(const MarkovGrid& grid, uint32_t pixel, uint32_t vertex)
      : seed(hash(grid.seed ^ kSalt, pixel, vertex)) {}
  RELUME_HD float accept() const { return to_unit_float(hash(seed, 0u)); }
  RELUME_HD float source() const { return to_unit_float(hash(seed, 1u)); }
  RELUME_HD float lobe() const { return to_unit_float(hash(seed, 2u)); }
  RELUME_HD uint32_t adaptive_cell() const { return hash(seed, 3u); }
  RELUME_HD uint32_t static_cell() const { return hash(seed, 4u); }
};

/// Hooks along one path, as those of a path policy (techniques/transport/path/path_policy.h). The score of a direction
/// is the luminance of its contribution: of incident radiance times f cos θ / pdf_w. The radiance is that of the rest
/// of the path, without emission that next event estimation could sample.
struct GuideRecorder {
  const GuideRecording* recording = nullptr;
  uint32_t pixel = 0;
  uint32_t reached = 0;                   ///< number of vertices with valid elements in the arrays below
  Rgb before{0};                          ///< radiance of the path in the image, up to the last change of `unit`
  Rgb unit{1};                            ///< factor by which radiance and throughput of the path count in the image
  Rgb factor[kMostChainVertices];         ///< contribution of the direction per radiance found along it
  Rgb radiance[kMostChainVertices];       ///< radiance of the path before, with the excluded emission
  Vec3 origin[kMostChainVertices];        ///< position of the vertex
  Vec3 target[kMostChainVertices];        ///< where the direction leads
  MarkovCell source[kMostChainVertices];  ///< cell of the chain that chose the direction; kNoSlot: the BSDF did
  float sum[kMostChainVertices];          ///< of the weights of the drawn states; below 0: no direction

  /// Whether vertex `v` records.
  RELUME_HD bool records(uint32_t v) const { return v < reached && sum[v] >= 0.0f; }

  template <typename Path>
  RELUME_HD void hit_surface(const SurfacePoint& sp, const Path& path) {
    const uint32_t v = path.bounce - 1;
    if (!records(v)) return;
    target[v] = sp.position;
    set_motion(recording->out.record(v, pixel).state, sp.position - sp.previous_position);
  }

  template <typename Path>
  RELUME_HD void emitted(const Path& path, bool covered_by_nee) {
    const uint32_t v = path.bounce - 1;
    if (covered_by_nee && records(v)) radiance[v] = before + unit * path.radiance;
  }

  template <typename Path>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const Path& after) {
    const uint32_t v = after.bounce - 1;
    if (v >= recording->out.vertices) return;
    reached = v + 1;
    sum[v] = -1;
    if (after.delta) return;
    const Rgb throughput = unit * after.throughput;
    for (int c = 0; c < 3; ++c) factor[v][c] = throughput[c] > 0.0f ? s.weight[c] / throughput[c] : 0.0f;
    radiance[v] = before + unit * after.radiance;
    begin(v, sp, s);
  }

  template <typename Path>
  RELUME_HD void finished(const Path& path) {
    const Rgb all = before + unit * path.radiance;
    finish([&](uint32_t v) { return all - radiance[v]; });
  }

  /// Completes the records. `found_by(v)`: light in the image that the path found along the direction of vertex v.
  template <typename FoundBy>
  RELUME_HD void finish(const FoundBy& found_by) const {
    for (uint32_t v = 0; v < recording->out.vertices; ++v) {
      if (records(v)) {
        finish_record(v, found_by(v));
      } else {
        recording->out.clear(v, pixel);
      }
    }
  }

  /// As NoPolicy::rebased().
  RELUME_HD void rebased(const Rgb& found, const Rgb& next_unit) {
    before += unit * found;
    unit = next_unit;
  }

 private:
  /// Finds the chain that chose the direction, and the cells of the new state.
  RELUME_HD void begin(uint32_t v, const SurfacePoint& sp, const BsdfSample& s) {
    // Light from infinity comes from a point so far away that its parallax within a cell does not matter.
    constexpr float kFar = 4096;
    const MarkovGrid& grid = recording->guide.grid;
    const ChainNumbers numbers(grid, pixel, v);
    MarkovRecord<GuideState>& record = recording->out.record(v, pixel);
    record.state = choose_source(v, sp, s, numbers);
    set_motion(record.state, Vec3(0));
    record.cells[0] = grid.adaptive_cell(sp.position, sp.ng, numbers.adaptive_cell());
    record.cells[1] = grid.static_cell(sp.position, numbers.static_cell());
    origin[v] = sp.position;
    const float edge = relume::max(grid.edge_at(sp.position), power_of_two(grid.static_level));
    target[v] = sp.position + (kFar * edge) * s.wi;
  }

  /// Sets source and sum of a vertex, and returns the state of the source. A direction of the mixture is that of the
  /// BSDF, or of one of the lobes, with probabilities in proportion to their parts of its density. The sampler need not
  /// tell which it was.
  RELUME_HD GuideState choose_source(uint32_t v, const SurfacePoint& sp, const BsdfSample& s,
                                     const ChainNumbers& numbers) {
    const MarkovGuide& guide = recording->guide;
    source[v] = {};
    sum[v] = 0;
    const float lobes = (1.0f - guide.bsdf_fraction) * s.guide_pdf_w;
    const bool guided = numbers.source() * s.pdf_w < lobes;
    const uint32_t seed = guide.grid.seed_at(sp);
    const GuidePrior at = guide.prior_at(sp);
    GuideState chosen;
    float density = 0;
    float u = numbers.lobe();
    for (uint32_t i = 0; i < guide.grid.drawn_cells; ++i) {
      const MarkovGuide::Drawn d = guide.drawn(sp, seed, at, i);
      if (!d.valid) continue;
      sum[v] += d.state.weight;
      if (!guided) continue;
      const float part = d.state.weight * d.lobe.pdf(s.wi);
      if (!(part > 0.0f)) continue;
      density += part;
      if (!takes_share(part / density, u)) continue;
      chosen = d.state;
      source[v] = d.cell;
    }
    return chosen;
  }

  /// Accepts the direction with probability score / mean score of the drawn states, as a Markov chain does.
  RELUME_HD void finish_record(uint32_t v, const Rgb& found) const {
    const MarkovGuide& guide = recording->guide;
    MarkovRecord<GuideState>& record = recording->out.record(v, pixel);
    const float score = relume::max(luminance(found * factor[v]), 0.0f);
    if (!(score <= kMostStateWeight)) return recording->out.clear(v, pixel);
    const float scaled = score * static_cast<float>(guide.grid.drawn_cells);
    if (ChainNumbers(guide.grid, pixel, v).accept() * sum[v] < scaled) {
      add_target(record.state, recording->rates, origin[v], target[v], score, guide.frame);
      return;
    }
    const GuidePrior at{guide.prior, guide.grid.edge_at(origin[v])};
    const bool ends = recording->recovers && source[v].slot != kNoSlot && is_usable(record.state) &&
                      has_vanished(record.state, at, origin[v], glm::normalize(target[v] - origin[v]), score);
    record.state = {};
    record.cells[0] = ends ? source[v] : MarkovCell{};
    record.cells[1] = {};
  }
};

}  // namespace relume
