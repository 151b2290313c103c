// How exploration weighs changed lights.
#pragma once

namespace relume {

/// Weight in exploration of a light that has changed.
enum class ChangeMeasure : int {
  flag,    ///< one for every such light
  amount,  ///< by the change of power and position
};

}  // namespace relume
