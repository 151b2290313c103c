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
  /// Stored part of the image; empty: the whole image. Channels that were read are 0 elsewhere.
  PixelWindow data_window = {};

  /// Returns nullptr if no channel has that name.
  const ExrChannel* find(std::string_view name) const;
};

/// Limits of the readers. Larger files are rejected before memory is allocated for them.
inline constexpr int kMaxImageSide = 1 << 17;
inline constexpr int64_t kMaxImagePixels = int64_t{1} << 28;
inline constexpr int64_t kMaxDecodedBytes = int64_t{1} << 33;

// All functions below throw Error (file, problem, remedy). Writers use a temporary name and rename the complete file.

/// Reads an image; the content determines the format. EXR, HDR: linear values (EXPOSURE of HDR divided out). PNG, JPEG,
/// TGA, BMP, KTX2, WebP: 8 or 16 bit, decoded from sRGB, except linear KTX2 files. Alpha is dropped.
RELUME_API Image read_image(const std::filesystem::path& file);

/// Parses the bytes of an image file in the same way; `name` appears in messages.
RELUME_API Image parse_image(std::span<const std::byte> bytes, const std::string& name);

/// Writes an image; the extension determines the format. .exr and .hdr store linear values. .png, .jpg, .jpeg and .tga
/// expect linear display values in [0, 1] and apply the sRGB transfer function.
RELUME_API void write_image(const std::filesystem::path& file, const Image& image);

/// Encodes linear display values as a PNG, as write_image() does.
RELUME_API std::vector<uint8_t> encode_png(const Image& image);
/// Encodes `rgb`, 3 · width · height bytes, as a PNG without conversion.
RELUME_API std::vector<uint8_t> encode_png(std::span<const uint8_t> rgb, int width, int height);

/// Reads every channel of the first part with any stored type (half, float, unsigned integer), compression and tiling.
/// Covers the *display* window: pixels outside the data window are 0, pixels beyond the display window are cut off.
/// Subsampled channels are replicated. Only string attributes are kept. Deep files are rejected.
RELUME_API ExrFile read_exr(const std::filesystem::path& file);
RELUME_API ExrFile parse_exr(std::span<const std::byte> bytes, const std::string& name);

/// Stored part of an image: ExrFile::data_window of EXR files, empty for other formats.
RELUME_API PixelWindow stored_window(std::span<const std::byte> bytes, const std::string& name);

/// Writes 32-bit float scan lines with ZIP compression. Equal contents give equal bytes.
RELUME_API void write_exr(const std::filesystem::path& file, const ExrFile& exr);

/// Channels "R", "G", "B", or "LAYER.R" … if `layer` is not empty. Without a layer, falls back to, in this order: the
/// first layer with all three, luminance-chroma (Y, RY, BY), luminance alone (Y). `name` appears in messages.
RELUME_API Image image_from_exr(const ExrFile& exr, const std::string& layer, const std::string& name);

/// Channels R, G, B of a layer (empty string: no layer), ready to append to an ExrFile of the same size.
RELUME_API std::vector<ExrChannel> exr_channels(const Image& image, const std::string& layer = {});

}  // namespace relume
