#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/reports.h"
#include "cli/scene_source.h"
#include "cli/scene_summary.h"
#include "core/clock.h"
#include "files/extension.h"
#include "relume/image_io.h"

namespace relume::cli {
namespace {

constexpr std::array<std::string_view, 9> kImageExtensions = {".exr", ".hdr", ".png",  ".jpg", ".jpeg",
                                                              ".tga", ".bmp", ".ktx2", ".webp"};

bool is_image(const std::string& extension) {
  return std::find(kImageExtensions.begin(), kImageExtensions.end(), extension) != kImageExtensions.end();
}

ImageReport report_image(const std::string& file, const std::string& extension) {
  if (extension != ".exr") {
    const Image image = read_image(file);
    return {image.width, image.height, {}, {}};
  }
  const ExrFile exr = read_exr(file);
  ImageReport report{exr.width, exr.height, {}, {exr.attributes.begin(), exr.attributes.end()}};
  for (const ExrChannel& channel : exr.channels) {
    report.channels.push_back(report_channel(channel));
  }
  return report;
}

/// The lines of `text`, without control characters.
std::string printable_lines(std::string_view text) {
  std::string lines;
  while (true) {
    const size_t end = text.find('\n');
    lines += printable(text.substr(0, end));
    if (end == std::string_view::npos) return lines;
    lines += '\n';
    text.remove_prefix(end + 1);
  }
}

std::string to_text(const ImageReport::Channel& channel) {
  std::string text = fmt::format("              {}", printable(channel.name));
  if (channel.min <= channel.max) text += fmt::format(" from {:.4g} to {:.4g}", channel.min, channel.max);
  if (channel.nonfinite > 0) text += fmt::format(", {} not finite", format_count(channel.nonfinite));
  return text + "\n";
}

std::string to_text(const ImageReport& report) {
  std::string text = fmt::format("size          {} x {}\n", report.width, report.height);
  if (!report.channels.empty()) text += fmt::format("channels      {}\n", report.channels.size());
  for (const ImageReport::Channel& channel : report.channels) text += to_text(channel);
  for (const auto& [name, value] : report.attributes)
    text += fmt::format("{}: {}\n", printable(name), printable_lines(value));
  return text;
}

struct InfoOptions {
  std::string file;
  bool json = false;
};

int run_info(const InfoOptions& options, const Verbosity& verbosity) {
  const std::string extension = lower_extension(options.file);
  const auto print = [&](const auto& what) {
    std::fputs((options.json ? to_json(what) : to_text(what)).c_str(), stdout);
  };
  if (is_image(extension)) {
    print(report_image(options.file, extension));
  } else {
    const double start_s = now_s();
    const Scene scene = open_scene(options.file, !verbosity.quiet);
    tell_more(verbosity, fmt::format("loaded {} in {:.2f} s", options.file, now_s() - start_s));
    print(summarize(scene));
  }
  return kExitDone;
}

}  // namespace

Command info_command(Verbosity& verbosity) {
  const auto options = std::make_shared<InfoOptions>();
  Command command{
      .name = "info",
      .summary = "List the contents of a scene or an image, and what the loader ignored.",
      .examples = {{"relume info scene.glb", "counts, cameras, extent, memory, warnings"},
                   {"relume info out.exr", "size, channels, and how it was rendered"},
                   {"relume info scene.glb --json", "the same for scripts"}},
      .arguments = {{"FILE", &options->file, "Scene file, built-in scene or image", true, Completion::scene}},
      .options = {{{"json", &options->json, "Print a JSON object"}}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options, &verbosity] { return run_info(*options, verbosity); },
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli
