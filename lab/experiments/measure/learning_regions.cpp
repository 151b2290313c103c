#include "experiments/measure/learning_regions.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "relume/error.h"

namespace relume {

PixelMask surfaces_of(const ExperimentContext& context, const ExperimentScene& scene) {
  ExperimentScene lights = plainly_sampled(scene);
  lights.settings.path.max_bounces = 0;
  const Image seen = make_reference(context, lights, 256).image;
  PixelMask region = mask_of({"surfaces"}, seen.width, seen.height);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      if (!(luminance(seen.pixels[static_cast<size_t>(y) * static_cast<size_t>(seen.width) + static_cast<size_t>(x)]) >
            0))
        continue;
      // Includes neighbours: where a lamp covers a hundredth of a pixel, few samples hit it.
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, seen.height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, seen.width - 1); ++u)
          region.mask[static_cast<size_t>(v) * static_cast<size_t>(seen.width) + static_cast<size_t>(u)] = 0;
      }
    }
  }
  return region;
}

PixelMask pixels_of_material(const ExperimentContext& context, const ExperimentScene& scene, const std::string& name) {
  ExperimentScene marked = plainly_sampled(scene);
  marked.settings.path.max_bounces = 0;
  marked.scene.environment = {};
  marked.scene.parameter_animation.clear();
  bool found = false;
  for (Material& material : marked.scene.materials) {
    const bool wanted = material.name == name;
    found = found || wanted;
    material.emission = Rgb(wanted ? 1.0f : 0.0f);
    material.emission_texture = {};
  }
  if (!found) throw Error(fmt::format("{}: no material is named '{}'; name one of the scene", scene.name, name));
  const Image seen = make_reference(context, marked, 256).image;
  PixelMask region{name, {}};
  for (const Rgb& pixel : seen.pixels) region.mask.push_back(luminance(pixel) > 0.99f ? 1 : 0);
  return region;
}

PixelMask pixels_in_room(const PixelMask& region, const Reference& reference, const CameraPose& camera,
                         const BaseRoom& room) {
  const auto width = static_cast<size_t>(reference.image.width);
  const float columns = static_cast<float>(reference.image.width);
  const float rows = static_cast<float>(reference.image.height);
  const float half = std::tan(0.5f * camera.camera.fov_y_rad);
  constexpr float kMargin_m = 0.05f;  // walls may lie in the faces of the room, and depths are rounded
  PixelMask inside = region;
  for (size_t p = 0; p < inside.mask.size(); ++p) {
    const float x = (2 * (static_cast<float>(p % width) + 0.5f) - columns) / rows;
    const float y = 1 - 2 * (static_cast<float>(p / width) + 0.5f) / rows;
    const Vec3 direction = glm::normalize(Vec3(half * x, half * y, -1));
    const float distance = reference.surface.depth[p];
    const Vec4 seen = camera.to_world * Vec4(distance * direction, 1);
    const bool is_inside = distance > 0 && seen.x > room.low.x - kMargin_m && seen.x < room.high.x + kMargin_m &&
                           seen.z > room.low.y - kMargin_m && seen.z < room.high.y + kMargin_m;
    if (!is_inside) inside.mask[p] = 0;
  }
  return inside;
}

std::vector<PixelMask> mine_regions(const Image& reference, const Image& direct, const PixelMask& surfaces) {
  std::vector<float> sorted;
  for (size_t i = 0; i < direct.pixels.size(); ++i) {
    if (surfaces.mask[i] != 0) sorted.push_back(luminance(direct.pixels[i]));
  }
  std::sort(sorted.begin(), sorted.end());
  const float sunny = sorted.empty() ? 0.0f : 0.1f * sorted[sorted.size() * 995 / 1000];
  std::vector<PixelMask> regions{surfaces, {"sun", {}}, {"spot", {}}, {"rest", {}}};
  for (size_t i = 0; i < reference.pixels.size(); ++i) {
    const float all = luminance(reference.pixels[i]);
    const float first = luminance(direct.pixels[i]);
    const bool surface = surfaces.mask[i] != 0;
    const bool sun = surface && first > sunny;
    const bool spot = surface && !sun && all > 0 && all - first > 0.5f * all;
    regions[1].mask.push_back(sun ? 1 : 0);
    regions[2].mask.push_back(spot ? 1 : 0);
    regions[3].mask.push_back(surface && !sun && !spot ? 1 : 0);
  }
  return regions;
}

}  // namespace relume
