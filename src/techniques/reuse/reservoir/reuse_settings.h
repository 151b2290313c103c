// Declarations of the settings that all techniques share whose reservoirs move between pixels and frames.
#pragma once

#include <string_view>

#include "techniques/reuse/reservoir/settings.h"

namespace relume {

/// Appends declarations of `feedback`, `cap`, `neighbours` and `radius` of the settings `s`. `neighbours`: help text of
/// the third, a literal.
template <typename Settings>
void declare_reuse(SettingList& list, Settings& s, std::string_view neighbours) {
  list.insert(
      list.end(),
      {
          {"feedback", choice(s.feedback, {"temporal", "spatial"}),
           "Reservoirs that the next frame reuses: those before (temporal) or after (spatial) the reuse of "
           "neighbouring pixels"},
          {"cap",
           &s.cap,
           "Maximum weight of a reservoir's history, in frames; 0: no reuse of earlier frames",
           {.min = 0, .max = 1000}},
          {"neighbours", &s.neighbours, neighbours, {.min = 0, .max = kMostReuseNeighbours}},
          {"radius", &s.radius, "Maximum distance of these neighbours", {.min = 1, .max = 1000, .unit = "pixels"}},
      });
}

}  // namespace relume
