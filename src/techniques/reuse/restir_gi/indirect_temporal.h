// First kernel of ReSTIR GI: the sample of each pixel's path, combined with the reservoir of its surface in the
// previous frame ([Ouyang21], with the weights of [Lin22]). Pixels without a path keep that reservoir.
#pragma once

#include "techniques/reuse/reservoir/history_source.h"
#include "techniques/reuse/restir_gi/indirect_image.h"

namespace relume {

struct IndirectTemporalKernel {
  SceneView scene;
  SampleIndex index;
  ReconnectionRule rule;
  View<const Hit> hits;
  View<const IndirectSample> samples;
  ReservoirHistory<IndirectVertex> history;
  View<const Rgb> validated;  ///< radiance of `history` in this frame; empty: as stored
  View<IndirectReservoir> reservoirs;
  View<ReceiverRecord> records;
  IndirectImage image;
  uint32_t max_bounces = 0;
  bool traced = true;  ///< whether targets contain occlusion
  uint32_t width = 0;
  float wavelength_nm = kNoWavelength;  ///< as in CandidateStage

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (!image.planes.sampled.has(pixel)) return keep(x, y);
    IndirectReservoir result;
    ReceiverRecord record;
    Receiver r;
    const Sampler sampler = index.sampler(x, y);
    if (receive(x, y, sampler, record, r)) {
      result = own_reservoir(pixel, r);
      ChoiceNumbers numbers(index.seed, index.frame, pixel, kChoosesIndirectHistory);
      reuse(x, y, record, r, numbers, result);
    } else {
      record = {};
    }
    reservoirs[pixel] = result;
    records[pixel] = record;
  }

 private:
  RELUME_HD void keep(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    ChoiceNumbers numbers(index.seed, index.frame, pixel, kChoosesIndirectHistory);
    IndirectReservoir& kept = reservoirs[pixel];
    const uint32_t source = history.keep(scene, x, y, numbers.next(), kept, records[pixel]);
    if (!(kept.weight > 0.0f)) return;
    if (!exists(scene, kept.sample.hit())) {
      kept = {};
    } else if (!validated.empty()) {
      follow_light(validated[source], kept);
    }
  }

  /// Fills the receiver of pixel (x, y). Returns false if the pixel does not reuse samples. Its own is then added to
  /// the image.
  RELUME_HD bool receive(uint32_t x, uint32_t y, const Sampler& sampler, ReceiverRecord& record, Receiver& r) const {
    const uint32_t pixel = y * width + x;
    if (!hits[pixel].valid() || max_bounces < 2) return false;
    record = record_of(scene, x, y, sampler, hits[pixel]);
    if (wavelength_nm != kNoWavelength) record.wavelength_nm = wavelength_nm;
    make_receiver(scene, record, r);
    if (!has_non_delta(r.sp.bsdf)) return false;
    if (rule.receives(r.sp)) return true;
    const IndirectSample& sample = samples[pixel];
    if (!(sample.weight > 0.0f)) return false;
    const Reconnection c = reconnect(r.sp.position, place_of(scene, sample.vertex));
    if (!(c.geometry() > 0.0f)) return false;
    ChoiceNumbers numbers(index.seed, index.frame, pixel, kChoosesIndirectRecord);
    image.add(scene, r, c, sample.vertex.radiance, sample.weight / c.geometry(), pixel, numbers.next());
    return false;
  }

  /// The sample of the pixel's path, whose vertex is visible.
  RELUME_HD IndirectReservoir own_reservoir(uint32_t pixel, const Receiver& r) const {
    IndirectReservoir own;
    own.confidence = 1;
    const IndirectSample& sample = samples[pixel];
    if (!(sample.weight > 0.0f)) return own;
    own.sample = sample.vertex;
    // Whether a ray hits a surface with stochastic alpha differs between receivers.
    const Hit hit = own.sample.hit();
    if (opacity(scene, hit.instance, hit.primitive, hit.u, hit.v) < 1.0f) own.sample.traits |= IndirectVertex::kBound;
    const Reconnection c = reconnect(r.sp.position, place_of(scene, own.sample));
    own.target = target_from(scene, r, c, own.sample.radiance);
    if (own.target > 0.0f) own.weight = sample.weight / c.geometry();
    if (is_finite(own.weight) && is_finite(own.target)) return own;
    image.planes.radiance[pixel] += Rgb(own.weight * own.target);  // is counted there, and must not spread
    own.weight = 0;
    own.target = 0;
    return own;
  }

  /// Combines `own` with the history of the receiver, if it has one.
  RELUME_HD void reuse(uint32_t x, uint32_t y, const ReceiverRecord& record, const Receiver& r, ChoiceNumbers& numbers,
                       IndirectReservoir& own) const {
    const float u_source = numbers.next();
    const float u = numbers.next();
    const uint32_t source = history.find(scene, x, y, u_source);
    if (source == kNoSurface) return;
    IndirectReservoir before = history.at(source, history.cap * own.confidence);
    if (before.weight > 0.0f && !exists(scene, before.sample.hit())) return;
    if (!validated.empty()) follow_light(validated[source], before);
    if (history.moved && before.weight > 0.0f)
      turn_normal(previous_to_current(scene, before.sample.hit()), before.sample);
    uint32_t& rays = image.planes.rays[y * width + x];
    const Vec3 here = position_of(record);
    const Vec3 there = position_of(history.records[source]);
    const auto now_target = [&](const IndirectVertex& vertex) {
      const SurfacePlace place = place_of(scene, vertex);
      return connects(vertex, place, here, there) ? moved_target(scene, r, vertex, place, traced, rays) : 0.0f;
    };
    const auto before_target = [&](const IndirectVertex& vertex) {
      const SurfacePlace place = place_of(scene, vertex);
      return connects(vertex, place, here, there) ? old_target(source, vertex, rays) : 0.0f;
    };
    own = traced ? combine_balanced(own, before, now_target, before_target, u)
                 : combine_basic(own, before, now_target, before_target, u);
  }

  /// Whether a vertex moves between the pixel's receivers of this frame and the previous one.
  RELUME_HD bool connects(const IndirectVertex& vertex, const SurfacePlace& now, const Vec3& here,
                          const Vec3& there) const {
    if (!rule.moves(vertex)) return false;
    const SurfacePlace old = history.moved ? old_place(vertex) : now;
    return rule.connects(reconnect(here, now).geometry(), reconnect(there, old).geometry());
  }

  RELUME_HD SurfacePlace old_place(const IndirectVertex& vertex) const {
    return place_of(scene, previous_instance(scene.instances[vertex.instance]), vertex);
  }

  /// p̂ at the receiver of a pixel in the previous frame.
  RELUME_HD float old_target(uint32_t source, const IndirectVertex& vertex, uint32_t& rays) const {
    Receiver old;
    make_receiver(scene, scene.previous_camera, history.instance_of(scene, source), history.records[source], old);
    if (!history.moved) return moved_target(scene, old, vertex, place_of(scene, vertex), traced, rays);
    IndirectVertex turned = vertex;
    turn_normal(glm::inverse(previous_to_current(scene, vertex.hit())), turned);
    return moved_target(scene, old, turned, old_place(vertex), traced, rays);
  }

  /// Gives a reservoir the radiance that its sample has now. The more it has changed, the less the history counts.
  RELUME_HD static void follow_light(const Rgb& now, IndirectReservoir& before) {
    const Rgb old = before.sample.radiance;
    if (now == old || !(before.weight > 0.0f)) return;
    const float a = luminance(old);
    const float b = luminance(now);
    before.sample.radiance = now;
    before.target *= a > 0.0f ? b / a : 0.0f;
    before.confidence *= relume::min(a, b) / relume::max(relume::max(a, b), 1e-30f);
    if (!is_finite(before.target)) before.confidence = 0;
  }
};

}  // namespace relume
