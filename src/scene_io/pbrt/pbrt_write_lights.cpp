#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>

#include "core/parallel.h"
#include "core/vec.h"
#include "relume/image_io.h"
#include "scene/studio.h"
#include "scene/sun_sky.h"
#include "scene_io/pbrt/equal_area.h"
#include "scene_io/pbrt/pbrt_write_scene.h"

namespace relume::pbrt {
namespace {

void write_distant(const Rgb& irradiance, const Vec3& direction, Output& output) {
  output.line(fmt::format("LightSource \"distant\" \"rgb L\" {} \"point3 from\" {} \"point3 to\" [ 0 0 0 ]",
                          numbers(irradiance), numbers(-direction)));
}

/// pbrt's falloff is a smooth step, relume's a square; both have the same power.
void write_spot(const PunctualLight& light, const Vec3& from, const Vec3& direction, Output& output) {
  const float cos_outer = std::cos(light.outer_cone_rad);
  const float cos_inner = std::cos(light.inner_cone_rad);
  const float start = std::min((4 * cos_inner - cos_outer) / 3, 1.0f);
  const float own_power = 1 - cos_inner + (cos_inner - cos_outer) / 3;
  const float power = 1 - (start + cos_outer) / 2;
  const float outer = glm::degrees(light.outer_cone_rad);
  const float delta = outer - glm::degrees(std::acos(clamp(start, -1, 1)));
  output.note("the falloff of spotlights keeps its power, not its shape");
  output.line(
      fmt::format("LightSource \"spot\" \"rgb I\" {} \"point3 from\" {} \"point3 to\" {} \"float coneangle\" {} "
                  "\"float conedeltaangle\" {}",
                  numbers(light.intensity * (power > 0 ? own_power / power : 1.0f)), numbers(from),
                  numbers(from + direction), number(outer), number(delta)));
}

void write_light(const PunctualLight& light, const Mat4& world, Output& output) {
  if (is_black(light.intensity)) return;
  const Vec3 from(world[3]);
  const Vec3 direction = glm::normalize(Vec3(world * Vec4(0, 0, -1, 0)));
  if (!is_finite(direction)) return;
  switch (light.type) {
    case PunctualType::point:
      output.line(fmt::format("LightSource \"point\" \"rgb I\" {} \"point3 from\" {}", numbers(light.intensity),
                              numbers(from)));
      break;
    case PunctualType::spot: write_spot(light, from, direction, output); break;
    case PunctualType::directional:
      if (light.angular_diameter_rad > 0)
        output.note("directional lights are written without their angular diameter; shadows become sharp");
      write_distant(light.intensity, direction, output);
      break;
  }
}

/// Nearest pixel of an equirectangular map.
Rgb look_up_map(const Environment& e, const Vec3& d) {
  const float turn = std::atan2(d.x, -d.z) / (2 * kPi) + 0.5f;
  const float row = std::acos(clamp(d.y, -1, 1)) / kPi;
  const auto index = [](float share, int count) {
    return std::clamp(static_cast<int>(share * static_cast<float>(count)), 0, count - 1);
  };
  return e.map[static_cast<size_t>(index(row, e.height)) * static_cast<size_t>(e.width) +
               static_cast<size_t>(index(turn, e.width))];
}

/// Writes a map, with its rotation and factor, as an image of equal areas.
void write_map(const Environment& e, Output& output) {
  constexpr int kSamples = 4;  // per pixel, in each direction
  const int n = std::clamp(e.height + e.height / 8, 64, 4096);
  Image image(n, n);
  const float c = std::cos(e.rotation_rad);
  const float s = std::sin(e.rotation_rad);
  parallel_for(static_cast<size_t>(n), [&](size_t y) {
    for (int x = 0; x < n; ++x) {
      Rgb sum(0);
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const Vec2 part((static_cast<float>(k % kSamples) + 0.5f) / kSamples,
                        (static_cast<float>(k / kSamples) + 0.5f) / kSamples);
        const Vec3 d =
            direction_of_square((Vec2(static_cast<float>(x), static_cast<float>(y)) + part) / static_cast<float>(n));
        sum += look_up_map(e, {c * d.x - s * d.z, d.y, s * d.x + c * d.z});  // before the rotation about +Y
      }
      image.at(x, static_cast<int>(y)) = e.color * sum / static_cast<float>(kSamples * kSamples);
    }
  });
  const std::string file =
      output.add_file("environment.exr", [&](const std::filesystem::path& target) { write_image(target, image); });
  output.line("LightSource \"infinite\" \"string filename\" " + file);
}

/// The environment of a sky or a studio as a map.
Environment as_map(const Environment& e, std::vector<Rgb> texels, int width, int height) {
  Environment map = e;
  map.kind = EnvironmentKind::map;
  map.map = std::move(texels);
  map.width = width;
  map.height = height;
  return map;
}

void write_environment(const Environment& e, Output& output) {
  switch (e.kind) {
    case EnvironmentKind::automatic:
    case EnvironmentKind::none: output.line("LightSource \"infinite\" \"rgb L\" [ 0 0 0 ]"); break;
    case EnvironmentKind::constant: output.line("LightSource \"infinite\" \"rgb L\" " + numbers(e.color)); break;
    case EnvironmentKind::map: write_map(e, output); break;
    case EnvironmentKind::sun_sky: {
      SunSkyModel model = make_sun_sky(e.sun_sky);
      write_map(as_map(e, std::move(model.sky), model.width, model.height), output);
      const Vec3 d = -sun_direction(e.sun_sky);
      const float c = std::cos(e.rotation_rad);
      const float s = std::sin(e.rotation_rad);
      output.note("the sun is written without its angular diameter; shadows become sharp");
      write_distant(e.color * model.sun.irradiance, {c * d.x + s * d.z, d.y, -s * d.x + c * d.z}, output);
      break;
    }
    case EnvironmentKind::studio: {
      EnvironmentMap studio = make_studio();
      write_map(as_map(e, std::move(studio.texels), studio.width, studio.height), output);
      break;
    }
  }
}

}  // namespace

void write_lights(const Scene& scene, const std::vector<Mat4>& world, const std::vector<bool>& visible,
                  Output& output) {
  write_environment(scene.environment, output);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    const Index light = scene.nodes[i].light;
    if (light != kNone && visible[i]) write_light(scene.lights[static_cast<size_t>(light)], world[i], output);
  }
}

}  // namespace relume::pbrt
