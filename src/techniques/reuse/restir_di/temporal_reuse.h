// First kernel of ReSTIR DI: each pixel's own candidates, combined with the reservoir of its surface in the previous
// frame ([Bitterli20] alg. 5, with the weights of [Lin22]). Pixels without a path keep that reservoir.
#pragma once

#include "techniques/reuse/reservoir/history_source.h"
#include "techniques/reuse/reservoir/ris.h"
#include "techniques/reuse/restir_di/settings.h"

namespace relume {

struct TemporalReuseKernel {
  CandidateStage stage;
  ReservoirHistory<LightPoint> history;
  View<LightReservoir> reservoirs;
  View<ReceiverRecord> records;
  ReservoirImage image;
  CameraView previous_camera;
  bool traced = true;  ///< whether targets contain occlusion

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * stage.width + x;
    if (!image.planes.sampled.has(pixel)) return keep(x, y);
    LightReservoir result;
    ReceiverRecord record;
    Receiver r;
    Sampler sampler = stage.index.sampler(x, y);
    if (stage.receive(x, y, sampler, record, r)) {
      ChoiceNumbers numbers(stage.index.seed, stage.index.frame, pixel, kChoosesCandidates);
      result = stage.choose(pixel, r, sampler, numbers, image.planes.rays[pixel]);
      if (!is_finite(result.weight)) {
        image.planes.radiance[pixel] += Rgb(result.weight);  // is counted there, and must not spread
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
  RELUME_HD void keep(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * stage.width + x;
    ChoiceNumbers numbers(stage.index.seed, stage.index.frame, pixel, kChoosesCandidates);
    history.keep(stage.context.scene, x, y, numbers.next(), reservoirs[pixel], records[pixel]);
  }

  /// Combines `own` with the history of the receiver, if it has one.
  RELUME_HD void reuse(uint32_t x, uint32_t y, const Receiver& r, ChoiceNumbers& numbers, LightReservoir& own) const {
    const uint32_t pixel = y * stage.width + x;
    const float u_source = numbers.next();
    const float u = numbers.next();
    const SceneView& scene = stage.context.scene;
    const uint32_t source = history.find(scene, x, y, u_source);
    if (source == kNoSurface) return;
    const LightReservoir before = history.at(source, history.cap * own.confidence);
    uint32_t& rays = image.planes.rays[pixel];
    const auto now_target = [&](const LightPoint& point) {
      return target_at(scene, scene.lights, r, point, traced, rays);
    };
    const auto before_target = [&](const LightPoint& point) {
      Receiver old;
      make_receiver(scene, previous_camera, history.instance_of(scene, source), history.records[source], old);
      return target_at(scene, previous_lights(), old, point, traced, rays);
    };
    own = traced ? combine_balanced(own, before, now_target, before_target, u)
                 : combine_basic(own, before, now_target, before_target, u);
  }

  RELUME_HD LightsView previous_lights() const {
    LightsView lights = stage.context.scene.lights;
    lights.lights = lights.previous;
    return lights;
  }
};

}  // namespace relume
