// Errors of light selections in several scenes of one kind: geometric means, with 95 % intervals over the scenes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/measure/adapted_error.h"

namespace relume {

struct SelectionErrors {
  std::string name;
  double noise = 0;  ///< MSE of the reference over the counted pixels
  std::vector<AdaptedError> errors;
  ImageSet images;
};

/// Errors in rooms of one kind, each in another base.
struct RoomErrors {
  std::string kind;
  std::vector<SelectionErrors> bases;
};

/// Factor by which contender `b` has less error than `a` in the scenes.
Ratio mean_gain(const std::vector<SelectionErrors>& scenes, std::string_view a, std::string_view b);

/// Gains of all contenders over `tree`, also at equal time, and over `lists`.
TableBlock bases_table(const std::vector<SelectionErrors>& bases, std::string_view tree, std::string_view lists);

/// Gains of the other contenders over `tree`, a row for each kind of room.
TableBlock rooms_table(const std::vector<RoomErrors>& rooms, std::string_view tree);

}  // namespace relume
