// Third kernel of ReSTIR PT: combines each pixel's reservoir with those of neighbouring pixels by the pairwise weights
// of [Lin22], and adds the light of the result.
#pragma once

#include "techniques/reuse/reservoir/combine_neighbours.h"
#include "techniques/reuse/restir_pt/path_candidates.h"
#include "techniques/reuse/restir_pt/path_pairs.h"

namespace relume {

/// Neighbours, and the number of the pair by which each was found.
struct PathNeighbours : ReuseNeighbours {
  uint32_t pair[kMostReuseNeighbours] = {};
};

struct PathSpatialKernel {
  PathShifter shifter;
  PairSearch pairs;                      ///< of neighbours; only its search unless `reciprocal`
  View<const PathReservoir> reservoirs;  ///< before this kernel
  View<const ReceiverRecord> records;
  View<PathReservoir> history;       ///< for the next frame
  View<FirstVertex> first_vertices;  ///< receives the direction and light of the result; may be empty
  ReuseImage image;
  PathCorrection correction = PathCorrection::exact;
  bool reciprocal = false;  ///< whether neighbours come in pairs
  bool feeds_back = true;   ///< whether the history is the result of this kernel
  /// Results of PathPairKernel; empty: shifts are repeated here.
  View<const PairedPath> paired[kMostReuseNeighbours];

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * shifter.width + x;
    const PathReservoir own = reservoirs[pixel];
    if (!(own.confidence > 0.0f) || !image.sampled.has(pixel)) {
      history[pixel] = own;
      return;
    }
    ChoiceNumbers numbers(shifter.index.seed, shifter.index.frame, pixel, kChoosesPathNeighbours);
    PathNeighbours near;
    find(x, y, numbers, near);
    const bool weighs_all = correction == PathCorrection::basic || correction == PathCorrection::constant;
    PathReservoir result =
        weighs_all ? combine_all(pixel, own, near, numbers) : combine_pairs(pixel, own, near, numbers);
    shade(pixel, result);
    if (!is_finite(result.weight)) result.weight = 0;  // must not spread
    history[pixel] = feeds_back ? result : own;
  }

 private:
  RELUME_HD void find(uint32_t x, uint32_t y, ChoiceNumbers& numbers, PathNeighbours& near) const {
    const auto has_reservoir = [&](uint32_t other) { return reservoirs[other].confidence > 0.0f; };
    if (!reciprocal) return pairs.search.find(x, y, has_reservoir, numbers, near);
    for (uint32_t i = 0; i < pairs.search.count; ++i) {
      const uint32_t other = pairs.find(x, y, i, has_reservoir);
      if (other == kNoSurface) continue;
      near.pair[near.count] = i;
      near.pixels[near.count++] = other;
    }
  }

  /// Whether both shifts of a pair are known.
  RELUME_HD bool knows_shifts() const { return reciprocal && !paired[0].empty(); }

  /// Shifts a path to the primary hit of a pixel, for the reservoir of `pixel`.
  RELUME_HD Shifted shift(uint32_t pixel, uint32_t to, const StoredPath& path, bool traced) const {
    const SceneView& scene = shifter.context.scene;
    const ReceiverRecord& record = records[to];
    return shifter.shift(path, scene.camera, scene.instances[record.hit.instance], record, traced, image.rays[pixel]);
  }

  /// Gives the path of neighbour `i` the value that it has at `pixel`. Returns p̂ there.
  RELUME_HD float move(uint32_t pixel, const PathNeighbours& near, uint32_t i, StoredPath& path) const {
    if (!knows_shifts()) {
      const Shifted shifted = shift(pixel, pixel, path, true);
      move_to(shifted, path);
      return shifted.target;
    }
    const PairedPath& moved = paired[near.pair[i]][pixel];
    path.value = moved.value;
    path.first = moved.first;
    return moved.target;
  }

  /// p̂ of the path of `pixel` at neighbour `i`.
  RELUME_HD float target_there(uint32_t pixel, const PathNeighbours& near, uint32_t i, const StoredPath& path) const {
    const uint32_t other = near.pixels[i];
    if (knows_shifts()) return paired[near.pair[i]][other].target;
    return shift(pixel, other, path, true).target;
  }

  RELUME_HD PathReservoir combine_pairs(uint32_t pixel, const PathReservoir& own, const PathNeighbours& near,
                                        ChoiceNumbers& numbers) const {
    const auto here = [&](uint32_t i, PathReservoir& neighbour) { return move(pixel, near, i, neighbour.sample); };
    const auto there = [&](uint32_t i) { return target_there(pixel, near, i, own.sample); };
    return combine_neighbours_pairwise(own, reservoirs, near, here, there, numbers);
  }

  /// The modes "basic" and "constant".
  RELUME_HD PathReservoir combine_all(uint32_t pixel, const PathReservoir& own, const PathNeighbours& near,
                                      ChoiceNumbers& numbers) const {
    BasicCombination<StoredPath> combination;
    combination.add(own, 0, own.target, 0.0f);
    float confidence = own.confidence;
    for (uint32_t i = 0; i < near.count; ++i) {
      PathReservoir neighbour = reservoirs[near.pixels[i]];
      const float target = neighbour.weight > 0.0f ? move(pixel, near, i, neighbour.sample) : 0.0f;
      combination.add(neighbour, i + 1, target, numbers.next());
      confidence += neighbour.confidence;
    }
    const StoredPath path = combination.sample();
    if (!path.valid()) return combination.finish(0.0f, 0.0f);
    if (correction == PathCorrection::constant) return combination.finish(1.0f, confidence);
    const uint32_t chosen = combination.chosen();
    const float here = combination.target();
    float of_source = here;
    float of_all = own.confidence * here;
    for (uint32_t i = 0; i < near.count; ++i) {
      const PathReservoir& neighbour = reservoirs[near.pixels[i]];
      const bool is_source = chosen == i + 1;
      const float there = is_source ? neighbour.target : shift(pixel, near.pixels[i], path, false).target;
      of_all += neighbour.confidence * there;
      if (is_source) of_source = there;
    }
    return combination.finish(of_source, of_all);
  }

  /// Adds the light of the result, whose path is known to be visible.
  RELUME_HD void shade(uint32_t pixel, const PathReservoir& result) const {
    if (!image.takes(result.weight, pixel)) return;
    const Rgb value = result.sample.value * result.weight;
    image.radiance[pixel] += value;
    if (!image.specular.empty() || !first_vertices.empty()) add_parts(pixel, result.sample, value);
  }

  /// Adds the part of a path's light that specular lobes of the primary hit scatter, and records the light that arrives
  /// there. `value`: light of the path in the image.
  RELUME_HD void add_parts(uint32_t pixel, const StoredPath& path, const Rgb& value) const {
    const Vec3& wi = path.first;
    if (wi == Vec3(0)) {
      if (!image.specular.empty()) image.specular[pixel] += value;
      return;
    }
    const SceneView& scene = shifter.context.scene;
    const ReceiverRecord& record = records[pixel];
    const float wavelength_nm = path_wavelength(scene, sampler_of(shifter.index, shifter.width, path));
    PathWalk walk;
    if (!start_walk(scene, scene.camera, scene.instances[record.hit.instance], record, wavelength_nm, walk)) return;
    if (!image.specular.empty()) image.specular[pixel] += value * specular_share(walk.sp, wi);
    if (first_vertices.empty()) return;
    // The wavelength weight is not part of the BSDF, so the recorded light includes it.
    const Rgb divisor = walk.path.throughput * eval_pdf(walk.sp, wi).f;
    FirstVertex& vertex = first_vertices[pixel];
    vertex.scatter = wi;
    for (int c = 0; c < 3; ++c) vertex.indirect[c] = divisor[c] > 0.0f ? value[c] / divisor[c] : 0.0f;
  }
};

}  // namespace relume
