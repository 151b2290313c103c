// Forward reprojection ([Schalk18] §3.2): moves histories to the pixels in which this frame shows their surfaces, after
// three validations. Where objects and lights move, two light samples are validated too.
#pragma once

#include "core/fixed_point.h"
#include "core/math.h"
#include "techniques/reuse/reservoir/light_point.h"
#include "techniques/temporal/reprojection/look_back.h"
#include "techniques/temporal/reprojection/reject_reason.h"
#include "techniques/temporal/reprojection/stored_sample.h"
#include "techniques/temporal/reprojection/vote.h"

namespace relume {

/// Index of the pixel that contains raster position `raster`, or of the nearest one. NaN counts as 0.
RELUME_HD inline uint32_t pixel_at(const CameraView& camera, const Vec2& raster) {
  const UVec2 size(camera.resolution);
  const uint32_t x = relume::min(math::truncate_to_uint(raster.x), size.x - 1);
  const uint32_t y = relume::min(math::truncate_to_uint(raster.y), size.y - 1);
  return y * size.x + x;
}

/// Each pixel of the previous frame votes for the pixels in which its stored samples are visible.
struct DepthVoteKernel {
  SceneView scene;
  View<const StoredSample> stored;  ///< `capacity` per pixel
  View<const StoredPixel> pixels;
  View<uint64_t> votes;           ///< smallest vote by pixel of this frame; kNoVote at first
  View<uint32_t> reject_reasons;  ///< RejectReason by pixel of the previous frame
  View<const Rgb> mean;           ///< mean of the previous frame
  View<uint32_t> limits;          ///< maximum sample count of each history after changes of light; 0: the history ends
  uint32_t capacity = 1;
  float max_error = 0;        ///< ε of eq. 15, in exposed display units
  float max_light_error = 0;  ///< change of light in tone-mapped display units; larger changes lower the limit further
  float exposure = 1;         ///< factor from radiance to display units
  uint32_t max_samples_changed = 1;  ///< limit of the sample count for changes of light up to max_light_error
  bool lights_changed = false;
  bool light_points = false;    ///< whether light samples are those of reservoirs
  bool splats_apart = false;    ///< whether StoredSample::to_light may belong to splats, which no cell holds
  bool indirect_apart = false;  ///< whether reservoirs add indirect light, which cells of primary hits then lack
  uint32_t seed = 0;            ///< seed of stochastic alpha
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    uint32_t reject_reason = static_cast<uint32_t>(RejectReason::empty);
    limits[pixel] = 0xffffffffu;
    VotedPixels voted;
    for (uint32_t k = 0; k < capacity; ++k) {
      const uint32_t sample = pixel * capacity + k;
      if (!stored[sample].valid()) break;
      const RejectReason f = vote(sample, pixels[pixel], voted);
      const bool replaces = is_kept(f) && reject_reason != static_cast<uint32_t>(RejectReason::looked_up);
      if (k == 0 || replaces) reject_reason = static_cast<uint32_t>(f);
    }
    reject_reasons[pixel] = limits[pixel] == 0 ? static_cast<uint32_t>(RejectReason::relit) : reject_reason;
  }

 private:
  /// The pixels for which one pixel has voted.
  struct VotedPixels {
    uint32_t targets[kMaxStoredSamples];
    uint32_t count = 0;

    RELUME_HD bool has(uint32_t target) const {
      for (uint32_t i = 0; i < count; ++i) {
        if (targets[i] == target) return true;
      }
      return false;
    }
  };

  RELUME_HD RejectReason vote(uint32_t index, const StoredPixel& pixel, VotedPixels& voted) const {
    const StoredSample& sample = stored[index];
    const SurfacePosition p = surface_position(scene, sample.hit);
    const Ray ray = ray_to(p.now);
    Vec2 raster;
    // First validation: the point is on the screen.
    if (!(ray.t_max > 0.0f) || !raster_position(scene.camera, ray, &raster)) return RejectReason::off_screen;
    const uint32_t target = pixel_at(scene.camera, raster);
    // Another sample already moves this history to the pixel. Changes of light are tested at all samples.
    if (!lights_changed && voted.has(target)) return RejectReason::none;

    const float depth = ray.t_max;
    const RejectReason reject_reason = judge(index, pixel, p, ray);
    if (is_kept(reject_reason)) {
      voted.targets[voted.count++] = target;
      atomic_min(&votes[target], vote_of(depth, reject_reason == RejectReason::none ? index : index | kLooksUp));
    } else {
      atomic_min(&votes[target], rejection_of(depth, reject_reason));
    }
    return reject_reason;
  }

  /// Validates a stored sample, whose surface is at `p`, against the view along `ray`.
  RELUME_HD RejectReason judge(uint32_t index, const StoredPixel& pixel, const SurfacePosition& p,
                               const Ray& ray) const {
    const StoredSample& sample = stored[index];
    SurfacePoint sp;
    make_surface_point(scene, ray, sample.hit, scene.camera.cone_width() + scene.camera.cone_spread() * ray.t_max, sp);
    const bool same_view = seen_as_before(p);
    const bool mirrors = sp.bsdf.empty() || near_specular(sp.bsdf);
    if (mirrors && (!same_view || lights_changed)) return RejectReason::near_specular;
    const ViewError error = same_view ? ViewError{} : view_error(sp, p, sample, pixel);
    const bool differs = error.largest > max_error;
    // A pixel of several surfaces could only move as one of them, with the light of its cells. The light of reservoirs
    // and of splats is in no cell.
    const bool in_cells = pixel.cells && !pixel.mixed &&
                          !((light_points || splats_apart) && error.direct > max_error) &&
                          !(indirect_apart && error.indirect > max_error);
    if (differs && !in_cells) return RejectReason::view_dependent;
    if (hidden(ray, sp, index)) return RejectReason::occluded;
    if (lights_changed && !limit_samples(sp, index)) return RejectReason::relit;
    if (pixel.mixed) return RejectReason::mixed;
    return differs ? RejectReason::looked_up : RejectReason::none;
  }

  /// Ray from the camera to `p`; t_max is the distance, 0 behind the camera.
  RELUME_HD Ray ray_to(const Vec3& p) const {
    const CameraView& c = scene.camera;
    if (c.projection == Projection::orthographic) {
      const float depth = -glm::dot(p - c.position, c.axes.n);
      return {p + c.axes.n * depth, -c.axes.n, depth};
    }
    const Vec3 d = p - c.position;
    const float distance = glm::length(d);
    return {c.position, d / distance, distance};
  }

  /// Second validation: whether a shadow ray from the surface to the camera is blocked.
  RELUME_HD bool hidden(const Ray& ray, const SurfacePoint& sp, uint32_t index) const {
    return occluded(scene, shadow_ray(sp, -ray.direction, ray.t_max), hash(seed, index));
  }

  /// Whether camera and surface keep their positions. A camera that only turns sees them from the same direction.
  RELUME_HD bool seen_as_before(const SurfacePosition& p) const {
    const CameraView& before = scene.previous_camera;
    return before.projection != Projection::orthographic && before.position == scene.camera.position &&
           p.before == p.now;
  }

  /// ε of eq. 15: the largest, and those of the directions of scattering and of next event estimation.
  struct ViewError {
    float largest = 0;
    float indirect = 0;
    float direct = 0;
  };

  /// Third validation: eq. 15 for the directions of scattering and of next event estimation.
  RELUME_HD ViewError view_error(const SurfacePoint& sp, const SurfacePosition& p, const StoredSample& sample,
                                 const StoredPixel& pixel) const {
    const CameraView& c = scene.previous_camera;
    const bool parallel = c.projection == Projection::orthographic;
    const Vec3 wo_before = parallel ? c.axes.n : glm::normalize(c.position - p.before);
    const Mat3 turn = previous_to_current(scene, sample.hit);
    ViewError error;
    if (sample.scatter) error.indirect = eq15(sp, turn, wo_before, unpack_direction(sample.scatter), pixel.indirect);
    if (sample.to_light) error.direct = eq15(sp, turn, wo_before, unpack_direction(sample.to_light), pixel.direct);
    error.indirect *= exposure;
    error.direct *= exposure;
    error.largest = relume::max(error.indirect, error.direct);
    return error;
  }

  /// Evaluates both reflections in this frame's shading frame. Viewer and light of the previous frame turn with the
  /// object.
  RELUME_HD static float eq15(const SurfacePoint& sp, const Mat3& turn, const Vec3& wo_before, const Vec3& wi,
                              const Rgb& irradiance) {
    const Vec3 wi_before_local = sp.frame.to_local(glm::normalize(turn * wi));
    const Vec3 wo_before_local = sp.frame.to_local(glm::normalize(turn * wo_before));
    if (wo_before_local.z <= 0.0f) return kInfinity;  // the previous view showed the other side
    const Rgb now = view_dependent_f(sp.bsdf, sp.wo_local, sp.frame.to_local(wi));
    const Rgb before = view_dependent_f(sp.bsdf, wo_before_local, wi_before_local);
    return max_component(abs(now - before) * irradiance);
  }

  /// BSDF without its Lambertian part, which is the same from all directions.
  RELUME_HD static Rgb view_dependent_f(const Bsdf& bsdf, const Vec3& wo, const Vec3& wi) {
    return is_lambert(bsdf) ? Rgb(0) : eval_pdf(bsdf, wo, wi).f;
  }

  /// Beyond the paper: limits the history's sample count, the lower the more light on the surface has changed. False if
  /// the limit is below one.
  RELUME_HD bool limit_samples(const SurfacePoint& sp, uint32_t index) const {
    const uint32_t pixel = index / capacity;
    const float shown = luminance(mean[pixel]) * exposure;
    const float change = relume::max(stored_light_change(sp, stored[index]), moved_light_change(sp, index));
    const float error = change * exposure / (1.0f + shown);  // tone-mapped: bright pixels hide more
    const float excess = error / max_light_error;
    if (excess > static_cast<float>(max_samples_changed)) {
      limits[pixel] = 0;  // whatever the limits of the pixel's other samples
      return false;
    }
    const float limit = static_cast<float>(max_samples_changed) / relume::max(excess, 1.0f);
    limits[pixel] = relume::min(limits[pixel], static_cast<uint32_t>(relume::max(limit, 1.0f)));
    return true;
  }

  /// Change of reflected light by the stored light sample, traced again.
  RELUME_HD float stored_light_change(const SurfacePoint& sp, const StoredSample& sample) const {
    if (sample.light == kNoLight || sample.light >= scene.lights.lights.size) return 0.0f;
    const LightSample light = light_points ? light_at(scene.lights, {sample.light, sample.light_u}, sp.position)
                                           : sample_li(scene.lights, sample.light, sp.position, sample.light_u);
    Vec3 wi = sample.to_light ? unpack_direction(sample.to_light) : sp.frame.n;
    if (splats_apart && light.valid()) wi = light.wi;
    const Received now = receive(sp, light, sample.light);
    const float f = relume::max(max_component(eval_pdf(sp, wi).f), now.f);
    return std::fabs(now.irradiance - sample.light_value) * sample.light_scale * f;
  }

  /// Change of reflected light by one of the changed lights, chosen at random, since the previous frame.
  RELUME_HD float moved_light_change(const SurfacePoint& sp, uint32_t index) const {
    const View<const LightId>& changed = scene.lights.changed;
    if (changed.empty()) return 0.0f;
    const uint32_t random = hash(seed, index, 7u);
    const LightId light = changed[random % changed.size];
    if (light >= scene.lights.previous.size) return 0.0f;
    const Vec2 u(to_unit_float(hash(random, 1u)), to_unit_float(hash(random, 2u)));
    LightsView by_area = scene.lights;  // maps u to the same point in both frames
    by_area.wide_triangle = kInfinity;
    const Received now = receive(sp, sample_li(by_area, light, sp.position, u), light);
    const Received before = receive(sp, sample_li_before(by_area, light, sp.position, u), light);
    return std::fabs(now.irradiance * now.f - before.irradiance * before.f) * static_cast<float>(changed.size);
  }

  /// Luminance of radiance · cos / pdf_w from a light sample, 0 if it is occluded, and the BSDF for its direction.
  struct Received {
    float irradiance = 0;
    float f = 0;
  };
  RELUME_HD Received receive(const SurfacePoint& sp, const LightSample& light, LightId id) const {
    if (!light.valid()) return {};
    const float f = max_component(eval_pdf(sp, light.wi).f);
    if (!(f > 0.0f)) return {};
    if (occluded(scene, shadow_ray(sp, light), hash(seed, id))) return {};
    return {luminance(light.radiance) * shading_cosine(sp, light.wi) / light.pdf_w, f};
  }
};

/// Finds the source of each pixel: the pixel of the previous frame whose stored sample won the depth test. Pixels
/// without a source may look back for histories around the previous position of their surface.
struct SourceKernel {
  SceneView scene;
  View<const uint64_t> votes;
  View<const StoredSample> stored_before;
  View<const StoredPixel> pixels_before;
  View<const uint32_t> limits_before;
  LookBack look_back;    ///< empty: pixels without a vote start without a history
  View<const Hit> hits;  ///< hits of this frame
  View<StoredSample> stored;
  View<StoredPixel> pixels;
  View<uint32_t> limits;
  View<uint32_t> sources;  ///< source in the previous frame, or kNoSource
  View<uint32_t> kept;     ///< 1: continues a history, 0: starts one
  View<uint32_t> reasons;  ///< RejectReason by pixel of this frame
  uint32_t capacity = 1;
  float max_distance = 0;  ///< see far_apart()
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    reset(pixel);
    RejectReason reason = judge(pixel);
    if (is_kept(reason)) {
      const uint32_t sample = sample_of(votes[pixel]);
      take_over(pixel, sample / capacity, stored_before[sample]);
    } else if (!look_back.empty() && may_look_back(reason)) {
      const BackwardTaps taps = look_back.taps(x, y);
      if (taps.valid) {
        take_over(pixel, taps.heaviest(), near_sample(taps.heaviest(), hits[pixel]));
        reason = RejectReason::filled;
      }
    }
    reasons[pixel] = static_cast<uint32_t>(reason);
  }

 private:
  /// Clears the pixel's history.
  RELUME_HD void reset(uint32_t pixel) const {
    for (uint32_t k = 0; k < capacity; ++k) stored[pixel * capacity + k] = StoredSample{};
    pixels[pixel] = StoredPixel{};
    kept[pixel] = 0;
    sources[pixel] = kNoSource;
    limits[pixel] = 0;
  }

  /// Judges the smallest vote of the pixel.
  RELUME_HD RejectReason judge(uint32_t pixel) const {
    if (!is_vote(votes[pixel])) return reason_of(votes[pixel]);
    const uint32_t sample = sample_of(votes[pixel]);
    if (limits_before[sample / capacity] == 0) return RejectReason::relit;
    const bool elsewhere = far_apart(scene, stored_before[sample], hits[pixel], max_distance);
    return elsewhere ? RejectReason::other_surface : reason_of(votes[pixel]);
  }

  /// Whether the reason concerns another surface than the one that the pixel shows: its own may still have a history.
  RELUME_HD static bool may_look_back(RejectReason reason) {
    return reason == RejectReason::empty || reason == RejectReason::occluded || reason == RejectReason::mixed ||
           reason == RejectReason::other_surface;
  }

  /// Continues the history of pixel `source` of the previous frame at `pixel`, with `sample` as its stored sample.
  RELUME_HD void take_over(uint32_t pixel, uint32_t source, const StoredSample& sample) const {
    kept[pixel] = 1;
    sources[pixel] = source;
    limits[pixel] = limits_before[source];
    stored[pixel * capacity] = sample;
    pixels[pixel] = pixels_before[source];
    pixels[pixel].inherited = 1;
    pixels[pixel].fresh = Rgb(0);
    pixels[pixel].fresh_samples = 0;
  }

  /// The first sample of the source near this frame's hit; not valid if none is.
  RELUME_HD StoredSample near_sample(uint32_t source, const Hit& hit) const {
    for (uint32_t k = 0; k < capacity; ++k) {
      const StoredSample& sample = stored_before[source * capacity + k];
      if (sample.valid() && !far_apart(scene, sample, hit, max_distance)) return sample;
    }
    return {};
  }
};

/// Counts the pixels that each pixel of the previous frame owns.
struct OwnerKernel {
  View<const uint32_t> sources;
  View<uint32_t> owned;  ///< counts, zero at first
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t source = sources[y * width + x];
    if (source != kNoSource) atomic_add(&owned[source], 1u);
  }
};

/// Marks source pixels that passed validation but lost the depth test.
struct CoveredKernel {
  View<const uint32_t> owned;
  View<uint32_t> reject_reasons;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (is_kept(static_cast<RejectReason>(reject_reasons[pixel])) && owned[pixel] == 0)
      reject_reasons[pixel] = static_cast<uint32_t>(RejectReason::covered);
  }
};

/// Moves the elements of one buffer; pixels without a source get zero.
template <typename T>
struct MoveKernel {
  View<const T> before;
  View<T> now;
  View<const uint32_t> sources;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    now[pixel] = sources[pixel] == kNoSource ? T{} : before[sources[pixel]];
  }
};

/// Moves the moments; pixels without a source get none.
struct MoveMomentsKernel {
  MomentsView before;
  MutableMomentsView now;
  View<const uint32_t> sources;  ///< pixel of the previous frame, or kNoSource; empty: every pixel is its own source
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const uint32_t source = sources.empty() ? pixel : sources[pixel];
    now.store(pixel, source == kNoSource ? PixelMoments{} : before[source]);
  }
};

/// Limits the sample counts of histories, so that new samples weigh more.
struct LimitKernel {
  MutableMomentsView moments;
  View<const uint32_t> limits;  ///< limits by pixel; empty: none
  uint32_t max_samples = 0;
  uint32_t width = 0;
  View<float> light_paths = {};      ///< weight of SplatImage; empty: no splat image
  MutableMomentsView caustics = {};  ///< of the caustic layer; empty: none

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const uint32_t most = limits.empty() ? max_samples : relume::min(limits[pixel], max_samples);
    if (!light_paths.empty()) light_paths[pixel] = relume::min(light_paths[pixel], static_cast<float>(most));
    PixelMoments limited = MomentsView(moments)[pixel];
    limited.limit(most);
    moments.store(pixel, limited);
    if (caustics.mean.empty()) return;
    PixelMoments layer = MomentsView(caustics)[pixel];
    layer.limit(most);
    caustics.store(pixel, layer);
  }
};

}  // namespace relume
