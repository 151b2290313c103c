#include "builtin_scenes/builtin.h"

#include "builtin_scenes/scenes.h"
#include "relume/builtin_scenes.h"
#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

constexpr std::string_view kBase = "base of 40 to 60 rooms with sinking doors and flickering lamps (camera path)";

template <uint32_t seed>
Scene base() {
  return build_base(seed);
}

}  // namespace

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
      {"mine", "gallery with a bend, lit by sun and sky through its entrance (camera path)",
       [] { return build_mine("mine", 10); }},
      {"city", "instanced buildings, 19 million triangles under sun and sky (camera path)", build_city},
      {"lamp-room", "floor lamp that lights the ceiling, and a spotlight on a glass egg", build_lamp_room},
      {"furnace", "white sphere in uniform light: a correct image is 1 everywhere", build_furnace},
  };
  return scenes;
}

const std::vector<BuiltinScene>& experiment_scenes() {
  static const std::vector<BuiltinScene> scenes = {
      {"warehouse-rooms", "warehouse of 25 wide rooms with 14 lamps each (camera path)", build_warehouse_rooms},
      {"warehouse-140", "warehouse of 140 bays of 4.4 m with three lamps each (camera path)", build_warehouse_140},
      {"warehouse-399", "warehouse of 399 bays of 4.4 m with one lamp each (camera path)", build_warehouse_399},
      {"mine-sun-5", "mine with a sun of 5 degrees and equal irradiance (camera path)",
       [] { return build_mine("mine-sun-5", 5); }},
      {"mine-sun-2.5", "mine with a sun of 2.5 degrees and equal irradiance (camera path)",
       [] { return build_mine("mine-sun-2.5", 2.5f); }},
      {"mine-sun-1", "mine with a sun of 1 degree and equal irradiance (camera path)",
       [] { return build_mine("mine-sun-1", 1); }},
      {"skylight", "closed room with holes of 0.3, 1 and 2 m in its ceiling, under a sun of 1 degree", build_skylight},
      {"turntable-spot", "turntable with a narrow beam: the floor sees a small bright patch (animated)",
       build_turntable_spot},
      {"base-1", kBase, base<1>},
      {"base-2", kBase, base<2>},
      {"base-3", kBase, base<3>},
      {"base-4", kBase, base<4>},
      {"base-5", kBase, base<5>},
      {"base-6", kBase, base<6>},
      {"base-7", kBase, base<7>},
      {"base-8", kBase, base<8>},
      {"base-9", kBase, base<9>},
      {"base-10", kBase, base<10>},
  };
  return scenes;
}

const BuiltinScene* find_builtin_scene(std::string_view name) {
  for (const std::vector<BuiltinScene>* list : {&builtin_scenes(), &experiment_scenes()}) {
    for (const BuiltinScene& scene : *list) {
      if (scene.name == name) return &scene;
    }
  }
  return nullptr;
}

std::vector<BuiltinSceneInfo> list_builtin_scenes() {
  std::vector<BuiltinSceneInfo> list;
  for (const std::vector<BuiltinScene>* scenes : {&builtin_scenes(), &experiment_scenes()}) {
    for (const BuiltinScene& scene : *scenes) list.push_back({std::string(scene.name), std::string(scene.summary)});
  }
  return list;
}

Scene builtin_scene(const std::string& name) {
  if (const BuiltinScene* scene = find_builtin_scene(name)) return scene->build();
  std::vector<std::string> names;
  for (const BuiltinSceneInfo& scene : list_builtin_scenes()) names.push_back(scene.name);
  throw Error(ErrorCode::not_found, "there is no built-in scene '" + name + "'" + suggestion(name, names));
}

}  // namespace relume
