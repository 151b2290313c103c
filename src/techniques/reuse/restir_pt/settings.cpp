#include "techniques/reuse/restir_pt/settings.h"

#include "techniques/reuse/reservoir/reuse_settings.h"

namespace relume {

SettingList describe(RestirPtSettings& s) {
  SettingList list = {
      {"shift", choice(s.shift, {"reconnection", "replay", "hybrid"}),
       "How paths move between pixels. reconnection: their second vertex is kept and connected; replay: their random "
       "numbers are kept; hybrid: random numbers up to the first connectible pair of vertices, all vertices after it"},
      {"connect", choice(s.connect, {"distance-2022", "footprint"}),
       "Which vertices are connectible with shift hybrid. distance-2022: rough ones, at a minimum distance; footprint: "
       "those that the path reaches with a large spread, compared with the footprint of a pixel"},
      {"correction",
       choice(s.correction, {"exact", "lagging", "basic", "constant"}),
       "Weights of reservoirs. exact: without history where lights or geometry change: unbiased; lagging: histories "
       "survive such changes, with bias there; basic: the same with weights that ignore occlusion, darker near edges; "
       "constant: the same with weights by confidence alone, at half the cost, darker where paths cannot move",
       {.biases = true}},
  };
  declare_reuse(
      list, s,
      "Number of neighbouring pixels whose reservoirs a pixel reuses, with up to two shifts of paths each; 0: none");
  list.insert(
      list.end(),
      {
          {"reciprocal", &s.reciprocal,
           "Whether neighbours come in pairs that reuse each other, with half as many shifts of paths. Pairs lie in "
           "tiles, whose edge is the greatest power of two up to twice restir-pt.radius"},
          {"duplication",
           &s.duplication,
           "Strength with which a history counts less where the pixels around it have the same path, so that blotches "
           "fade sooner; 0: not at all. A small bias",
           {.min = 0, .max = 1, .biases = true}},
          {"textures", choice(s.textures, {"finest", "cones"}),
           "Levels of textures beyond primary hits. finest: full resolution; cones: by the footprint of the pixel, as "
           "with path tracing, up to the vertex that paths keep when they move, and full resolution after it"},
          {"roughness",
           &s.roughness,
           "Minimum roughness of both vertices of a connectible pair, with connect distance-2022",
           {.min = 0, .max = 1}},
          {"distance",
           &s.distance,
           "Minimum distance of the vertices of a connectible pair, with connect distance-2022; it must suit the "
           "scene's size",
           {.min = 0, .max = 1e6, .unit = "m"}},
          {"footprint",
           &s.footprint,
           "Minimum area over which a path's direction spreads at a connectible vertex, as a fraction of the area at "
           "the primary hit over which a uniform direction from the camera spreads, with connect footprint",
           {.min = 0, .max = 1}},
      });
  return list;
}

}  // namespace relume
