// Sessions on memory that is closed to the host between launches.
#pragma once

#include "render/session.h"
#include "testing/walled_memory.h"

namespace relume::support {

/// Searches the records of the scene for addresses, except lights, whose unused bytes may look like one.
inline void check_records(testing::WalledMemory& memory, const SceneView& scene) {
  memory.check_elements("meshes", scene.meshes);
  memory.check_elements("instances", scene.instances);
  memory.check_elements("materials", scene.materials);
  memory.check_elements("layers", scene.layers);
  memory.check_elements("textures", scene.textures.records);
  memory.check_elements("textured emitters", scene.lights.textured.triangles);
  memory.check_elements("instances of the BVH", scene.accel.bvh.instances);
}

/// Records forbidden accesses of a session on `memory`, which stays closed to the host between launches.
inline void watch_accesses(Session& session, testing::WalledMemory& memory) {
  on_launch(session, [&](const LaunchEvent& event) {
    const SceneView& scene = compiled_scene(session).view();
    switch (event.kind) {
      case LaunchEvent::Kind::kernel:
        memory.announce_kernel();
        memory.permit(scene.accel.host.data);
        return memory.check_kernel(event.name, event.argument);
      case LaunchEvent::Kind::begins: memory.begin_launch(event.name); return check_records(memory, scene);
      case LaunchEvent::Kind::ends: return memory.end_launch();
    }
  });
  memory.end_launch();
}

}  // namespace relume::support
