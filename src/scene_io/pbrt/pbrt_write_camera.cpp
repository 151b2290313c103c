#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "core/vec.h"
#include "scene/compiled_scene.h"
#include "scene/placement.h"
#include "scene_io/pbrt/pbrt_camera.h"
#include "scene_io/pbrt/pbrt_write_scene.h"

namespace relume::pbrt {
namespace {

using nlohmann::json;

json settings_of(const Scene& scene) {
  const json settings = json::parse(scene.settings_json, nullptr, false);
  return settings.is_object() ? settings : json::object();
}

int integer(const json& settings, const char* key, int otherwise) {
  const auto value = settings.find(key);
  return value != settings.end() && value->is_number() ? value->get<int>() : otherwise;
}

/// The number `key` of the settings; 0 if it is missing.
float real(const json& settings, const char* key) {
  const auto value = settings.find(key);
  return value != settings.end() && value->is_number() ? value->get<float>() : 0.0f;
}

/// Parameter of the film for a part of the image; empty for the whole one.
std::string crop_text(const ImagePart& crop, const IVec2& size) {
  if (crop == ImagePart{}) return {};
  const auto pixel = [](float part, int side) { return std::lround(part * static_cast<float>(side)); };
  return fmt::format(" \"integer pixelbounds\" [ {} {} {} {} ]", pixel(crop.left, size.x), pixel(crop.right, size.x),
                     pixel(crop.top, size.y), pixel(crop.bottom, size.y));
}

std::string camera_text(const Camera& camera, const IVec2& size) {
  const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
  if (camera.projection == Projection::panoramic) return "Camera \"spherical\" \"string mapping\" \"equirectangular\"";
  if (camera.projection == Projection::orthographic) {
    // Without the lens radius: relume ignores it, and with a lens pbrt renders an orthographic camera in perspective.
    const float h = camera.half_height;
    const float w = h * aspect;
    return fmt::format("Camera \"orthographic\" \"float screenwindow\" [ {} {} {} {} ]", number(-w), number(w),
                       number(-h), number(h));
  }
  std::string lens;
  if (camera.lens_radius > 0)
    lens = fmt::format(" \"float lensradius\" {} \"float focaldistance\" {}", number(camera.lens_radius),
                       number(camera.focus_distance));
  const float half = std::tan(camera.fov_y_rad / 2) * std::min(aspect, 1.0f);  // of the lower side
  return fmt::format("Camera \"perspective\" \"float fov\" {}", number(glm::degrees(2 * std::atan(half)))) + lens;
}

const Camera& camera_of(const Scene& scene, Index node) {
  return scene.cameras[static_cast<size_t>(scene.nodes[static_cast<size_t>(node)].camera)];
}

}  // namespace

IVec2 image_size(const Scene& scene) {
  const json settings = settings_of(scene);
  const Index node = find_camera(scene, "");
  const float ratio = node == kNone ? 0.0f : camera_of(scene, node).aspect_ratio;
  const int height = integer(settings, "height", 720);
  const float aspect = ratio > 0 ? ratio : 16.0f / 9;
  const int width = static_cast<int>(std::lround(static_cast<float>(height) * aspect));
  return {std::max(1, integer(settings, "width", width)), std::max(1, height)};
}

void write_camera(const Scene& scene, const std::vector<Mat4>& world, Output& output) {
  Mat4 to_world(1);
  const Index node = find_camera(scene, "");
  const Camera& camera = camera_of(scene, node);
  const Mat4& found = world[static_cast<size_t>(node)];
  if (const std::optional<Mat3> axes = orientation(found)) {
    to_world = Mat4(*axes);
    to_world[3] = found[3];
  }
  const auto cameras = std::count_if(scene.nodes.begin(), scene.nodes.end(),
                                     [](const Node& candidate) { return candidate.camera != kNone; });
  if (cameras > 1) output.note("the first camera is written; a file of pbrt has one");
  const json settings = settings_of(scene);
  const IVec2 size = image_size(scene);
  if (real(settings, "shutter") > 0) output.note("the shutter is left out; the image has no motion blur");
  output.line(
      fmt::format("Film \"rgb\" \"integer xresolution\" {} \"integer yresolution\" {} \"float iso\" {} \"string "
                  "filename\" {}",
                  size.x, size.y, number(100 * std::exp2(clamp(real(settings, "exposure"), -64, 64))),
                  in_quotes(scene.name.empty() ? "image.exr" : scene.name + ".exr")) +
      crop_text(scene.crop, size));
  output.line("Sampler \"zsobol\" \"integer pixelsamples\" " +
              std::to_string(std::max(1, integer(settings, "spp", 64))));
  output.line("Integrator \"volpath\" \"integer maxdepth\" " + std::to_string(integer(settings, "max-bounces", 8)));
  const char* kind = camera.projection == Projection::panoramic ? "spherical" : "perspective";
  output.line("Transform " + numbers(glm::inverse(to_world * glm::inverse(from_relume_camera(kind)))));
  output.line(camera_text(camera, size));
}

}  // namespace relume::pbrt
