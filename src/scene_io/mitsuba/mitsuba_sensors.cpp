#include "scene_io/mitsuba/mitsuba_sensors.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

namespace relume::mitsuba {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
constexpr int64_t kMaxSide = 32768;  // of --width and --height

void request(Scene& scene, const char* setting, int64_t value) {
  nlohmann::json settings =
      scene.settings_json.empty() ? nlohmann::json::object() : nlohmann::json::parse(scene.settings_json);
  settings[setting] = value;
  scene.settings_json = settings.dump();
}

/// Size of the film, and the part of it that is rendered. A part around the centre narrows the view, others become
/// Scene::crop.
struct Film {
  int64_t width = 768;
  int64_t height = 576;
  int64_t crop_width = 768;
  int64_t crop_height = 576;
  ImagePart crop;

  double aspect() const { return static_cast<double>(width) / static_cast<double>(height); }
};

Film read_film(const Parameters& sensor, const Import& import) {
  Film film;
  const std::vector<const Object*> films = sensor.children({"film"});
  if (films.empty()) return film;
  const Parameters p(import, *films[0]);
  p.ignore({"file_format", "pixel_format", "component_format", "compensate", "sample_border", "banner",
            "high_quality_edges"});
  if (!p.children({"rfilter"}).empty())
    import.warnings.note("reconstruction filters are ignored; pixels have a box filter");
  film.width = p.integer("width", film.width);
  film.height = p.integer("height", film.height);
  const int64_t x = p.integer("crop_offset_x", 0);
  const int64_t y = p.integer("crop_offset_y", 0);
  film.crop_width = p.integer("crop_width", film.width);
  film.crop_height = p.integer("crop_height", film.height);
  for (const int64_t side : {film.width, film.height, film.crop_width, film.crop_height}) {
    if (side < 1 || side > kMaxSide) p.fail(fmt::format("a side of {} pixels is not in [1, {}]", side, kMaxSide));
  }
  // Without 2 · offset, which may overflow.
  const auto centres = [](int64_t offset, int64_t rest) { return rest % 2 == 0 && offset == rest / 2; };
  if (centres(x, film.width - film.crop_width) && centres(y, film.height - film.crop_height)) return film;
  if (x < 0 || y < 0 || x > film.width - film.crop_width || y > film.height - film.crop_height)
    p.fail(fmt::format("the crop {},{},{},{} is not within the film of {}x{} pixels", x, y, film.crop_width,
                       film.crop_height, film.width, film.height));
  const auto part = [](int64_t pixels, int64_t all) { return static_cast<float>(pixels) / static_cast<float>(all); };
  film.crop = {.left = part(x, film.width),
               .top = part(y, film.height),
               .right = part(x + film.crop_width, film.width),
               .bottom = part(y + film.crop_height, film.height)};
  film.crop_width = film.width;
  film.crop_height = film.height;
  return film;
}

/// Requests what the first camera asks for.
void request_settings(const Parameters& sensor, const Film& film, Import& import) {
  request(import.scene, "width", film.crop_width);
  request(import.scene, "height", film.crop_height);
  import.scene.crop = film.crop;
  constexpr int64_t kMaxSamples = 1 << 30;
  for (const Object* sampler : sensor.children({"sampler"})) {
    const Parameters p(import, *sampler);
    p.ignore({"seed", "jitter", "strength"});
    const int64_t samples = p.integer("sample_count", 4);
    if (samples > 0 && samples <= kMaxSamples) request(import.scene, "spp", samples);
  }
}

void read_lens(const Parameters& p, Camera& camera, const Import& import) {
  camera.lens_radius = static_cast<float>(std::fabs(p.number("aperture_radius", 0)));
  const double distance = p.number("focus_distance", p.number("far_clip", 1e4));
  if (!(distance > 0)) p.fail(fmt::format("a focus distance of {} is not positive", distance));
  camera.focus_distance = static_cast<float>(std::min(distance, 1e9));
  if (!(camera.lens_radius <= 1e6f)) {
    import.warnings.add("a lens is wider than 1000 km; a pinhole replaces it");
    camera.lens_radius = 0;
  }
}

bool is_camera(const Object& sensor) {
  return sensor.type == "perspective" || sensor.type == "thinlens" || sensor.type == "orthographic";
}

double axis_length(const glm::dmat4& m, int axis) { return glm::length(glm::dvec3(m[axis])); }

/// Mitsuba's film of an orthographic sensor spans [-1, 1] across, in the sensor's axes, which may be scaled.
void read_orthographic(const glm::dmat4& to_world, const Film& film, Camera& camera, const Import& import) {
  camera.projection = Projection::orthographic;
  const double across = axis_length(to_world, 0);
  const double up = axis_length(to_world, 1);
  if (std::fabs(across - up) > 1e-4 * across)
    import.warnings.add("an orthographic sensor is scaled differently across and up; the scale across is used");
  const double cropped = static_cast<double>(film.crop_height) / static_cast<double>(film.height);
  camera.half_height = static_cast<float>(glm::clamp(across / film.aspect() * cropped, 1e-6, 1e9));
}

void read_perspective(const Parameters& p, const Film& film, Camera& camera) {
  const double half_width = std::tan(horizontal_fov_rad(p, film.aspect()) / 2);
  const double cropped = static_cast<double>(film.crop_height) / static_cast<double>(film.height);
  const double fov_y = 2 * std::atan(half_width / film.aspect() * cropped);
  camera.fov_y_rad = static_cast<float>(glm::clamp(fov_y, 2e-4, 179.0 * kRadiansPerDegree));
}

}  // namespace

double horizontal_fov_rad(const Parameters& sensor, double aspect) {
  double angle;
  std::string axis = sensor.text("fov_axis", "x");
  for (char& c : axis) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (sensor.has("fov")) {
    angle = sensor.number("fov", 0) * kRadiansPerDegree;
  } else {
    constexpr double kDiagonalMm = 43.2666153;  // of a frame of 36 mm × 24 mm
    std::string length = sensor.text("focal_length", "50mm");
    if (length.ends_with("mm")) length.resize(length.size() - 2);
    const double millimetres = parse_number(length).value_or(0);
    if (!(millimetres > 0)) sensor.fail("its focal_length is not of the form 50mm");
    angle = 2 * std::atan(kDiagonalMm / (2 * millimetres));
    axis = "diagonal";
  }
  if (axis == "smaller") axis = aspect > 1 ? "y" : "x";
  if (axis == "larger") axis = aspect > 1 ? "x" : "y";
  const double half = std::tan(angle / 2);
  if (axis == "y") {
    angle = 2 * std::atan(half * aspect);
  } else if (axis == "diagonal") {
    angle = 2 * std::atan(half / std::sqrt(1 + 1 / (aspect * aspect)));
  } else if (axis != "x") {
    sensor.fail(fmt::format("its fov_axis '{}' is not x, y, diagonal, smaller or larger", axis));
  }
  if (!(angle > 0 && angle < 180 * kRadiansPerDegree))
    sensor.fail("its horizontal field of view is not between 0 and 180 degrees");
  return angle;
}

bool is_mirrored(const Import& import) {
  for (const Child& child : import.document.root->children) {
    if (child.object->tag != "sensor" || !is_camera(*child.object)) continue;
    const std::optional<glm::dmat4> to_world = Parameters(import, *child.object).transform("to_world");
    return to_world && glm::determinant(glm::dmat3(*to_world)) < 0;
  }
  return false;
}

void import_sensor(const Object& sensor, Index parent, Import& import) {
  const bool is_orthographic = sensor.type == "orthographic";
  if (!is_camera(sensor)) {
    import.warnings.add(fmt::format("{} is not supported and is ignored", name_of(sensor)));
    return;
  }
  const Parameters p(import, sensor);
  p.ignore({"near_clip", "far_clip", "shutter_open", "shutter_close", "focus_distance"});
  const Film film = read_film(p, import);
  const glm::dmat4 to_world = p.transform("to_world").value_or(glm::dmat4(1));
  Camera camera;
  camera.name = sensor.id;
  camera.aspect_ratio =
      std::clamp(static_cast<float>(film.crop_width) / static_cast<float>(film.crop_height), 0.01f, 100.0f);
  if (is_orthographic) {
    read_orthographic(to_world, film, camera, import);
  } else {
    read_perspective(p, film, camera);
  }
  if (sensor.type == "thinlens") read_lens(p, camera, import);
  if (p.number("principal_point_offset_x", 0) != 0 || p.number("principal_point_offset_y", 0) != 0)
    import.warnings.add("the offset of a sensor's principal point is not supported and is ignored");
  if (glm::determinant(glm::dmat3(import.turn * to_world)) < 0)
    import.warnings.add("a sensor mirrors its image unlike the first one, which is not supported; it does not mirror");
  if (import.scene.cameras.empty()) request_settings(p, film, import);
  Node node;
  node.name = sensor.id;
  node.parent = parent;
  // From looking along +Z with +X to the left, to -Z with +X to the right.
  node.matrix = Mat4(to_world * glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, -1)));
  node.camera = static_cast<Index>(import.scene.cameras.size());
  import.scene.cameras.push_back(std::move(camera));
  import.scene.add_node(std::move(node));
}

void import_integrators(const Parameters& parent, Import& import) {
  constexpr int64_t kMostBounces = 1024;  // of --max-bounces
  int64_t depth = -1;                     // no limit
  for (const Object* integrator : parent.children({"integrator"})) {
    const Parameters p(import, *integrator);
    p.ignore({"rr_depth", "samples_per_pass", "block_size", "timeout", "aovs", "emitter_samples", "bsdf_samples",
              "shading_samples"});
    if (p.boolean("hide_emitters", false))
      import.warnings.add("hide_emitters is not supported; lamps and the environment are visible");
    if (!p.children({"integrator"}).empty()) {
      import_integrators(p, import);
      return;
    }
    constexpr std::string_view kOthers[] = {"ao", "depth", "distance", "field", "irrcache", "sssmc", "velocity", "vpl"};
    if (std::find(std::begin(kOthers), std::end(kOthers), integrator->type) != std::end(kOthers))
      import.warnings.add(fmt::format("{} is not supported; light is traced along paths", name_of(*integrator)));
    depth = integrator->type.starts_with("direct") ? 2 : p.integer("max_depth", -1);
  }
  request(import.scene, "max-bounces", depth < 0 ? kMostBounces : std::clamp<int64_t>(depth - 1, 0, kMostBounces));
}

}  // namespace relume::mitsuba
