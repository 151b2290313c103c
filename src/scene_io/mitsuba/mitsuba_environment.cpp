// Environment maps of Mitsuba scenes.
#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "core/parallel.h"
#include "relume/error.h"
#include "relume/scene_io.h"
#include "scene_io/mitsuba/mitsuba_emitters.h"

namespace relume::mitsuba {
namespace {

/// Looks up `map` in direction `w`, bilinearly; Environment's convention.
Rgb look_up(const Environment& map, const Vec3& w) {
  const float u = (0.5f + std::atan2(w.x, -w.z) / (2 * kPi)) * static_cast<float>(map.width) - 0.5f;
  const float v = std::acos(clamp(w.y, -1, 1)) / kPi * static_cast<float>(map.height) - 0.5f;
  const auto texel = [&](float x, float y) {
    const int column = static_cast<int>(x);
    const int row = std::clamp(static_cast<int>(y), 0, map.height - 1);
    return map.map[static_cast<size_t>(row) * static_cast<size_t>(map.width) +
                   static_cast<size_t>((column % map.width + map.width) % map.width)];
  };
  const float x = std::floor(u);
  const float y = std::floor(v);
  return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), u - x), glm::mix(texel(x, y + 1), texel(x + 1, y + 1), u - x),
                  v - y);
}

/// The map as seen after turning by `to_map`, from world space.
std::vector<Rgb> resampled(const Environment& map, const Mat3& to_map) {
  std::vector<Rgb> pixels(map.map.size());
  parallel_for(static_cast<size_t>(map.height), [&](size_t y) {
    const float theta = (static_cast<float>(y) + 0.5f) / static_cast<float>(map.height) * kPi;
    for (int x = 0; x < map.width; ++x) {
      const float phi = ((static_cast<float>(x) + 0.5f) / static_cast<float>(map.width) - 0.5f) * 2 * kPi;
      const Vec3 w(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
      pixels[y * static_cast<size_t>(map.width) + static_cast<size_t>(x)] = look_up(map, glm::normalize(to_map * w));
    }
  });
  return pixels;
}

/// Angle of a rotation about +Y; std::nullopt for other matrices.
std::optional<double> angle_about_y(const glm::dmat3& m) {
  constexpr double kTolerance = 1e-5;
  const double angle = std::atan2(m[2].x, m[2].z);
  const glm::dmat3 turned(glm::dvec3(std::cos(angle), 0, -std::sin(angle)), glm::dvec3(0, 1, 0),
                          glm::dvec3(std::sin(angle), 0, std::cos(angle)));
  for (int c = 0; c < 3; ++c) {
    if (glm::length(m[c] - turned[c]) > kTolerance) return std::nullopt;
  }
  return angle;
}

}  // namespace

void import_environment_map(const Parameters& p, Import& import) {
  Environment& environment = import.scene.environment;
  p.ignore({"mis_compensation"});
  const std::string reference = p.text("filename", "");
  const std::optional<std::filesystem::path> file = import.files.find(reference);
  if (!file) p.fail(fmt::format("its filename '{}' names no file; correct it", reference.substr(0, 80)));
  try {
    if (std::error_code error; std::filesystem::exists(*file, error) && !std::filesystem::is_regular_file(*file, error))
      throw Error(fmt::format("{}: this is not a regular file", file->string()));  // devices and pipes are endless
    load_environment_map(*file, environment);
  } catch (const std::exception& error) {
    environment.kind = EnvironmentKind::automatic;
    p.object().read = false;  // no warnings about the parameters of a missing map
    import.warnings.add(fmt::format("{}; the environment map is left out", error.what()));
    return;
  }
  const auto scale = static_cast<float>(p.number("scale", 1));
  environment.color = Rgb(std::clamp(scale, 0.0f, kMaxRadiance));
  const glm::dmat3 to_world(import.turn * p.transform("to_world").value_or(glm::dmat4(1)));
  // Mitsuba's left edge is relume's centre.
  if (const std::optional<double> angle = angle_about_y(to_world)) {
    environment.rotation_rad = static_cast<float>(std::remainder(*angle + kPi, 2 * kPi));
  } else if (std::fabs(glm::determinant(to_world)) > 1e-12) {
    const glm::dmat3 half_turn(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1));
    environment.map = resampled(environment, Mat3(half_turn * glm::inverse(to_world)));
  } else {
    p.fail("its to_world collapses directions; correct it");
  }
}

}  // namespace relume::mitsuba
