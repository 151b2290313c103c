// First kernel of ReSTIR DI: each pixel's own candidates, combined with the reservoir of its surface in the previous
// frame ([Bitterli20] alg. 5, with the weights of [Lin22]).
#pragma once

#include "techniques/reuse/reservoir/ris.h"
#include "techniques/reuse/restir_di/settings.h"
#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// The instance as it was placed in the previous frame. Meshes that deform keep their current shape.
RELUME_HD inline Instance previous_instance(const Instance& instance) {
  if (instance.in_world_space) return instance;
  Instance before = instance;
  before.to_world = instance.previous_to_world;
  before.normal_to_world = normal_matrix(before.to_world.linear);
  before.orientation = glm::dot(before.to_world.linear[0], before.normal_to_world[0]) < 0.0f ? -1.0f : 1.0f;
  return before;
}

struct TemporalReuseKernel {
  CandidateStage stage;
  BackwardReprojection reprojection;
  View<const LightReservoir> history;          ///< of the previous frame
  View<const ReceiverRecord> history_records;  ///< receivers of the previous frame
  View<LightReservoir> reservoirs;
  View<ReceiverRecord> records;
  ReservoirImage image;
  CameraView previous_camera;
  float cap = 0;
  bool traced = true;  ///< whether targets contain occlusion
  bool moved = false;  ///< whether instances were placed differently in the previous frame

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * stage.width + x;
    LightReservoir result;
    ReceiverRecord record;
    Receiver r;
    Sampler sampler = stage.index.sampler(x, y);
    if (stage.receive(x, y, sampler, record, r)) {
      ChoiceNumbers numbers(stage.index.seed, stage.index.frame, pixel, kChoosesCandidates);
      result = stage.choose(pixel, r, sampler, numbers, image.rays[pixel]);
      if (!is_finite(result.weight)) {
        image.radiance[pixel] += Rgb(result.weight);  // is counted there, and must not spread
        result.weight = 0;
      }
      reuse(x, y, r, numbers, result);
    } else {
      record = {};
    }
    reservoirs[pixel] = result;
    records[pixel] = record;
  }

 private:
  /// Combines `own` with the history of the receiver, if it has one.
  RELUME_HD void reuse(uint32_t x, uint32_t y, const Receiver& r, ChoiceNumbers& numbers, LightReservoir& own) const {
    const uint32_t pixel = y * stage.width + x;
    const uint32_t source = source_of(x, y, numbers.next());
    const float u = numbers.next();
    if (source == kNoSurface) return;
    LightReservoir before = history[source];
    before.confidence = relume::min(before.confidence, cap * own.confidence);
    if (!(before.confidence > 0.0f)) return;
    const SceneView& scene = stage.context.scene;
    const ReceiverRecord& record = history_records[source];
    const Instance& instance = scene.instances[record.hit.instance];
    // The previous shape of such a mesh is not fully known.
    if (moved && scene.meshes[instance.mesh].deforms) return;
    uint32_t& rays = image.rays[pixel];
    const auto now_target = [&](const LightPoint& point) {
      return target_at(scene, scene.lights, r, point, traced, rays);
    };
    const auto before_target = [&](const LightPoint& point) {
      Receiver old;
      make_receiver(scene, previous_camera, moved ? previous_instance(instance) : instance, record, old);
      return target_at(scene, previous_lights(), old, point, traced, rays);
    };
    own = traced ? combine_balanced(own, before, now_target, before_target, u)
                 : combine_basic(own, before, now_target, before_target, u);
  }

  /// The pixel that showed the surface in the previous frame: one of four, in proportion to its weight. kNoSurface:
  /// none.
  RELUME_HD uint32_t source_of(uint32_t x, uint32_t y, float u) const {
    if (!(cap > 0.0f)) return kNoSurface;
    const BackwardTaps taps = reprojection.taps(x, y);
    if (!taps.valid) return kNoSurface;
    float rest = u;
    for (int k = 0; k < 4; ++k) {
      if (!(taps.weights[k] > 0.0f)) continue;
      if (rest < taps.weights[k]) return taps.pixels[k];
      rest -= taps.weights[k];
    }
    return taps.heaviest();  // the weights sum to almost one
  }

  RELUME_HD LightsView previous_lights() const {
    LightsView lights = stage.context.scene.lights;
    lights.lights = lights.previous;
    return lights;
  }

  template <typename NowTarget, typename BeforeTarget>
  RELUME_HD static LightReservoir combine_basic(const LightReservoir& own, const LightReservoir& before,
                                                const NowTarget& now_target, const BeforeTarget& before_target,
                                                float u) {
    BasicCombination<LightPoint> combination;
    combination.add(own, 0, own.target, 0.0f);
    combination.add(before, 1, before.weight > 0.0f ? now_target(before.sample) : 0.0f, u);
    if (!combination.sample().valid()) return combination.finish(0.0f, 0.0f);
    const bool from_before = combination.chosen() == 1;
    const float now = from_before ? now_target(combination.sample()) : own.target;
    const float old = from_before ? before.target : before_target(combination.sample());
    return combination.finish(from_before ? old : now, own.confidence * now + before.confidence * old);
  }
};

}  // namespace relume
