// Conversion between EXR channels and RGB images.
#include <array>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

using Channels = std::array<const ExrChannel*, 3>;

std::optional<Channels> find_rgb(const ExrFile& exr, const std::string& prefix) {
  const Channels channels{exr.find(prefix + "R"), exr.find(prefix + "G"), exr.find(prefix + "B")};
  if (channels[0] == nullptr || channels[1] == nullptr || channels[2] == nullptr) return std::nullopt;
  return channels;
}

std::optional<Channels> find_any_layer(const ExrFile& exr) {
  for (const ExrChannel& channel : exr.channels) {
    if (!channel.name.ends_with(".R")) continue;
    if (auto channels = find_rgb(exr, channel.name.substr(0, channel.name.size() - 1))) return channels;
  }
  return std::nullopt;
}

/// Builds an image from a function of the pixel index.
template <typename Function>
Image make_image(const ExrFile& exr, Function&& pixel) {
  Image image(exr.width, exr.height);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = pixel(i);
  return image;
}

/// Luminance and chroma with Rec. 709 weights: RY = (R - Y)/Y, BY = (B - Y)/Y (OpenEXR, "Luminance/Chroma Images").
Rgb rgb_from_luminance_chroma(float y, float ry, float by) {
  const float r = (ry + 1.0f) * y;
  const float b = (by + 1.0f) * y;
  return {r, (y - 0.2126f * r - 0.0722f * b) / 0.7152f, b};
}

}  // namespace

Image image_from_exr(const ExrFile& exr, const std::string& layer, const std::string& name) {
  std::optional<Channels> rgb = find_rgb(exr, layer.empty() ? "" : layer + ".");
  if (!rgb && layer.empty()) rgb = find_any_layer(exr);
  if (rgb)
    return make_image(exr,
                      [&](size_t i) { return Rgb((*rgb)[0]->values[i], (*rgb)[1]->values[i], (*rgb)[2]->values[i]); });
  if (const ExrChannel* y = exr.find("Y"); y != nullptr && layer.empty()) {
    const ExrChannel* ry = exr.find("RY");
    const ExrChannel* by = exr.find("BY");
    if (ry != nullptr && by != nullptr)
      return make_image(
          exr, [&](size_t i) { return rgb_from_luminance_chroma(y->values[i], ry->values[i], by->values[i]); });
    return make_image(exr, [&](size_t i) { return Rgb(y->values[i]); });
  }
  std::vector<std::string> names;
  for (const ExrChannel& channel : exr.channels) names.push_back(channel.name);
  throw Error(fmt::format("{}: no channels {}R, {}G, {}B; it has {}; choose another file or layer", name,
                          layer.empty() ? "" : layer + ".", layer.empty() ? "" : layer + ".",
                          layer.empty() ? "" : layer + ".", fmt::join(names, ", ")));
}

std::vector<ExrChannel> exr_channels(const Image& image, const std::string& layer) {
  std::vector<ExrChannel> channels(3);
  const std::string prefix = layer.empty() ? "" : layer + ".";
  for (int c = 0; c < 3; ++c) {
    ExrChannel& channel = channels[static_cast<size_t>(c)];
    channel.name = prefix + "RGB"[c];
    channel.values.resize(image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) channel.values[i] = image.pixels[i][c];
  }
  return channels;
}

}  // namespace relume
