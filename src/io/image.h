// Images in memory, and reading and writing them: EXR, PNG, JPEG, HDR, TGA.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/vec.h"

namespace relume {

/// Linear RGB image; row 0 is the top row.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  ///< width · height, row by row

  Image() = default;
  Image(int w, int h) : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h), Rgb(0)) {}
  Rgb& at(int x, int y) { return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)]; }
  const Rgb& at(int x, int y) const {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

/// One named plane of 32-bit floats (or unsigned integers, as EXR UINT) of a layered EXR.
struct ExrChannel {
  std::string name;               ///< "R", "albedo.R", "depth.Z", "motion.X" …
  std::vector<float> values;      ///< width · height
};

/// A layered EXR: planes of one size plus string attributes (settings, seed, timings).
struct ExrFile {
  int width = 0;
  int height = 0;
  std::vector<ExrChannel> channels;
  std::map<std::string, std::string> attributes;
};

/// All functions here throw Error (file, problem, remedy) and write to a temporary name that is renamed only
/// when complete.

/// EXR, HDR: linear values as stored. PNG, JPEG, TGA: 8 bit, decoded from sRGB.
Image read_image(const std::filesystem::path& file);

/// By extension: .exr and .hdr store linear values; .png, .jpg, .tga expect display-ready values in [0, 1] that
/// are still linear, and apply the sRGB transfer function.
void write_image(const std::filesystem::path& file, const Image& image);

ExrFile read_exr(const std::filesystem::path& file);
void write_exr(const std::filesystem::path& file, const ExrFile& exr);

}  // namespace relume
