// Files of parts: images with the exact sums of their samples in channels of integers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "framebuffer/pixel_sums.h"
#include "image/exr_rows.h"
#include "relume/image_io.h"
#include "relume/session.h"

namespace relume {

/// Rows that are read and written at once: those of a block of ZIP compression.
inline constexpr int kRowsAtOnce = 16;

/// Prefix of the names of channels with sums. Their numbers, of two digits, count the 32-bit words of PixelSums.
inline constexpr std::string_view kSumsPrefix = "sums.";

/// Number of such channels. `surface`: with SurfaceSums.
size_t sum_words(bool surface);
/// These channels, in order.
std::vector<ExrRowChannel> sum_channels(bool surface);

/// Reads and writes the sums of rows of pixels in words. `words`: of one channel after the other, as ExrRowReader gives
/// them, of sum_channels() only.
void add_sums(std::span<const uint32_t> words, bool surface, std::span<PixelSums> sums);
void store_sums(std::span<const PixelSums> sums, bool surface, std::span<uint32_t> words);

/// Writes the session's image with its sums. `exr`: its channels and attributes, to which those of a part are added.
/// Throws Error, also if the session has no complete sample or could not complete its preparation.
void write_part(const std::filesystem::path& file, const ExrFile& exr, const Session& session);

}  // namespace relume
