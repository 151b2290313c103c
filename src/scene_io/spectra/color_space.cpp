#include "scene_io/spectra/color_space.h"

#include <glm/matrix.hpp>

namespace relume {
namespace {

/// Chromaticities of the primaries and of white.
struct Chromaticities {
  Vec2 red, green, blue, white;
};

constexpr Vec2 kD65(0.31271f, 0.32902f);

Chromaticities chromaticities(ColorSpace space) {
  switch (space) {
    case ColorSpace::srgb: break;
    case ColorSpace::dci_p3: return {{0.680f, 0.320f}, {0.265f, 0.690f}, {0.150f, 0.060f}, kD65};
    case ColorSpace::rec2020: return {{0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, kD65};
    case ColorSpace::aces2065_1: return {{0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.077f}, {0.32168f, 0.33767f}};
  }
  return {{0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f}, kD65};
}

/// XYZ with Y = 1.
Vec3 xyz_of(const Vec2& xy) { return Vec3(xy.x, xy.y, 1 - xy.x - xy.y) / xy.y; }

/// XYZ with X + Y + Z = 1.
Vec3 direction_of(const Vec2& xy) { return {xy.x, xy.y, 1 - xy.x - xy.y}; }

}  // namespace

std::optional<ColorSpace> color_space_named(std::string_view name) {
  if (name == "srgb") return ColorSpace::srgb;
  if (name == "dci-p3") return ColorSpace::dci_p3;
  if (name == "rec2020") return ColorSpace::rec2020;
  if (name == "aces2065-1") return ColorSpace::aces2065_1;
  return std::nullopt;
}

Mat3 xyz_from(ColorSpace space) {
  const Chromaticities c = chromaticities(space);
  const Mat3 primaries(direction_of(c.red), direction_of(c.green), direction_of(c.blue));
  const Vec3 scale = glm::inverse(primaries) * xyz_of(c.white);
  return Mat3(primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z);
}

Mat3 rec709_from(ColorSpace space) {
  if (space == ColorSpace::srgb) return Mat3(1);
  return glm::inverse(xyz_from(ColorSpace::srgb)) * xyz_from(space);
}

}  // namespace relume
