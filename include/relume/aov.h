// Arbitrary output variables: layers written beside the image.
#pragma once

#include <string>

namespace relume {

/// A layer that Session::aov() can provide.
struct AovLayer {
  std::string name;
  std::string help;  ///< quantity that the layer shows
};

}  // namespace relume
