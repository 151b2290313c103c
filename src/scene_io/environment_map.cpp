#include <algorithm>

#include <fmt/format.h>

#include "core/activity.h"
#include "core/vec.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "relume/scene_io.h"

namespace relume {
namespace {

/// Repairs invalid pixels: NaN and negative values become 0. Infinite values become the map's largest finite value. All
/// are clamped to kMaxRadiance.
void clean(std::vector<Rgb>& pixels) {
  float largest = 0;
  for (const Rgb& pixel : pixels) {
    for (int c = 0; c < 3; ++c) largest = is_finite(pixel[c]) ? std::max(largest, pixel[c]) : largest;
  }
  largest = std::min(largest, kMaxRadiance);
  for (Rgb& pixel : pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = pixel[c] > 0 ? std::min(pixel[c], largest) : 0.0f;
  }
}

}  // namespace

void load_environment_map(const std::filesystem::path& file, Environment& environment) {
  const Activity activity("loading " + file.filename().string());
  Image image = read_image(file);
  if (image.width < 1 || image.height < 1)
    throw Error(fmt::format("{}: the environment map has no pixels; export it again", file.string()));
  clean(image.pixels);
  environment.kind = EnvironmentKind::map;
  environment.color = Rgb(1);
  environment.width = image.width;
  environment.height = image.height;
  environment.map = std::move(image.pixels);
}

}  // namespace relume
