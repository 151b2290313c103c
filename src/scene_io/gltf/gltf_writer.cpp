// Writes scenes as glTF 2.0. Properties without a glTF equivalent go to the object's `extras.relume`, with the keys of
// relume's JSON.
#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include "relume/image_io.h"
#include "relume/scene_io.h"
#include "scene_io/gltf/gltf_output.h"
#include "scene_io/gltf/gltf_write_animation.h"
#include "scene_io/gltf/gltf_write_materials.h"
#include "scene_io/gltf/gltf_write_nodes.h"

namespace relume {
namespace {

using gltf::number;
using gltf::numbers;
using gltf::Output;
using gltf::OutputJson;

OutputJson degrees(float angle_rad) { return number(glm::degrees(angle_rad)); }

OutputJson sun_sky_json(const SunSky& s) {
  return {{"elevation_deg", degrees(s.sun_elevation_rad)},
          {"azimuth_deg", degrees(s.sun_azimuth_rad)},
          {"turbidity", number(s.turbidity)},
          {"sky_scale", number(s.sky_scale)},
          {"sun_scale", number(s.sun_scale)},
          {"sun_angular_diameter_deg", degrees(s.sun_angular_diameter_rad)},
          {"ground_albedo", numbers(s.ground_albedo)}};
}

/// Null for an unchanged `automatic`, as in files without an environment. A map is written to an EXR file in the same
/// folder.
OutputJson environment_json(const Environment& environment, Output& output) {
  OutputJson json;
  switch (environment.kind) {
    case EnvironmentKind::automatic:
      if (environment.rotation_rad == 0 && environment.color == Rgb(1)) return json;
      json["kind"] = "automatic";
      break;
    case EnvironmentKind::none: json["kind"] = "none"; return json;
    case EnvironmentKind::constant: json["constant"] = numbers(environment.color); return json;
    case EnvironmentKind::sun_sky: json["sun_sky"] = sun_sky_json(environment.sun_sky); break;
    case EnvironmentKind::studio: json["kind"] = "studio"; break;
    case EnvironmentKind::map: {
      Image image(environment.width, environment.height);
      image.pixels = environment.map;
      json["map"] =
          output.add_file("environment.exr", [&](const std::filesystem::path& file) { write_image(file, image); });
      break;
    }
  }
  if (environment.rotation_rad != 0) json["rotation_deg"] = degrees(environment.rotation_rad);
  if (environment.color != Rgb(1)) json["scale"] = numbers(environment.color);
  return json;
}

OutputJson scene_extras(const Scene& scene, Output& output) {
  OutputJson extras;
  OutputJson environment = environment_json(scene.environment, output);
  if (!environment.is_null()) extras["environment"] = std::move(environment);
  if (!scene.settings_json.empty()) {
    OutputJson settings = OutputJson::parse(scene.settings_json, nullptr, false);
    if (settings.is_object()) {
      extras["settings"] = std::move(settings);
    } else {
      output.warn("the scene's settings are not a JSON object and are not written");
    }
  }
  for (const VisibleSet& set : scene.visible_sets) {
    extras["visible_sets"].push_back(
        {{"low", numbers(set.low)}, {"high", numbers(set.high)}, {"visible", set.visible}});
  }
  if (scene.crop != ImagePart{}) output.warn("the crop of the image is not written; render with --crop");
  return extras;
}

}  // namespace

std::vector<std::string> write_gltf(const std::filesystem::path& file, const Scene& scene) {
  validate(scene, error_place(scene));
  Output output(file, scene.source_files);
  // Readers expect these members first.
  output.root["scene"] = 0;
  output.list("scenes");
  gltf::MaterialWriter(scene, output).write();
  const std::vector<int> roots = gltf::NodeWriter(scene, output).write();
  gltf::AnimationWriter(scene, output).write();
  OutputJson json = OutputJson::object();
  if (!scene.name.empty()) json["name"] = scene.name;
  if (!roots.empty()) json["nodes"] = roots;
  OutputJson extras = scene_extras(scene, output);
  if (!extras.is_null()) json["extras"]["relume"] = std::move(extras);
  output.add("scenes", std::move(json));
  return output.finish();
}

}  // namespace relume
