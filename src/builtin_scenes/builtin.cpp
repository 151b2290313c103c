#include "builtin_scenes/builtin.h"

#include "builtin_scenes/scenes.h"

namespace relume {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = {
      {"cornell", "Cornell box with two slightly glossy boxes", build_cornell},
      {"cornell-closed", "the Cornell box with a front wall, seen from inside (camera path)", build_cornell_closed},
      {"cornell-spheres", "Cornell box with a mirror and a glass sphere", build_cornell_spheres},
      {"cornell-mirror", "Cornell box with a mirror sphere before a mirror wall", build_cornell_mirror},
      {"cornell-water", "Cornell box with waves under a small lamp: caustics on floor and walls", build_cornell_water},
      {"cornell-glass", "Cornell box with glass spheres under a small lamp: caustics", build_cornell_glass},
      {"corridor", "three bends before the only lamp: light after several reflections (camera path)", build_corridor},
      {"warehouse", "a hall and 256 narrow bays with a lamp each, nearly all hidden (camera path)", build_warehouse},
      {"cover", "knot of a million triangles under ten lamps behind a grille", build_cover},
      {"turntable", "lamp turning below a floor inside a round wall: indirect light that moves (animated)",
       build_turntable},
      {"slit", "lamps travelling behind a slit: quick, sharp shadows (animated)", build_slit},
      {"door", "pots in a room lit only through the gap of a door", build_door},
      {"mine", "gallery lit through its mouth by sun and sky, round a bend (camera path)", build_mine},
      {"city", "instanced buildings, 19 million triangles under sun and sky (camera path)", build_city},
      {"lamp-room", "a floor lamp that lights the ceiling and a spotlight on a glass egg", build_lamp_room},
      {"furnace", "white sphere in uniform light: a right image is 1 everywhere", build_furnace},
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
