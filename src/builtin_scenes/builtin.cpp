#include "builtin_scenes/builtin.h"

#include "builtin_scenes/scenes.h"

namespace relume {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = {
      {"cornell", "Cornell box with two slightly glossy boxes", build_cornell},
      {"cornell-closed", "closed Cornell box, seen from inside (camera path)", build_cornell_closed},
      {"cornell-spheres", "Cornell box with a mirror and a glass sphere", build_cornell_spheres},
      {"cornell-mirror", "Cornell box with a mirror sphere in front of a mirror wall", build_cornell_mirror},
      {"cornell-water", "Cornell box with waves under a small lamp: caustics on the floor and walls",
       build_cornell_water},
      {"cornell-glass", "Cornell box with glass spheres under a small lamp: caustics", build_cornell_glass},
      {"corridor", "corridor with three bends before its only lamp: light after several reflections (camera path)",
       build_corridor},
      {"warehouse", "hall and 256 narrow bays with one lamp each, most of them hidden (camera path)", build_warehouse},
      {"cover", "knot of a million triangles under ten lamps behind a grille", build_cover},
      {"turntable", "lamp that rotates below a floor inside a round wall: moving indirect light (animated)",
       build_turntable},
      {"slit", "lamps that move behind a slit: fast, sharp shadows (animated)", build_slit},
      {"door", "pots in a room that is lit only through the gap of a door", build_door},
      {"mine", "gallery with a bend, lit by sun and sky through its entrance (camera path)", build_mine},
      {"city", "instanced buildings, 19 million triangles under sun and sky (camera path)", build_city},
      {"lamp-room", "floor lamp that lights the ceiling, and a spotlight on a glass egg", build_lamp_room},
      {"furnace", "white sphere in uniform light: a correct image is 1 everywhere", build_furnace},
  };
  return scenes;
}

const BuiltinScene* find_builtin_scene(std::string_view name) {
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (scene.name == name) return &scene;
  }
  return nullptr;
}

}  // namespace relume
