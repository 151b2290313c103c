#include "techniques/spatial/markov_grid/settings.h"

#include "techniques/spatial/markov_grid/markov_grid.h"

namespace relume {

SettingList describe(MarkovGridSettings& s) {
  return {
      {"cells",
       &s.cells,
       "Number of cells drawn at a vertex; samples follow the mixture of their states",
       {.min = 1, .max = kMostDrawnCells}},
      {"adaptive-share",
       &s.adaptive_share,
       "Fraction of the drawn cells from the grid whose cells grow with the distance from the camera; the others are "
       "from the grid with cells of one size, which keeps its states while the camera moves",
       {.min = 0, .max = 1}},
      {"cell-size",
       &s.cell_size,
       "Edge length of the smallest adaptive cells at the camera's distance",
       {.min = 0.5, .max = 1024, .unit = "pixels"}},
      {"static-cells",
       &s.static_cells,
       "Number of static cells along the longest edge of the scene; cells have edges of a power of two in metres",
       {.min = 1, .max = 1 << 20}},
      {"slots",
       &s.slots,
       "Slots of the adaptive grid's table per pixel and recorded vertex; cells with equal slots replace each other",
       {.min = 1, .max = 64}},
      {"static-slots", &s.static_slots, "Slots of the static grid's table", {.min = 1, .max = 1 << 26}},
      {"vertices",
       &s.vertices,
       "Number of vertices of each path, from the camera on, that write to cells",
       {.min = 1, .max = kMostChainVertices}},
  };
}

}  // namespace relume
