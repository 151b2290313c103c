#include "scene_io/pbrt/equal_area.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "core/vec.h"

namespace relume::pbrt {
namespace {

/// Pixel of an image, also beyond an edge: there the square is turned by half a turn about the edge's middle.
const Rgb& pixel(const Image& image, int x, int y) {
  const int n = image.width;
  if (x < 0 || x >= n) {
    x = x < 0 ? -1 - x : 2 * n - 1 - x;
    y = n - 1 - y;
  }
  if (y < 0 || y >= n) {
    y = y < 0 ? -1 - y : 2 * n - 1 - y;
    x = n - 1 - x;
  }
  return image.at(std::clamp(x, 0, n - 1), std::clamp(y, 0, n - 1));
}

}  // namespace

Vec3 direction_of_square(const Vec2& point) {
  const Vec2 signed_point = 2.0f * point - 1.0f;
  const Vec2 p = glm::abs(signed_point);
  const float from_diagonal = 1 - (p.x + p.y);
  const float r = 1 - std::fabs(from_diagonal);
  const float phi = (r == 0 ? 1 : (p.y - p.x) / r + 1) * kPi / 4;
  const float width = r * std::sqrt(std::max(0.0f, 2 - r * r));
  return {std::copysign(std::cos(phi), signed_point.x) * width, std::copysign(std::sin(phi), signed_point.y) * width,
          std::copysign(1 - r * r, from_diagonal)};
}

Vec2 square_of_direction(const Vec3& direction) {
  const Vec3 d = glm::abs(direction);
  const float r = std::sqrt(std::max(0.0f, 1 - d.z));
  const float turn = d.x == 0 && d.y == 0 ? 0.0f : std::atan2(d.y, d.x) * 2 / kPi;  // in quarters
  Vec2 p(r - r * turn, r * turn);
  if (direction.z < 0) p = {1 - p.y, 1 - p.x};
  return (Vec2(std::copysign(p.x, direction.x), std::copysign(p.y, direction.y)) + 1.0f) / 2.0f;
}

Rgb look_up(const Image& image, const Vec3& direction) {
  const auto n = static_cast<float>(image.width);
  const Vec2 p = square_of_direction(direction) * n - 0.5f;
  const Vec2 low = glm::floor(p);
  const Vec2 part = p - low;
  const auto x = static_cast<int>(low.x);
  const auto y = static_cast<int>(low.y);
  return glm::mix(glm::mix(pixel(image, x, y), pixel(image, x + 1, y), part.x),
                  glm::mix(pixel(image, x, y + 1), pixel(image, x + 1, y + 1), part.x), part.y);
}

}  // namespace relume::pbrt
