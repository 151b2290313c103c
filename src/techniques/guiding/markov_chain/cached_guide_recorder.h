// Advances the chains that guide paths of which a radiance cache replaces parts.
#pragma once

#include "techniques/guiding/markov_chain/guide_recorder.h"

namespace relume {

/// A GuideRecorder that receives the events of a cache's policy (techniques/transport/path/path_policy.h). Where a cell
/// was read, its mean is the light from there on for earlier vertices. Scores have no weights where a cache culls
/// paths. Whether a path continues does not depend on its direction at the vertex, so a chain receives fewer states,
/// with the same distribution.
struct CachedGuideRecorder : GuideRecorder {
  uint32_t complete = 0;  ///< vertices before this one have their light; `radiance` holds it with a negative sign
  uint32_t closed = 0;    ///< these, too, unless the path leaves the current vertex through a delta lobe

  template <typename Path>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const Path& after) {
    if (after.delta) {
      reopen(before + unit * after.radiance);
    } else {
      complete = closed;
    }
    GuideRecorder::scattered(sp, s, after);
  }

  template <typename Path>
  RELUME_HD void finished(const Path& path) const {
    const Rgb all = before + unit * path.radiance;
    finish([&](uint32_t v) { return (v < closed ? Rgb(0) : all) - radiance[v]; });
  }

  /// As NoPolicy::ended_in_cell(). The path has no radiance: the cache has rebased it at this vertex.
  RELUME_HD void ended_in_cell(const Rgb& cell) {
    for (uint32_t v = complete; v < reached; ++v) {
      if (records(v)) radiance[v] -= before + cell;
    }
    closed = reached;
  }

 private:
  /// Cells exclude the light of delta lobes: vertices before the current one receive it from the path, whose radiance
  /// in the image is `now`.
  RELUME_HD void reopen(const Rgb& now) {
    for (uint32_t v = complete; v < closed; ++v) {
      if (records(v)) radiance[v] += now;
    }
    closed = complete;
  }
};

}  // namespace relume
