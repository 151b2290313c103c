#include "viewer/render/display_transform.h"

#include <algorithm>
#include <cmath>

namespace relume::viewer {

Rgb palette_color(float t) {
  const float angle = 2 * kPi * (0.5f / 3 + 1 - 1.5f * t);
  const float amplitude = 0.5f * t * (1 - t);
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  return {saturate(t + amplitude * (-0.14861f * c + 1.78277f * s)),
          saturate(t + amplitude * (-0.29227f * c - 0.90649f * s)), saturate(t + amplitude * (1.97294f * c))};
}

}  // namespace relume::viewer
