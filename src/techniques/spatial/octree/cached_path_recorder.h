// Records paths of which a radiance cache replaces parts.
#pragma once

#include "techniques/spatial/octree/path_recording.h"

namespace relume {

/// The members of a path that PathRecorder reads. Throughput and radiance count as in the image.
struct PathInImage {
  const Ray& ray;
  Rgb throughput;
  Rgb radiance;
  float pdf_w;
  float wavelength_nm;
  bool dispersed;
  bool delta;
  uint32_t bounce;
};

/// A PathRecorder that the events of a cache's policy reach (techniques/transport/path/path_policy.h). Values are those
/// of paths without a cache, in expectation and except for the bias of cells. Where a cell was read, its mean is the
/// light from there on for earlier vertices. Where a cache thins paths out, the records of those that continue have the
/// inverse probability as their weight.
struct CachedPathRecorder : PathRecorder {
  Rgb before{0};          ///< radiance of the path in the image, up to the last change of `unit`
  Rgb unit{1};            ///< factor by which radiance and throughput of the path count in the image
  float weight = 1;       ///< of records from the current vertex on
  uint32_t complete = 0;  ///< vertices before this one have their values
  uint32_t closed = 0;    ///< these, too, unless the path leaves the current vertex through a delta lobe

  template <typename Path>
  RELUME_HD bool arrived(SurfacePoint& sp, const Path& path) {
    PathRecorder::arrived(sp, path);
    weigh();
    return true;
  }

  template <typename Path>
  RELUME_HD void emitted(const Path& path, bool covered_by_nee) {
    PathRecorder::emitted(in_image(path), covered_by_nee);
  }

  template <typename Path>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const Path& path) {
    const PathInImage now = in_image(path);
    if (now.delta) {
      reopen(now.radiance);
    } else {
      complete = closed;
      PathRecorder::scattered(sp, s, now);
    }
  }

  template <typename Path>
  RELUME_HD void finished(const Path& path) {
    const Rgb all = in_image(path).radiance;
    for (uint32_t v = 0; v < recording->vertices; ++v) {
      if (v >= reached) {
        recording->sample(v, pixel) = {};
      } else if (v >= closed) {
        add(v, all);
      }
    }
  }

  RELUME_HD void rebased(const Rgb& found, const Rgb& next_unit) {
    before += unit * found;
    unit = next_unit;
  }

  /// The path has no radiance: the cache has rebased it at this vertex.
  RELUME_HD void ended_in_cell(const Rgb& cell) {
    const uint32_t end = relume::min(current, reached);
    for (uint32_t v = complete; v < end; ++v) add(v, before + cell);
    closed = relume::max(end, complete);
  }

  RELUME_HD void survived(float probability) {
    weight = 1.0f / probability;
    weigh();
  }

  RELUME_HD void culled() {
    weight = 0;
    weigh();
  }

 private:
  template <typename Path>
  RELUME_HD PathInImage in_image(const Path& path) const {
    return {path.ray,
            unit * path.throughput,
            before + unit * path.radiance,
            path.pdf_w,
            path.wavelength_nm,
            path.dispersed,
            path.delta,
            path.bounce};
  }

  RELUME_HD void weigh() const {
    if (current < recording->vertices) recording->sample(current, pixel).weight = weight;
  }

  /// Cells exclude the light of delta lobes: vertices before the current one receive it from the path, whose radiance
  /// in the image is `now`.
  RELUME_HD void reopen(const Rgb& now) {
    for (uint32_t v = complete; v < closed; ++v) radiance[v] = now;
    closed = complete;
  }

  RELUME_HD void add(uint32_t v, const Rgb& all) const {
    if (factor[v] > 0.0f) recording->sample(v, pixel).value += value_of(v, all - radiance[v]);
  }
};

}  // namespace relume
