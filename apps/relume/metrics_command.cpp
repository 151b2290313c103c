#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "command.h"
#include "console.h"
#include "file_roles.h"
#include "image.h"
#include "relume/image_io.h"
#include "relume/lab/metrics.h"
#include "render/display.h"
#include "reports.h"

namespace relume::cli {
namespace {

struct MetricsOptions {
  std::string a;
  std::string b;
  bool json = false;
  bool hdr_flip = false;
  std::string flip_map;
  OutputSettings display{.exposure = 0, .tone_map = ToneMapChoice::none};  ///< as which FLIP sees the images
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

int run_metrics(const MetricsOptions& options) {
  FileRoles roles;
  roles.reads("A", options.a);
  roles.reads("B", options.b);
  roles.writes("--flip-map", options.flip_map);
  if (!options.flip_map.empty()) check_image_file(options.flip_map, {});
  const Image a = read_image(options.a);
  const Image b = read_image(options.b);
  if (a.width != b.width || a.height != b.height) {
    throw Error(fmt::format("{} has {} x {} pixels, but {} has {} x {}; images must have the same size to be compared",
                            options.a, a.width, a.height, options.b, b.width, b.height));
  }
  const Metrics metrics = measure(options, a, b);
  if (metrics.nonfinite_a + metrics.nonfinite_b > 0) {
    warn(fmt::format("left out pixels that are not finite: {} of {}, {} of {}", metrics.nonfinite_a, options.a,
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
      .summary = "Measure how far an image is from a reference.",
      .examples = {{"relume metrics out.exr reference.exr", "MSE, relMSE, MAE, MAPE, FLIP and the means"},
                   {"relume metrics out.exr reference.exr --json", "the same for scripts"},
                   {"relume metrics out.exr reference.exr --flip-map flip.png", "where the differences are"}},
      .arguments = {{"A", &options->a, "Image"}, {"B", &options->b, "Reference of the same size"}},
      .options = {{{"json", &options->json, "Print a JSON object"}},
                  {{"hdr-flip", &options->hdr_flip, "Print HDR-FLIP too, which looks at every exposure; slow"}},
                  {{"flip-map", &options->flip_map, "Write the FLIP difference of each pixel, as colours"},
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
