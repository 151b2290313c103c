#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "command.h"
#include "console.h"
#include "io/image.h"
#include "scene_source.h"
#include "scene_summary.h"

namespace relume::cli {
namespace {

constexpr std::array<std::string_view, 7> kPictureExtensions = {".exr",  ".hdr", ".png", ".jpg",
                                                                ".jpeg", ".tga", ".bmp"};

std::string extension_of(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string exr_text(const ExrFile& exr) {
  std::string text =
      fmt::format("size          {} x {}\nchannels      {}\n", exr.width, exr.height, exr.channels.size());
  for (const ExrChannel& channel : exr.channels) {
    const auto [low, high] = std::minmax_element(channel.values.begin(), channel.values.end());
    text += fmt::format("              {} from {:.4g} to {:.4g}\n", channel.name, *low, *high);
  }
  for (const auto& [name, value] : exr.attributes) text += fmt::format("{}: {}\n", name, value);
  return text;
}

int run_info(const std::string& file) {
  const std::string extension = extension_of(file);
  if (extension == ".exr") {
    std::fputs(exr_text(read_exr(file)).c_str(), stdout);
  } else if (std::find(kPictureExtensions.begin(), kPictureExtensions.end(), extension) != kPictureExtensions.end()) {
    const Image image = read_image(file);
    std::fputs(fmt::format("size          {} x {}\n", image.width, image.height).c_str(), stdout);
  } else {
    std::fputs(to_text(summarize(open_scene(file))).c_str(), stdout);
  }
  return kExitDone;
}

}  // namespace

Command info_command(Verbosity& verbosity) {
  const auto file = std::make_shared<std::string>();
  Command command{
      .name = "info",
      .summary = "Tell what a scene or a picture contains, and what the loader ignored.",
      .examples = {{"relume info scene.glb", "counts, cameras, extent, memory, warnings"},
                   {"relume info out.exr", "size, channels, and how it was rendered"}},
      .arguments = {{"FILE", file.get(), "Scene file, built-in scene or picture", true, Completion::scene}},
      .options = verbosity_options(verbosity),
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [file] { return run_info(*file); },
  };
  return command;
}

}  // namespace relume::cli
