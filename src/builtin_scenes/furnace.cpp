// A white sphere in uniform light from all directions: every pixel of a correct image is 1.
#include "builtin_scenes/builder.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {

Scene build_furnace() {
  SceneBuilder builder("furnace");
  const Index white = builder.add_material(matte("white", Rgb(1)));
  // Flat: interpolated normals would send some directions into the surface, and their light would be lost.
  builder.add("sphere", flat_shaded(icosphere(1.0f, 4)), white);
  builder.add_camera({0, 0, 4}, {0, 0, 0}, 40);
  Environment environment;
  environment.kind = EnvironmentKind::constant;
  environment.color = Rgb(1);
  builder.set_environment(environment);
  return builder.take();
}

}  // namespace relume
