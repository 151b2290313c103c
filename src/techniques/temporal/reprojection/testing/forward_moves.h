// Scenes and outcomes for tests of forward reprojection.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "framebuffer/shared_buffers.h"
#include "render/session.h"
#include "render/testing/copy_of.h"
#include "techniques/temporal/reprojection/reprojection_pass.h"

namespace relume::testing {

/// The Cornell box, with one surface for all materials.
inline Scene cornell_of(float roughness, float metallic, float specular) {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    m.roughness = roughness;
    m.metallic = metallic;
    m.specular = specular;
  }
  return scene;
}
inline Scene matte_cornell() { return cornell_of(1, 0, 0); }
inline Scene metal_cornell() { return cornell_of(0.3f, 1, 0.5f); }
inline Scene varnished_cornell() { return cornell_of(0.5f, 0, 0.5f); }

/// Moves the camera to its right, metres.
inline void shift_camera(Session& session, float distance) {
  CameraPose camera = session.camera();
  camera.to_world[3] += distance * camera.to_world[0];
  session.set_camera(camera);
}

/// Outcomes of the previous frame's histories.
struct Outcomes {
  explicit Outcomes(const Session& session) : reasons(copy_of(session, kHistoryRejectReason)) {}
  int count(RejectReason reason) const {
    return static_cast<int>(std::count(reasons.begin(), reasons.end(), static_cast<uint32_t>(reason)));
  }
  int kept() const { return count(RejectReason::none) + count(RejectReason::covered); }

  std::vector<uint32_t> reasons;
};

/// Outcomes of a move of the camera after eight frames.
inline Outcomes after_a_move(Scene scene, const RenderSettings& settings, float distance) {
  Session session(std::move(scene), settings);
  for (int i = 0; i < 8; ++i) session.render_frame();
  shift_camera(session, distance);
  session.render_frame();
  return Outcomes(session);
}

}  // namespace relume::testing
