#include "scene_io/gltf/gltf_punctual.h"

#include <algorithm>

#include <fmt/format.h>

#include "scene/light_parameters.h"
#include "scene_io/gltf/gltf_extras.h"
#include "scene_io/gltf/gltf_value.h"

namespace relume::gltf {
namespace {

/// The ratio if within [0.01, 100], else 0.
float usable_aspect_ratio(float ratio) { return ratio >= 0.01f && ratio <= 100.0f ? ratio : 0.0f; }

Camera convert_camera(Document& document, const tinygltf::Camera& source, int index) {
  Camera camera;
  camera.name = source.name.empty() ? fmt::format("camera {}", index) : source.name;
  apply_camera_extras(source.extras, camera);
  if (source.type == "orthographic") {
    camera.projection = Projection::orthographic;
    const float ymag = std::fabs(to_float(source.orthographic.ymag));
    if (ymag > 0) camera.half_height = ymag;
    if (ymag > 0)
      camera.aspect_ratio = usable_aspect_ratio(std::fabs(to_float(source.orthographic.xmag)) / ymag);
    else
      document.warnings.add(fmt::format("camera '{}': ymag is 0; {} is used", camera.name, camera.half_height));
    return camera;
  }
  camera.aspect_ratio = usable_aspect_ratio(to_float(source.perspective.aspectRatio));
  const float yfov = to_float(source.perspective.yfov);
  if (yfov > 0 && yfov < kPi) {
    camera.fov_y_rad = yfov;
  } else {
    document.warnings.add(
        fmt::format("camera '{}': yfov {} is out of range; {} is used", camera.name, yfov, camera.fov_y_rad));
  }
  return camera;
}

PunctualLight convert_light(Document& document, const tinygltf::Light& source, int index) {
  PunctualLight light;
  light.name = source.name.empty() ? fmt::format("light {}", index) : source.name;
  const Rgb intensity = to_vec3(source.color, Vec3(1)) * to_float(source.intensity);
  light.intensity = glm::clamp(intensity, Vec3(0), Vec3(kMaxRadiance));
  if (intensity != light.intensity)
    document.warnings.add(
        fmt::format("light '{}': its intensity is negative or above {:g}; the nearest valid value is used", light.name,
                    kMaxRadiance));
  for (const LightType& type : light_types()) {
    if (source.type == type.name) light.type = type.type;
  }
  apply_light_extras(source.extras, light);
  if (light.type == PunctualType::spot) {
    constexpr float kNarrowest = 1e-3f;
    const float outer = to_float(source.spot.outerConeAngle);
    light.outer_cone_rad = clamp(outer, kNarrowest, kPi / 2);
    light.inner_cone_rad = clamp(to_float(source.spot.innerConeAngle), 0, light.outer_cone_rad);
    if (outer < kNarrowest || outer > light.outer_cone_rad + kNarrowest)
      document.warnings.add(fmt::format("light '{}': its outer cone angle is out of range; {} is used", light.name,
                                        light.outer_cone_rad));
  }
  if (source.range > 0) document.warnings.add("the range of punctual lights is ignored; their light has no limit");
  return light;
}

}  // namespace

Index PunctualImporter::import_camera(int camera, Scene& scene) {
  if (camera < 0 || static_cast<size_t>(camera) >= document_.model.cameras.size()) {
    document_.warnings.add(fmt::format("a node refers to camera {}, which does not exist; it is ignored", camera));
    return kNone;
  }
  const auto [entry, is_new] = cameras_.try_emplace(camera, static_cast<Index>(scene.cameras.size()));
  if (is_new)
    scene.cameras.push_back(convert_camera(document_, document_.model.cameras[static_cast<size_t>(camera)], camera));
  return entry->second;
}

Index PunctualImporter::import_light(int light, Scene& scene) {
  if (light < 0 || static_cast<size_t>(light) >= document_.model.lights.size()) {
    document_.warnings.add(fmt::format("a node refers to light {}, which does not exist; it is ignored", light));
    return kNone;
  }
  const auto [entry, is_new] = lights_.try_emplace(light, static_cast<Index>(scene.lights.size()));
  if (is_new)
    scene.lights.push_back(convert_light(document_, document_.model.lights[static_cast<size_t>(light)], light));
  return entry->second;
}

Index PunctualImporter::find_camera(int camera) const {
  const auto entry = cameras_.find(camera);
  return entry == cameras_.end() ? kNone : entry->second;
}

Index PunctualImporter::find_light(int light) const {
  const auto entry = lights_.find(light);
  return entry == lights_.end() ? kNone : entry->second;
}

}  // namespace relume::gltf
