// Reading and writing images: EXR, HDR, PNG, JPEG, TGA, BMP, KTX2, WebP.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relume/export.h"
#include "relume/image.h"

namespace relume {

/// One named plane of 32-bit floats of a layered EXR.
struct ExrChannel {
  std::string name;           ///< "R", "albedo.R", "depth.Z", "motion.X" …
  std::vector<float> values;  ///< width · height, row by row from the top
};

/// A layered EXR: planes of one size plus string attributes (settings, seed, timings).
struct RELUME_API ExrFile {
  int width = 0;
  int height = 0;
  std::vector<ExrChannel> channels;
  std::map<std::string, std::string> attributes;
  /// What the file stores, within the image; empty: all of it. Channels that were read are 0 elsewhere.
  PixelWindow data_window = {};

  /// nullptr if there is no channel of that name.
  const ExrChannel* find(std::string_view name) const;
};

/// What readers accept; files that claim more are refused before memory is allocated for them.
inline constexpr int kMaxImageSide = 1 << 17;
inline constexpr int64_t kMaxImagePixels = int64_t{1} << 28;
inline constexpr int64_t kMaxDecodedBytes = int64_t{1} << 33;

// All functions below throw Error (file, problem, remedy). Writers use a temporary name that is renamed only when the
// file is complete.

/// The format is recognised by content. EXR, HDR: linear values (EXPOSURE of HDR divided out). PNG, JPEG, TGA, BMP,
/// KTX2, WebP: 8 or 16 bit, decoded from sRGB, except KTX2 files that are linear. Alpha is dropped.
RELUME_API Image read_image(const std::filesystem::path& file);

/// The same over a file's bytes; `name` is for messages.
RELUME_API Image parse_image(std::span<const std::byte> bytes, const std::string& name);

/// By extension: .exr and .hdr store linear values; .png, .jpg, .jpeg, .tga expect display-ready values in [0, 1]
/// that are still linear, and apply the sRGB transfer function.
RELUME_API void write_image(const std::filesystem::path& file, const Image& image);

/// A PNG of display-ready values as write_image() stores them.
RELUME_API std::vector<uint8_t> encode_png(const Image& image);
/// A PNG of `rgb`, 3 · width · height bytes as they are.
RELUME_API std::vector<uint8_t> encode_png(std::span<const uint8_t> rgb, int width, int height);

/// Every channel of the first part, whatever its stored type (half, float, unsigned integer), compression and
/// tiling, over the *display* window: pixels outside the data window are 0, pixels beyond the display window are cut
/// off. Subsampled channels are replicated. Of the attributes, the strings. Deep files are refused.
RELUME_API ExrFile read_exr(const std::filesystem::path& file);
RELUME_API ExrFile parse_exr(std::span<const std::byte> bytes, const std::string& name);

/// The part of an image that its file stores: ExrFile::data_window of EXR files, empty for other formats.
RELUME_API PixelWindow stored_window(std::span<const std::byte> bytes, const std::string& name);

/// 32-bit float scan lines with ZIP compression. The same contents give the same bytes.
RELUME_API void write_exr(const std::filesystem::path& file, const ExrFile& exr);

/// Channels "R", "G", "B" of a layer, or "LAYER.R" … if `layer` is not empty. Without a layer also, in this order:
/// the first layer that has all three, luminance-chroma (Y, RY, BY), luminance alone (Y). `name` is for messages.
RELUME_API Image image_from_exr(const ExrFile& exr, const std::string& layer, const std::string& name);

/// Channels R, G, B of a layer (none: empty string), ready to append to an ExrFile of the same size.
RELUME_API std::vector<ExrChannel> exr_channels(const Image& image, const std::string& layer = {});

}  // namespace relume
