// Sun and sky of Mitsuba scenes.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "scene_io/mitsuba/mitsuba_emitters.h"

namespace relume::mitsuba {
namespace {

constexpr double kPiD = 3.14159265358979323846;
constexpr double kRadiansPerDegree = kPiD / 180;

/// Radiance of relume's daylight, in kcd/m², in Mitsuba's unit of colours: the luminance of 1 W/(sr·m²·nm) weighted by
/// ȳ / 106.75 nm is 683 lm/W · 106.75 nm.
constexpr float kMitsubaPerKilocandela = static_cast<float>(1000 / (683 * 106.75));

/// Julian day minus 2451545 of a date at 0 h, by the formula for the Gregorian calendar in [BlancoMuriel01], whose
/// divisions truncate.
double days_since_2000(int64_t year, int64_t month, int64_t day) {
  const int64_t before_march = (month - 14) / 12;
  const int64_t julian = (1461 * (year + 4800 + before_march)) / 4 + (367 * (month - 2 - 12 * before_march)) / 12 -
                         (3 * ((year + 4900 + before_march) / 100)) / 4 + day - 32075;
  return static_cast<double>(julian) - 0.5 - 2451545.0;
}

/// Right ascension and declination of the sun in radians [BlancoMuriel01].
struct Celestial {
  double right_ascension;
  double declination;
};

Celestial celestial_position(double days) {
  const double omega = 2.1429 - 0.0010394594 * days;
  const double anomaly = 6.2400600 + 0.0172019699 * days;
  const double longitude = 4.8950630 + 0.017202791698 * days + 0.03341607 * std::sin(anomaly) +
                           0.00034894 * std::sin(2 * anomaly) - 0.0001134 - 0.0000203 * std::sin(omega);
  const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(omega);
  return {std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude)),
          std::asin(std::sin(obliquity) * std::sin(longitude))};
}

}  // namespace

glm::dvec3 sun_direction_of_time(const Parameters& p) {
  const double hours =
      p.number("hour", 15) - p.number("timezone", 9) + (p.number("minute", 0) + p.number("second", 0) / 60) / 60;
  const auto within = [&](const char* name, int64_t fallback, int64_t low, int64_t high) {
    return std::clamp<int64_t>(p.integer(name, fallback), low, high);
  };
  const double days =
      days_since_2000(within("year", 2010, -4000, 9999), within("month", 7, 1, 12), within("day", 10, 1, 31)) +
      hours / 24;
  const Celestial sun = celestial_position(days);
  const double sidereal_hours = 6.6974243242 + 0.0657098283 * days + hours;
  const double hour_angle =
      (sidereal_hours * 15 + p.number("longitude", 139.6917)) * kRadiansPerDegree - sun.right_ascension;
  const double latitude = p.number("latitude", 35.6894) * kRadiansPerDegree;
  const double zenith = std::acos(std::clamp(std::cos(latitude) * std::cos(hour_angle) * std::cos(sun.declination) +
                                                 std::sin(sun.declination) * std::sin(latitude),
                                             -1.0, 1.0));
  const double azimuth = std::atan2(-std::sin(hour_angle), std::tan(sun.declination) * std::cos(latitude) -
                                                               std::sin(latitude) * std::cos(hour_angle));
  // From the north by the east. With Mitsuba's formula, +X is the south and +Y the west.
  const double phi = azimuth - kPiD;
  return {std::sin(zenith) * std::cos(phi), std::sin(zenith) * std::sin(phi), std::cos(zenith)};
}

glm::dmat3 daylight_frame(const Parameters& p) {
  const glm::dmat3 to_world(p.transform("to_world").value_or(glm::dmat4(1)));
  const bool is_old = p.object().is_old || p.object().type != "sunsky";
  // In 0.6, +X is the east and −Z the north.
  return is_old ? to_world * glm::dmat3(0, 0, 1, -1, 0, 0, 0, 1, 0) : to_world;
}

void import_daylight(const Parameters& p, Import& import) {
  Environment& environment = import.scene.environment;
  environment.kind = EnvironmentKind::sun_sky;
  const std::optional<glm::dvec3> given = p.vector("sun_direction");
  const glm::dvec3 direction =
      glm::dmat3(import.turn) * (given ? *given : daylight_frame(p) * sun_direction_of_time(p));
  const double length = glm::length(direction);
  if (!(length > 0)) p.fail("its sun has no direction");
  SunSky& sky = environment.sun_sky;
  sky.sun_elevation_rad = static_cast<float>(std::asin(std::clamp(direction.y / length, -1.0, 1.0)));
  sky.sun_azimuth_rad = static_cast<float>(std::atan2(direction.x, direction.z));
  sky.turbidity = static_cast<float>(std::clamp(p.number("turbidity", 3), 1.7, 10.0));
  sky.ground_albedo = color_parameter(import, p, "albedo", Rgb(0.3f), SpectrumUse::reflectance);
  const double diameter = p.number("sun_aperture", 0.5358 * p.number("sun_radius_scale", 1));
  sky.sun_angular_diameter_rad = static_cast<float>(std::clamp(diameter, 0.0, 90.0) * kRadiansPerDegree);
  const double scale_of_both = p.number("scale", 1);  // of 0.6
  const auto scale = [&](const char* name) {
    return static_cast<float>(std::clamp(p.number(name, scale_of_both), 0.0, 1e9)) * kMitsubaPerKilocandela;
  };
  sky.sky_scale = p.object().type == "sun" ? 0.0f : scale("sky_scale");
  sky.sun_scale = p.object().type == "sky" ? 0.0f : scale("sun_scale");
  p.ignore({"complex_sun", "resolution"});
  import.warnings.add("daylight follows the model of Preetham instead of Hosek and Wilkie; colours differ");
}

}  // namespace relume::mitsuba
