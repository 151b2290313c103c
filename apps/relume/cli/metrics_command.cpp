#include <cstdio>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/image.h"
#include "cli/reports.h"
#include "files/atomic_file.h"
#include "relume/image_io.h"
#include "relume/lab/metrics.h"
#include "render/display.h"

namespace relume::cli {
namespace {

struct MetricsOptions {
  std::string a;
  std::string b;
  bool json = false;
  bool hdr_flip = false;
  std::string flip_map;
  OutputSettings display{.exposure = 0,
                         .tone_map = ToneMapChoice::none};  ///< transform to the images that FLIP compares
};

std::string to_text(const Metrics& m, bool with_hdr_flip) {
  const std::string hdr_flip = with_hdr_flip ? fmt::format("hdr_flip {:.6g}\n", m.hdr_flip) : "";
  return fmt::format(
      "mse      {:.6g}\nrel_mse  {:.6g}\nmae      {:.6g}\nmape     {:.6g}\nflip     {:.6g}\n{}"
      "mean_a   {:.6g} {:.6g} {:.6g}\nmean_b   {:.6g} {:.6g} {:.6g}\n",
      m.mse, m.rel_mse, m.mae, m.mape, m.flip, hdr_flip, m.mean_a[0], m.mean_a[1], m.mean_a[2], m.mean_b[0],
      m.mean_b[1], m.mean_b[2]);
}

Metrics measure(const MetricsOptions& options, const Image& a, const Image& b) {
  try {
    const Display display = fixed_display(options.display);
    return compute_metrics(a, b,
                           {.tone_map = display.tone_map, .exposure = display.exposure, .hdr_flip = options.hdr_flip});
  } catch (const Error& error) {
    throw Error(fmt::format("{} and {}: {}", options.a, options.b, error.what()));
  }
}

void write_flip_map(const MetricsOptions& options, const Image& a, const Image& b) {
  const Display display = fixed_display(options.display);
  const std::vector<float> map =
      flip_map(tone_map(a, display.tone_map, display.exposure), tone_map(b, display.tone_map, display.exposure));
  write_image(options.flip_map, color_map(map, a.width, a.height));
}

/// An image and its stored window: readers fill the remainder with 0.
struct StoredImage {
  Image image;
  PixelWindow window;
};

StoredImage read_stored_image(const std::string& file) {
  const std::vector<std::byte> bytes = read_file(file);
  return {parse_image(bytes, file), stored_window(bytes, file)};
}

std::string to_text(const PixelWindow& window) {
  if (window.empty()) return "the whole image";
  return fmt::format("the window {},{},{},{}", window.x, window.y, window.width, window.height);
}

/// The windows of both images, which must be equal.
std::pair<Image, Image> read_images(const MetricsOptions& options) {
  const StoredImage a = read_stored_image(options.a);
  const StoredImage b = read_stored_image(options.b);
  if (a.image.width != b.image.width || a.image.height != b.image.height) {
    throw Error(fmt::format("{} has {} x {} pixels, but {} has {} x {}; images must have the same size to be compared",
                            options.a, a.image.width, a.image.height, options.b, b.image.width, b.image.height));
  }
  if (a.window != b.window) {
    throw Error(fmt::format("{} stores {}, but {} stores {}; render both with the same --crop to compare them",
                            options.a, to_text(a.window), options.b, to_text(b.window)));
  }
  return {part_of(a.image, a.window), part_of(b.image, b.window)};
}

int run_metrics(const MetricsOptions& options) {
  FileRoles roles;
  roles.reads("A", options.a);
  roles.reads("B", options.b);
  roles.writes("--flip-map", options.flip_map);
  if (!options.flip_map.empty()) check_image_file(options.flip_map, {});
  const auto [a, b] = read_images(options);
  const Metrics metrics = measure(options, a, b);
  if (metrics.nonfinite_a + metrics.nonfinite_b > 0) {
    warn(fmt::format("pixels with NaN or infinity are ignored: {} in {}, {} in {}", metrics.nonfinite_a, options.a,
                     metrics.nonfinite_b, options.b));
  }
  if (!options.flip_map.empty()) write_flip_map(options, a, b);
  std::fputs((options.json ? to_json(metrics, options.hdr_flip) : to_text(metrics, options.hdr_flip)).c_str(), stdout);
  return kExitDone;
}

}  // namespace

Command metrics_command() {
  const auto options = std::make_shared<MetricsOptions>();
  Command command{
      .name = "metrics",
      .summary = "Measure the error of an image against a reference.",
      .examples = {{"relume metrics out.exr reference.exr", "MSE, relMSE, MAE, MAPE, FLIP and the means"},
                   {"relume metrics out.exr reference.exr --json", "the same for scripts"},
                   {"relume metrics out.exr reference.exr --flip-map flip.png", "an image of the differences"}},
      .arguments = {{"A", &options->a, "Image"}, {"B", &options->b, "Reference of the same size"}},
      .options = {{{"json", &options->json, "Print a JSON object"}},
                  {{"hdr-flip", &options->hdr_flip,
                    "Also print HDR-FLIP, the largest FLIP over a range of exposures; slow"}},
                  {{"flip-map", &options->flip_map, "Write the FLIP error of each pixel as a colour map"},
                   "FILE",
                   0,
                   Completion::file}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options] { return run_metrics(*options); },
  };
  for (Setting& setting : describe(options->display)) command.options.push_back({setting});
  return command;
}

}  // namespace relume::cli
