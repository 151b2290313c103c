#include "scene_io/pbrt/pbrt_lights.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>

#include "core/parallel.h"
#include "core/vec.h"
#include "scene_io/look_rotation.h"
#include "scene_io/pbrt/equal_area.h"

namespace relume::pbrt {
namespace {

constexpr int kMaxRows = 4096;  // of the environment
constexpr Rgb kLuminance(0.2126f, 0.7152f, 0.0722f);

Rgb usable(const Rgb& radiance) {
  Rgb result;
  for (int c = 0; c < 3; ++c) result[c] = radiance[c] > 0 ? std::min(radiance[c], kMaxRadiance) : 0.0f;
  return result;
}

Vec3 point_in(const Mat4& matrix, const Vec3& p) { return Vec3(matrix * Vec4(p, 1)); }
Vec3 vector_in(const Mat4& matrix, const Vec3& v) { return Vec3(matrix * Vec4(v, 0)); }

/// Direction of the centre of a pixel part of the equirectangular map, in relume's world.
Vec3 map_direction(float column, float row) {
  const float phi = (column - 0.5f) * 2 * kPi;
  const float theta = row * kPi;
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

/// Luminous flux per area on a plane that faces +Z, as pbrt sums it: with 2π over all pixels of the sphere, of which
/// half count, pbrt finds half of the illuminance.
float upward_illuminance(const Image& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec2 p((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                   (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height));
      const float cosine = direction_of_square(p).z;
      if (cosine > 0) sum += static_cast<double>(glm::dot(image.at(x, y), kLuminance) * cosine);
    }
  }
  return static_cast<float>(sum * 2 * static_cast<double>(kPi) / static_cast<double>(image.pixels.size()));
}

/// Value of a map of latitude and longitude about +Z, as in earlier versions of pbrt.
Rgb look_up_latitudes(const Image& image, const Vec3& d) {
  const float turn = std::atan2(d.y, d.x) / (2 * kPi);
  const float column = turn < 0 ? turn + 1 : turn;
  const float row = std::acos(clamp(d.z, -1, 1)) / kPi;
  const auto index = [](float share, int count) {
    return std::clamp(static_cast<int>(share * static_cast<float>(count)), 0, count - 1);
  };
  return image.at(index(column, image.width), index(row, image.height));
}

}  // namespace

Rgb Lights::intensity(const Parameters& parameters, std::string_view name) {
  return colors_.light(parameters, name).value_or(Rgb(1)) * std::max(parameters.number("scale", 1), 0.0f);
}

void Lights::add_node(PunctualLight light, const Vec3& position, const Vec3& direction) {
  light.intensity = usable(light.intensity);
  light.name = fmt::format("light {}", scene_.lights.size());
  Node node;
  node.name = light.name;
  node.light = static_cast<Index>(scene_.lights.size());
  node.transform.translation = orientation_ * position;
  node.transform.rotation = look_rotation(orientation_ * direction);
  if (!is_finite(node.transform.translation)) {
    warnings_.add("a light whose position is not finite is left out");
    return;
  }
  scene_.lights.push_back(std::move(light));
  scene_.add_node(std::move(node));
}

void Lights::add_point(const LightEntity& light) {
  const Parameters& p = light.parameters;
  PunctualLight result;
  result.intensity = intensity(p, "I");
  if (const float power = p.number("power", -1); power > 0) result.intensity *= power / (4 * kPi);
  add_node(result, point_in(narrow(light.to_world.at[0]), p.point("from", Vec3(0))), Vec3(0, -1, 0));
}

/// pbrt's falloff is a smooth step between two cosines, relume's is a square; both have the same power.
void Lights::add_spot(const LightEntity& light) {
  const Parameters& p = light.parameters;
  const float outer = std::clamp(p.number("coneangle", 30), 0.1f, 90.0f);
  const float inner = std::clamp(outer - p.number("conedeltaangle", 5), 0.0f, outer);
  const float cos_outer = std::cos(glm::radians(outer));
  const float cos_inner = std::cos(glm::radians(inner));
  PunctualLight result;
  result.type = PunctualType::spot;
  result.outer_cone_rad = glm::radians(outer);
  result.inner_cone_rad = std::min(std::acos(0.75f * cos_inner + 0.25f * cos_outer), result.outer_cone_rad);
  result.intensity = intensity(p, "I");
  if (const float power = p.number("power", -1); power > 0)
    result.intensity *= power / (2 * kPi * (1 - (cos_inner + cos_outer) / 2));
  const Mat4 to_world = narrow(light.to_world.at[0]);
  const Vec3 from = p.point("from", Vec3(0));
  const Vec3 to = p.point("to", Vec3(0, 0, 1));
  add_node(result, point_in(to_world, from), vector_in(to_world, to - from));
}

void Lights::add_distant(const LightEntity& light) {
  const Parameters& p = light.parameters;
  PunctualLight result;
  result.type = PunctualType::directional;
  result.intensity = intensity(p, "L");
  if (const float illuminance = p.number("illuminance", -1); illuminance > 0) result.intensity *= illuminance;
  const Vec3 from = p.point("from", Vec3(0));
  const Vec3 to = p.point("to", Vec3(0, 0, 1));
  add_node(result, Vec3(0), vector_in(narrow(light.to_world.at[0]), to - from));
}

void Lights::add_goniometric(const LightEntity& light) {
  const Parameters& p = light.parameters;
  warnings_.add("goniometric lights shine in all directions with their mean intensity");
  PunctualLight result;
  result.intensity = intensity(p, "I");
  if (const float power = p.number("power", -1); power > 0) {
    result.intensity *= power / (4 * kPi);
  } else if (const auto image = images_.read_light(p.string("filename"), p.where())) {
    double sum = 0;
    for (const Rgb& pixel : image->pixels) sum += static_cast<double>((pixel.r + pixel.g + pixel.b) / 3);
    result.intensity *= static_cast<float>(sum / static_cast<double>(image->pixels.size()));
  }
  add_node(result, point_in(narrow(light.to_world.at[0]), Vec3(0)), Vec3(0, -1, 0));
}

void Lights::add_infinite(const LightEntity& light) {
  const Parameters& p = light.parameters;
  has_infinite_ = true;
  Rgb radiance = intensity(p, "L");
  const float illuminance = p.number("illuminance", -1);
  if (p.find("portal", {"point3"})) warnings_.add("portals are ignored; they change only the noise");
  const std::string name = p.string("filename");
  const std::optional<Image> image = name.empty() ? std::nullopt : images_.read_light(name, p.where());
  if (!image) {
    if (illuminance > 0) radiance *= illuminance / kPi;
    if (name.empty()) constant_ += radiance;
    return;
  }
  if (illuminance > 0) {
    const float own = upward_illuminance(*image);
    radiance *= own > 0 ? illuminance / own : 1.0f;
  }
  if (image->width != image->height)
    warnings_.add(fmt::format("{} is not square; it is read as a map of latitude and longitude about +Z", name));
  const Mat3 to_world(narrow(light.to_world.at[0]));
  const Mat3 inverse = glm::inverse(orientation_ * to_world);
  const bool is_usable = is_finite(inverse[0]) && is_finite(inverse[1]) && is_finite(inverse[2]);
  if (!is_usable) fail(p.where(), "the transform of an infinite light cannot be inverted; correct it");
  add_map(*image, inverse, radiance);
}

void Lights::add_map(const Image& image, const Mat3& from_world, const Rgb& scale) {
  Environment& environment = scene_.environment;
  if (environment.map.empty()) {
    environment.height = std::clamp(std::max(image.height, image.width / 2), 1, kMaxRows);
    environment.width = 2 * environment.height;
    environment.map.assign(static_cast<size_t>(environment.width) * static_cast<size_t>(environment.height), Rgb(0));
  }
  const auto columns = static_cast<size_t>(environment.width);
  const bool is_square = image.width == image.height;
  parallel_for(static_cast<size_t>(environment.height), [&](size_t y) {
    for (size_t x = 0; x < columns; ++x) {
      Rgb sum(0);
      for (int part = 0; part < 4; ++part) {
        const float column = (static_cast<float>(x) + (part % 2 == 0 ? 0.25f : 0.75f)) / static_cast<float>(columns);
        const float row = (static_cast<float>(y) + (part < 2 ? 0.25f : 0.75f)) / static_cast<float>(environment.height);
        const Vec3 d = glm::normalize(from_world * map_direction(column, row));
        sum += is_square ? look_up(image, d) : look_up_latitudes(image, d);
      }
      Rgb& pixel = environment.map[y * columns + x];
      pixel = usable(pixel + scale * sum / 4.0f);
    }
  });
}

void Lights::add(const LightEntity& light) {
  if (light.kind == "point") {
    add_point(light);
  } else if (light.kind == "spot") {
    add_spot(light);
  } else if (light.kind == "distant") {
    add_distant(light);
  } else if (light.kind == "goniometric") {
    add_goniometric(light);
  } else if (light.kind == "infinite") {
    add_infinite(light);
  } else if (light.kind == "projection") {
    warnings_.add("projection lights are not supported; they are left out");
    return;
  } else {
    fail(light.parameters.where(),
         fmt::format("there is no light '{}'; use point, spot, distant or infinite", light.kind));
  }
  light.parameters.warn_of_unused(fmt::format("light '{}'", light.kind), warnings_);
}

void Lights::finish() {
  Environment& environment = scene_.environment;
  environment.color = Rgb(1);
  if (!environment.map.empty()) {
    environment.kind = EnvironmentKind::map;
    for (Rgb& pixel : environment.map) pixel = usable(pixel + constant_);
  } else if (!is_black(usable(constant_))) {
    environment.kind = EnvironmentKind::constant;
    environment.color = usable(constant_);
  } else {
    const bool emits = std::any_of(scene_.materials.begin(), scene_.materials.end(),
                                   [](const Material& m) { return !is_black(m.emission); });
    const bool is_lit = emits || has_infinite_ || !scene_.lights.empty();
    environment.kind = is_lit ? EnvironmentKind::none : EnvironmentKind::automatic;
  }
}

}  // namespace relume::pbrt
