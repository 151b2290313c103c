#include "builtin_scenes/shelves.h"

#include <string>
#include <utility>

#include "builtin_scenes/shapes.h"
#include "core/hash.h"

namespace relume {
namespace {

Mesh shelf_frame() {
  Mesh mesh;
  for (const float x : {-1.8f, 1.72f}) {
    for (const float z : {-0.45f, 0.37f}) append(mesh, box({x, -0.01f, z}, {x + 0.08f, 2.5f, z + 0.08f}));
  }
  for (const float y : {0.25f, 1.05f, 1.85f}) append(mesh, box({-1.72f, y, -0.44f}, {1.72f, y + 0.04f, 0.44f}));
  return mesh;
}

/// Adds boxes on the boards, distributed over `parts` by a hash.
void shelf_load(Mesh (&parts)[3]) {
  uint32_t n = 0;
  for (const float y : {0.29f, 1.09f, 1.89f}) {
    float x = -1.65f;
    while (true) {
      const float width = 0.3f + 0.45f * to_unit_float(hash(n, 1u));
      if (x + width > 1.65f) break;
      const float height = 0.2f + 0.4f * to_unit_float(hash(n, 2u));
      const float depth = 0.25f + 0.14f * to_unit_float(hash(n, 3u));
      append(parts[hash(n, 4u) % 3], box({x, y - 0.005f, -depth}, {x + width, y + height, depth}));
      x += width + 0.04f + 0.2f * to_unit_float(hash(n, 5u));
      ++n;
    }
  }
}

}  // namespace

void add_shelves(SceneBuilder& builder, const std::vector<Mat4>& places) {
  const Index steel = builder.add_material(glossy("steel", {0.18f, 0.25f, 0.4f}, 0.35f));
  builder.add_instances("shelves", builder.add_mesh("shelves", shelf_frame(), steel), places);
  Mesh load[3];
  shelf_load(load);
  const Material materials[3] = {matte("cardboard", {0.52f, 0.38f, 0.24f}),
                                 glossy("crates", {0.55f, 0.16f, 0.1f}, 0.4f), matte("paper", {0.7f, 0.68f, 0.62f})};
  for (int k = 0; k < 3; ++k) {
    const std::string name = materials[k].name;
    builder.add_instances(name, builder.add_mesh(name, std::move(load[k]), builder.add_material(materials[k])), places);
  }
}

}  // namespace relume
