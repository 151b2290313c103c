// Records camera subpaths for learned structures, as PathRecorder, GuideRecorder and LightChainRecorder do for path
// tracing.
//
// The value of a record estimates the radiance that arrives along the sampled direction, without bias. It sums all
// light that the remaining subpath finds: by meeting lights, by connections, and by merging. The weights are those for
// a camera at the recorded vertex. Strategies that cut the path before its next vertex do not sample the direction, so
// the recursion of partial weights starts at that vertex with A = B = 0. With the weights of the image, such light
// would be missing in part.
#pragma once

#include "techniques/spatial/octree/cached_path_recorder.h"
#include "techniques/transport/bdpt/bdpt_context.h"

namespace relume {

/// A weight as a function of the partial weights of the camera subpath: 1 / (fixed + a A + b B).
struct WeightTerms {
  float fixed = 1;
  float a = 0;
  float b = 0;

  RELUME_HD float inverse(const PartialWeights& at) const { return fixed + product(a, at.a) + product(b, at.b); }

 private:
  /// Zero if one factor is zero, also if the other overflowed to infinity.
  RELUME_HD static float product(float x, float y) { return x > 0.0f && y > 0.0f ? x * y : 0.0f; }
};

/// Terms of weight_from(others, scale · PartialWeights::sum(p, sigma, merging)).
RELUME_HD inline WeightTerms weight_terms(float others, float p, float sigma, float merging, float scale) {
  const float cut = sqr(p) * scale;
  return {1.0f + others + zero_or(merging, cut), cut, cut * sqr(sigma)};
}

/// The default does nothing and compiles away.
struct NoRecorder : NoPolicy {
  /// Whether outcomes of the connections to lights are recorded at the current vertex.
  RELUME_HD static constexpr bool needs_visibility() { return false; }
  /// Whether the importance that arrives at a vertex is recorded.
  RELUME_HD static constexpr bool records_importance(uint32_t /*vertex*/) { return false; }
  RELUME_HD void moved(float, float) const {}
  RELUME_HD void arrived(SurfacePoint&, const PathState&) const {}
  RELUME_HD void weigh(const WeightTerms&) const {}
  RELUME_HD void add(const Rgb&, const PartialWeights&) const {}
  RELUME_HD void add_met(const Rgb&, const PartialWeights&, const PathState&, bool) const {}
  RELUME_HD void connected(const SurfacePoint&, const PathState&, const Connection&, bool) const {}
  RELUME_HD void scattered(const BdptContext&, const SurfacePoint&, const BsdfSample&, const PathState&) const {}
  RELUME_HD void left(float, float, float) const {}
  RELUME_HD void left_delta(float, float) const {}
};

static_assert(kMostChainVertices <= kMaxRecordedVertices);

class SubpathRecorder {
 public:
  /// The arguments must outlive the recorder.
  RELUME_HD SubpathRecorder(const PathRecording& recording, const SubpathChains& chains, uint32_t pixel)
      : recorder_(recording.begin(pixel)), vertices_(relume::max(recording.vertices, chains.guide.out.vertices)) {
    guide_.recording = &chains.guide;
    guide_.pixel = pixel;
    lights_.recording = &chains.lights;
    lights_.pixel = pixel;
  }

  RELUME_HD bool needs_visibility() const {
    const PathRecording& recording = *recorder_.recording;
    const uint32_t v = recorder_.current;
    return v < recording.vertices || v < lights_.recording->out.vertices || (v == 0 && !recording.feedback.empty());
  }

  RELUME_HD bool records_importance(uint32_t vertex) const { return recorder_.recording->records_importance(vertex); }

  /// Called with the arguments of SubpathWeights::arrive().
  RELUME_HD void moved(float cosine, float distance_squared) {
    for (uint32_t v = 0; v < behind_; ++v) weights_[v].arrive(cosine, distance_squared);
  }

  /// As NoPolicy::hit_surface().
  RELUME_HD void hit_surface(const SurfacePoint& sp, const PathState& path) { guide_.hit_surface(sp, path); }

  /// Called at each surface that may scatter the subpath. Sets its region.
  RELUME_HD void arrived(SurfacePoint& sp, const PathState& path) {
    const PathRecording& recording = *recorder_.recording;
    const RegionPair regions = recording.find(sp);
    sp.region = recording.lookup.jitter > 0.0f ? recording.lookup.jittered_region(sp) : regions.sample;
    recorder_.begin_vertex(path.bounce, regions.store);
    recording.meet(path.bounce, recorder_.pixel, sp);
    if (!recording.records_importance(path.bounce)) return;
    // A light subpath gains from a direction that leads to a vertex with a connection to the camera. Before the camera
    // subpath has scattered other than specularly, there is none on it.
    const float value = scattered_ ? luminance(unit_ * path.throughput) : 0.0f;
    recording.store_importance(path.bounce, recorder_.pixel, sp.wo, value);
  }

  /// Sets the terms of the weight within the light that add() or add_met() gets next.
  RELUME_HD void weigh(const WeightTerms& terms) { terms_ = terms; }

  /// Adds light to the records behind the current vertex. `at`: partial weights that its weight used.
  RELUME_HD void add(const Rgb& light, const PartialWeights& at) { add_to(behind_, light, at); }

  /// Adds the light of a source at the end of the ray. `connectable`: connections from the previous vertex could find
  /// it, so directions leave it out.
  RELUME_HD void add_met(const Rgb& light, const PartialWeights& at, const PathState& path, bool connectable) {
    const bool leaves_out = connectable && behind_ > 0 && behind_ == path.bounce;
    add_to(leaves_out ? behind_ - 1 : behind_, light, at);
  }

  /// As NoPolicy::light_picked().
  RELUME_HD void light_picked(const SurfacePoint& sp, const PathState& path, LightId light) {
    lights_.light_picked(sp, path, light);
  }

  /// Called after the connection to a light was tested.
  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& connection, bool visible) {
    recorder_.connected(sp, path, connection, visible);
    lights_.connected(sp, path, connection, visible);
  }

  /// Called after a direction was sampled; `after`: the subpath with its new ray. left() or left_delta() follows.
  RELUME_HD void scattered(const BdptContext& c, const SurfacePoint& sp, const BsdfSample& s, const PathState& after) {
    const PathInImage now = in_image(after);
    recorder_.scattered(sp, s, now);
    guide_.scattered(sp, s, now);
    if (!after.delta) scattered_ = true;
    left_ = behind_;
    behind_ = relume::min(after.bounce, vertices_);
    for (uint32_t v = left_; v < behind_; ++v) {
      weights_[v] = SubpathWeights::start(0.0f, 0.0f, 1.0f, 0.0f, false, c.merging, c.connected);
      found_[v] = Rgb(0);
    }
  }
  /// Called with the arguments of SubpathWeights::leave().
  RELUME_HD void left(float cosine, float pdf, float reverse) {
    for (uint32_t v = 0; v < left_; ++v) weights_[v].leave(cosine, pdf, reverse);
  }
  /// Called with the arguments of SubpathWeights::leave_delta().
  RELUME_HD void left_delta(float cosine, float ratio) {
    for (uint32_t v = 0; v < left_; ++v) weights_[v].leave_delta(cosine, ratio);
  }

  /// Called when the subpath is complete.
  RELUME_HD void finished(const PathState& path) {
    const auto found = [&](uint32_t v) { return found_[v]; };
    recorder_.finish(found);
    // States have no weights, so a culled subpath, which lacks light, leaves none.
    if (weight_ > 0.0f) {
      guide_.finish(found);
    } else {
      guide_.recording->out.skip(guide_.pixel);
    }
    lights_.finished(path);
    if (weight_ == 1.0f) return;
    for (uint32_t v = 0; v < recorder_.reached; ++v) recorder_.recording->sample(v, recorder_.pixel).weight = weight_;
  }

  // Events of a cache (techniques/transport/path/path_policy.h).

  RELUME_HD void rebased(const Rgb& /*found*/, const Rgb& unit) { unit_ = unit; }
  /// The cell lacks the light of strategies that do not sample its vertex from the camera, so no record takes its mean.
  RELUME_HD void ended_in_cell(const Rgb&) const {}
  /// All records of a subpath that continues stand for those of subpaths that end, including the vertices before.
  RELUME_HD void survived(float probability) { weight_ = 1.0f / probability; }
  RELUME_HD void culled() { weight_ = 0; }

 private:
  /// The subpath in the units of the image.
  RELUME_HD PathInImage in_image(const PathState& path) const {
    return {path.ray,
            unit_ * path.throughput,
            unit_ * path.radiance,
            path.pdf_w,
            path.wavelength_nm,
            path.dispersed,
            path.delta,
            path.bounce};
  }

  RELUME_HD void add_to(uint32_t records, const Rgb& light, const PartialWeights& at) {
    if (is_black(light)) return;
    const float weighted = terms_.inverse(at);
    for (uint32_t v = 0; v < records; ++v) {
      const Rgb share = unit_ * light * (weighted / terms_.inverse(weights_[v].at()));
      if (is_finite(share)) found_[v] += share;
    }
  }

  PathRecorder recorder_;
  GuideRecorder guide_;  ///< without its events: it gets the subpath in the units of the image
  LightChainRecorder lights_;
  uint32_t vertices_;  ///< number of vertices of which directions are recorded
  WeightTerms terms_;
  Rgb unit_{1};             ///< factor by which radiance and throughput of the subpath count in the image
  float weight_ = 1;        ///< of the records
  uint32_t behind_ = 0;     ///< number of recorded vertices behind the current one
  uint32_t left_ = 0;       ///< the same for the previous vertex
  bool scattered_ = false;  ///< whether an earlier vertex scattered other than specularly
  SubpathWeights weights_[kMaxRecordedVertices];  ///< for a camera at the recorded vertex
  Rgb found_[kMaxRecordedVertices] = {};          ///< light along the direction of the recorded vertex, in the image
};

RELUME_HD inline NoRecorder recorder_of(const BdptContext&, uint32_t /*pixel*/) { return {}; }
RELUME_HD inline SubpathRecorder recorder_of(const LearningContext& c, uint32_t pixel) {
  return {c.recording, c.chains, pixel};
}

/// Clears the records of a pixel without a path.
template <typename Context>
RELUME_HD inline void skip_records(const Context& c, uint32_t pixel) {
  if constexpr (Context::kLearns) {
    c.recording.skip(pixel);
    c.chains.skip(pixel);
  }
}

}  // namespace relume
