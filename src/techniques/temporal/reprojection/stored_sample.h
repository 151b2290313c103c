// Samples that a pixel stores for validation from another viewpoint ([Schalk18] §3.2.1).
#pragma once

#include "core/octahedral.h"
#include "framebuffer/pixel_moments.h"
#include "techniques/temporal/reprojection/reject_reason.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {

inline constexpr uint32_t kMaxStoredSamples = 4;

/// A stored sample of a pixel: its point on the surface and the directions sampled there.
struct StoredSample {
  Hit hit;                ///< instance kNoHit: no sample
  uint32_t scatter = 0;   ///< octahedral; 0: none
  uint32_t to_light = 0;  ///< octahedral; 0: none
  LightId light = kNoLight;
  Vec2 light_u{0};  ///< see FirstVertex
  float light_value = 0;
  float light_scale = 0;

  RELUME_HD bool valid() const { return hit.valid(); }
};

/// Data common to the samples of a pixel.
struct StoredPixel {
  Rgb indirect{0};         ///< mean of FirstVertex::indirect over the samples
  Rgb direct{0};           ///< mean of FirstVertex::direct
  uint16_t mixed = 0;      ///< 1: the samples lie on several surfaces
  uint16_t cells = 0;      ///< 1: cells of a cache show the light that the surface reflects, for all samples
  uint32_t inherited = 0;  ///< 1: some samples are older than the last reprojection
  Rgb fresh{0};            ///< mean of the samples since the last reprojection
  uint32_t fresh_samples = 0;
};

/// Octahedral code of a direction; 0 for a zero vector, so the direction with that code becomes 1.
RELUME_HD inline uint32_t store_direction(const Vec3& w) {
  if (length_squared(w) == 0.0f) return 0;
  const uint32_t bits = pack_direction(w);
  return bits == 0 ? 1u : bits;
}

/// Whether a lobe's reflection changes with any motion of the camera: [Schalk18] rejects small α and refraction.
RELUME_HD inline bool near_specular(const Lobe& lobe) {
  return (transmits(lobe.kind) && is_specular(lobe.kind)) || is_narrow(lobe);
}

/// One such lobe suffices, since the paper rejects materials. A smooth coat over a diffuse base mirrors the room, and
/// the kept mean does not separate the two.
RELUME_HD inline bool near_specular(const Bsdf& bsdf) {
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (near_specular(bsdf.lobes[i])) return true;
  }
  return false;
}

/// Distance test against aliasing ([Schalk18] §3.2.2): a pixel at a silhouette shows two surfaces, and its mean belongs
/// to neither. Instances are told apart at any distance, for example a lamp on its ceiling. `max_distance`: between
/// samples of one pixel, as a fraction of the distance to the camera.
RELUME_HD inline bool far_apart(const SceneView& scene, const StoredSample& stored, const Hit& hit,
                                float max_distance) {
  if (!stored.valid() || !hit.valid()) return stored.valid() != hit.valid();
  if (stored.hit.instance != hit.instance) return true;
  const Vec3 a = surface_position(scene, stored.hit).now;
  const Vec3 b = surface_position(scene, hit).now;
  return length_squared(a - b) > sqr(max_distance * hit.t);
}

/// Maximum sample count of an inherited history once its pixel has shown another surface.
inline constexpr uint32_t kMixedSamples = 8;

/// Stores this frame's sample before it joins the moments of its pixel.
struct StoreKernel {
  View<const Hit> hits;  ///< hits of this frame
  View<const FirstVertex> first_vertices;
  View<const uint32_t> allocation;  ///< 0: no sample in this frame; empty: a sample everywhere
  View<const uint32_t> edge_rays;   ///< not 0: the emission is a mean over several surfaces; empty: 0 everywhere
  View<const uint32_t> cells;       ///< see StoredPixel, for this frame's sample; empty: 0 everywhere
  View<const Rgb> radiance;         ///< radiance of this frame's sample
  MutableMomentsView history;       ///< moments of the earlier samples that the pixel keeps
  bool restarts = false;            ///< removes the earlier samples from the image
  SceneView scene;
  View<StoredSample> stored;  ///< `capacity` per pixel
  View<StoredPixel> pixels;
  uint32_t capacity = 1;
  float max_distance = 0;  ///< between samples of one pixel, as a fraction of the distance to the camera
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = y * width + x;
    if (!allocation.empty() && allocation[i] == 0) return;
    const Hit& hit = hits[i];
    const FirstVertex& vertex = first_vertices[i];
    StoredPixel& pixel = pixels[i];
    StoredSample* const samples_of_pixel = &stored[i * capacity];
    const uint32_t samples = (restarts ? 0u : history.samples[i]) + 1;
    // A filled pixel may have a history without a stored sample.
    const bool first = samples <= 1 || (pixel.inherited && !samples_of_pixel[0].valid());
    const bool elsewhere = !first && far_apart(scene, samples_of_pixel[0], hit, max_distance);
    if (samples <= 1) reset(pixel, samples_of_pixel);
    if (!cells.empty() && (samples <= 1 || cells[i] == 0)) pixel.cells = cells[i] != 0 ? uint16_t{1} : uint16_t{0};
    if (elsewhere && pixel.inherited) shorten(i);
    if (pixel.inherited) add_fresh(pixel, is_finite(radiance[i]) ? radiance[i] : Rgb(0));
    if (elsewhere || (!edge_rays.empty() && edge_rays[i] > 0)) pixel.mixed = 1;
    const float share = 1.0f / static_cast<float>(restarts ? 1u : history.samples[i] + 1);
    if (is_finite(vertex.indirect)) pixel.indirect += (vertex.indirect - pixel.indirect) * share;
    if (is_finite(vertex.direct)) pixel.direct += (vertex.direct - pixel.direct) * share;
    for (uint32_t k = 0; k < capacity; ++k) {
      if (samples_of_pixel[k].valid()) continue;
      samples_of_pixel[k] = {hit,
                             store_direction(vertex.scatter),
                             store_direction(vertex.to_light),
                             vertex.light,
                             vertex.light_u,
                             vertex.light_value,
                             vertex.light_scale};
      break;
    }
  }

 private:
  RELUME_HD void reset(StoredPixel& pixel, StoredSample* samples_of_pixel) const {
    pixel = StoredPixel{};
    for (uint32_t k = 0; k < capacity; ++k) samples_of_pixel[k] = StoredSample{};
  }

  /// Limits the inherited part of the history: it belongs to only one of several surfaces in this pixel.
  RELUME_HD void shorten(uint32_t i) const {
    const StoredPixel& pixel = pixels[i];
    PixelMoments moments = MomentsView(history)[i];
    const uint32_t inherited = moments.samples - pixel.fresh_samples;
    if (inherited <= kMixedSamples) return;
    const float fresh_per_inherited = static_cast<float>(pixel.fresh_samples) / static_cast<float>(inherited);
    const Rgb past = moments.mean + (moments.mean - pixel.fresh) * fresh_per_inherited;
    const uint32_t count = kMixedSamples + pixel.fresh_samples;
    moments.limit(count);
    moments.mean = pixel.fresh + (past - pixel.fresh) * (static_cast<float>(kMixedSamples) / static_cast<float>(count));
    history.store(i, moments);
  }

  RELUME_HD static void add_fresh(StoredPixel& pixel, const Rgb& value) {
    pixel.fresh += (value - pixel.fresh) / static_cast<float>(++pixel.fresh_samples);
  }
};

/// Drops stored samples that refer to no existing surface, as in a damaged checkpoint; one call per sample.
struct DropUnknownKernel {
  SceneView scene;
  View<StoredSample> stored;
  bool light_points = false;  ///< whether light samples are those of reservoirs

  RELUME_HD void operator()(uint32_t i, uint32_t) const {
    if (stored[i].valid() && !exists(stored[i])) stored[i] = StoredSample{};
  }

 private:
  /// Whether `x` can belong to FirstVertex::light_u.
  RELUME_HD bool may_choose_point(float x) const { return light_points ? std::fabs(x) <= 2.0f : x >= 0.0f && x < 1.0f; }

  RELUME_HD bool exists(const StoredSample& sample) const {
    const Hit& hit = sample.hit;
    return hit.instance < scene.instances.size &&
           hit.primitive < scene.meshes[scene.instances[hit.instance].mesh].triangle_count && is_finite(hit.u) &&
           is_finite(hit.v) && may_choose_point(sample.light_u.x) && may_choose_point(sample.light_u.y);
  }
};

}  // namespace relume
