#include "cli/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/file_roles.h"
#include "cli/reports.h"
#include "cli/version.h"
#include "files/extension.h"
#include "framebuffer/ocio_view.h"
#include "framebuffer/tone_map.h"
#include "parts/part_file.h"
#include "relume/image_io.h"
#include "render/session.h"
#include "settings/nearest_name.h"
#include "settings/settings_json.h"
#include "settings/text_list.h"

namespace relume::cli {
namespace {

constexpr std::array<std::string_view, 6> kExtensions = {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tga"};

void write_layers(const std::filesystem::path& file, const Session& session, const std::vector<std::string>& aovs,
                  const Metadata& metadata) {
  const Image image = session.image();
  ExrFile exr{image.width, image.height, exr_channels(image), metadata, render_settings(session).crop};
  for (const std::string& name : aovs) {
    for (ExrChannel& channel : session.aov(name)) exr.channels.push_back(std::move(channel));
  }
  if (render_settings(session).samples.part) return write_part(file, exr, session);
  write_exr(file, exr);
}

}  // namespace

void check_image_file(const std::filesystem::path& file, const std::vector<std::string>& aovs) {
  const std::string extension = lower_extension(file);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end()) {
    throw UsageError(fmt::format("{}: images are written as {}; choose one of these extensions", file.string(),
                                 fmt::join(kExtensions, ", ")));
  }
  check_layers(file, aovs);
  check_output_file(file);
}

void check_layers(const std::filesystem::path& file, const std::vector<std::string>& aovs) {
  if (aovs.empty() || lower_extension(file) == ".exr") return;
  throw UsageError(
      fmt::format("{}: only .exr files can store layers; write an .exr file, or remove --aov", file.string()));
}

std::vector<std::string> parse_aovs(std::string_view text, const std::vector<std::string>& known) {
  std::vector<std::string> names;
  for (const std::string_view name : split_at_commas(text)) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw UsageError(fmt::format("--aov: there is no layer '{}'{}", name, suggestion(name, known)));
    }
    names.emplace_back(name);
  }
  return names;
}

Metadata image_metadata(const Session& session, const std::string& scene, AllSettings settings, double load_s) {
  settings.render = render_settings(session);
  Metadata metadata{
      {"relume.version", kVersion},
      {"relume.scene", scene},
      {"relume.scene_hash", fmt::format("{:016x}", session.scene_hash())},
      {"relume.settings", settings_to_json(describe(settings))},
      {"relume.seed", std::to_string(settings.render.seed)},
      {"relume.samples_per_pixel", format_samples(session.image_samples())},
      {"relume.timings", fmt::format(R"({{"load_s": {:.6f}, "build_s": {:.6f}, "render_s": {:.6f}}})", load_s,
                                     session.statistics().build_s, session.image_render_s())},
  };
  const PixelWindow& crop = settings.render.crop;
  if (!crop.empty()) metadata["relume.crop"] = fmt::format("{},{},{},{}", crop.x, crop.y, crop.width, crop.height);
  return metadata;
}

PixelWindow pixels_of(const ImagePart& part, int width, int height) {
  if (part == ImagePart{}) return {};
  const auto pixel = [](float fraction, int size) {
    return static_cast<int>(std::lround(fraction * static_cast<float>(size)));
  };
  PixelWindow window;
  window.x = std::min(pixel(part.left, width), width - 1);
  window.y = std::min(pixel(part.top, height), height - 1);
  window.width = std::max(pixel(part.right, width) - window.x, 1);
  window.height = std::max(pixel(part.bottom, height) - window.y, 1);
  return window;
}

Image part_of(const Image& image, const PixelWindow& window) {
  if (window.empty()) return image;
  Image part(window.width, window.height);
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) part.at(x, y) = image.at(window.x + x, window.y + y);
  }
  return part;
}

Image cropped_image(const Session& session) { return part_of(session.image(), render_settings(session).crop); }

Image displayed_image(const Session& session, const Display& display, const OcioView* view) {
  const Image image = cropped_image(session);
  return view ? view->apply(image, display.exposure) : tone_map(image, display.tone_map, display.exposure);
}

void write_image(const std::filesystem::path& file, const Session& session, const Display& display,
                 const std::vector<std::string>& aovs, const Metadata& metadata, const OcioView* view) {
  const std::string extension = lower_extension(file);
  if (extension == ".exr") return write_layers(file, session, aovs, metadata);
  write_image(file, extension == ".hdr" ? cropped_image(session) : displayed_image(session, display, view));
}

}  // namespace relume::cli
