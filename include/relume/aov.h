// Arbitrary output variables: layers beside the image.
#pragma once

#include <string>

namespace relume {

struct AovLayer {
  std::string name;
  std::string help;  ///< what it shows
};

}  // namespace relume
