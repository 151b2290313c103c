// Kernel that traces paths of reused samples again, with their own random numbers: histories then follow changes of
// lights and geometry. Where nothing has changed, the light has the same bits.
#pragma once

#include "techniques/reuse/restir_gi/reconnection.h"
#include "techniques/transport/path/walk.h"

namespace relume {

/// Removes the emission of the first vertex, which is not part of samples.
struct ValidationPolicy : NoPolicy {
  bool reached = false;  ///< whether the vertex scatters

  RELUME_HD bool arrived(const SurfacePoint&, PathState& path) {
    if (reached) return true;
    reached = true;
    path.radiance = Rgb(0);
    return true;
  }
};

/// Finds the radiance that the samples of the previous frame's reservoirs have now.
struct IndirectValidationKernel {
  PathContext context;
  SampleIndex index;  ///< of this frame
  ReconnectionRule rule;
  View<const IndirectReservoir> history;  ///< of the previous frame
  View<const ReceiverRecord> records;     ///< of the previous frame
  View<Rgb> radiance;                     ///< by pixel of the previous frame
  View<uint32_t> rays;
  uint32_t interval = 1;  ///< frames between repetitions
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const IndirectReservoir reservoir = history[pixel];
    radiance[pixel] = reservoir.sample.radiance;
    if (!(reservoir.weight > 0.0f) || !due(reservoir.sample)) return;
    radiance[pixel] = trace_again(reservoir.sample, position_of(records[pixel]), rays[pixel]);
  }

 private:
  /// All copies of a sample are due in the same frame. Otherwise, old light could survive by moving between pixels.
  RELUME_HD bool due(const IndirectVertex& vertex) const {
    return rule.moves(vertex) && (hash(vertex.pixel) % interval + index.frame) % interval == 0;
  }

  /// Light from the vertex to `receiver`; black if the vertex no longer exists or shows its other side.
  RELUME_HD Rgb trace_again(const IndirectVertex& vertex, const Vec3& receiver, uint32_t& ray_count) const {
    const SceneView& scene = context.scene;
    Hit hit = vertex.hit();
    if (!exists(scene, hit)) return Rgb(0);
    const Reconnection c = reconnect(receiver, place_of(scene, vertex));
    if (!(c.cosine > 0.0f)) return Rgb(0);
    SampleIndex repeated = index;
    repeated.seed = vertex.seed;  // that of the frame can differ, as after movements of the camera
    repeated.sequence = vertex.sequence;
    repeated.sample = vertex.element;
    repeated.taken = {};
    Sampler sampler = repeated.sampler(vertex.pixel % width, vertex.pixel / width);
    PathState path;  // as after the first bounce of a path whose light is taken (IndirectSamplePolicy)
    path.ray = {receiver, c.wi, kInfinity};
    path.wavelength_nm = path_wavelength(scene, sampler);
    path.indirect = true;
    path.bounce = 1;
    hit.t = c.distance;
    SurfacePoint sp;
    sp.position = receiver;
    sp.bsdf.lobe_count = 0;
    ValidationPolicy policy;
    walk(context, hit, sp, path, sampler, policy);
    ray_count += path.rays;
    return policy.reached && is_finite(path.radiance) ? path.radiance : Rgb(0);
  }
};

}  // namespace relume
